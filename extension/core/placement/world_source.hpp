#pragma once

#include "core/rules/biome_rules.hpp"
#include "core/rules/density_expression.hpp"
#include "core/rules/density_field.hpp"
#include "core/rules/world_input.hpp"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

struct LayerSettings;

/// Provides the values of a WorldInput. A source that is missing provides 0, or the maximum distance.
/// A texture needs no source, because the ground has its weights.
struct WorldSource {
	WorldInput input;
	std::shared_ptr<const BiomeDensity> biome{}; ///< The density is the weight of the biome.
	/// The channel of the mask, an image over the plane or a planet, whose queries cannot fail.
	std::shared_ptr<const DensityField> mask{};
	std::shared_ptr<const LayerSettings> layer{}; ///< The layer to measure distances to.

	friend bool operator==(const WorldSource &, const WorldSource &) = default;
};

/// Maximum number of different world inputs in all expressions of a layer.
inline constexpr std::size_t max_world_sources = 64;

/// Returns one source without values for each world input of a layer's expressions.
std::vector<WorldSource> empty_sources(const LayerSettings &layer);

/// Returns the index of the source of an input, or the number of sources if there is none.
std::size_t source_of(std::span<const WorldSource> sources, const WorldInput &input);

/// Return true if the layer's rules, or the rules of any mesh that it can choose, use a world input.
bool rules_use(const LayerSettings &layer, const WorldInput &input);
bool meshes_use(const LayerSettings &layer, const WorldInput &input);

} // namespace thicket
