#pragma once

// Helpers for the tests of color and variation sources.

#include "core/placement/layer.hpp"
#include "tile_fixture.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

namespace thicket::test {

inline constexpr std::size_t colors = 1000;
inline constexpr double farthest = 9.0; ///< The maximum of distance sources, in meters.

/// Returns colors whose red component is their index on the gradient. Half floats represent all
/// components exactly.
inline std::shared_ptr<const ColorTable> palette() {
	ColorTable table;
	for (std::size_t i = 0; i < colors; ++i) {
		table.emplace_back(static_cast<float>(i), 0.25f, 0.5f, 1.0f);
	}
	return std::make_shared<const ColorTable>(std::move(table));
}

/// Noise that exceeds the range from 0 to 1 at both ends and has holes (NaN).
class Waves final : public DensityField {
public:
	static float at(glm::dvec2 position) {
		const double phase = position.x * 0.125 + position.y * 0.03125;
		const double fraction = phase - std::floor(phase);
		return fraction < 0.05 ? std::nanf("") : static_cast<float>(1.5 * fraction - 0.25);
	}

	Status sample(std::span<const glm::dvec2> positions, std::span<float> r_density) const override {
		std::transform(positions.begin(), positions.end(), r_density.begin(), at);
		return {};
	}
};

inline std::shared_ptr<const LayerSettings> oaks() {
	auto layer = std::make_shared<LayerSettings>();
	layer->set = {.seed = 99, .radius = 9.0, .levels = 1, .layer = 7};
	layer->rules.density = 0.7;
	layer->rules.max_slope_degrees = 70.0;
	return layer;
}

/// Returns a mask that is erased within a meter of `spot`, or is blank if there is none.
inline std::shared_ptr<const PaintedMask> painted_at(std::optional<glm::dvec2> spot) {
	auto mask = std::make_shared<PaintedMask>();
	REQUIRE(mask->reset(0.5, 1.0).ok());
	if (spot.has_value()) {
		const Brush brush{Brush::Mode::erase, *spot, 1.0, 1.0, 1.0};
		Rect changed_rect;
		REQUIRE(mask->paint(brush, changed_rect).ok());
		REQUIRE_FALSE(changed_rect.empty());
	}
	return mask;
}

inline InstanceSource source_of(SourceKind kind) {
	InstanceSource source{.kind = kind};
	switch (kind) {
		case SourceKind::height: source.min = 20.0, source.max = 70.0; break;
		case SourceKind::slope: source.min = 25.0, source.max = 48.0; break;
		case SourceKind::noise: source.min = 0.1, source.max = 0.8; break;
		case SourceKind::rank: source.min = 0.0, source.max = 0.9; break;
		case SourceKind::distance: source.min = 1.0, source.max = farthest; break;
		case SourceKind::random: break;
	}
	source.noise = std::make_shared<const Waves>();
	source.layer = oaks();
	return source;
}

inline const std::vector<SourceKind> kinds{
		SourceKind::height, SourceKind::slope, SourceKind::noise, SourceKind::rank, SourceKind::distance};

/// Returns a layer whose colors and variations are each controlled by a source.
inline LayerSettings layer_with_sources(const InstanceSource &color, const InstanceSource &variation) {
	LayerSettings layer = rich_layer();
	layer.instance_data = {true, palette(), true, {color}, {variation}};
	return layer;
}

/// Returns the expected result of fraction_of for sources without steps.
inline double expected_fraction(const InstanceSource &source, double value) {
	return std::clamp((value - source.min) / (source.max - source.min), 0.0, 1.0);
}

} // namespace thicket::test
