#pragma once

#include "tests/analysis/golden_surfaces.hpp"

#include "core/placement/tile_builder.hpp"
#include "core/terrain/surface.hpp"
#include "core/terrain/terrain.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace thicket::analysis {

/// A ground that consists only of a surface. Layers on surfaces query nothing else.
class GoldenPlanet final : public Terrain {
public:
	explicit GoldenPlanet(std::shared_ptr<const Surface> surface) : surface_(std::move(surface)) {}

	Status sample(std::span<const glm::dvec2> /*positions*/, std::span<Ground> /*r_ground*/) const override {
		return {};
	}
	const Surface *surface() const override { return surface_.get(); }

private:
	std::shared_ptr<const Surface> surface_;
};

/// Returns a layer on a planet that uses altitudes, slopes, an edge feather, a region that ignores
/// height, and spacing.
inline LayerSettings planet_layer(const Planet &planet, const glm::dvec3 &region, void (*require)(const Status &)) {
	auto trees = std::make_shared<LayerSettings>();
	trees->set = {.seed = 31, .radius = 6.0, .layer = 2, .on_surface = true};
	trees->rules.max_slope_degrees = 180.0;
	trees->planet = planet;
	LayerSettings layer = *trees;
	layer.set = {.seed = 31, .radius = 1.5, .layer = 3, .on_surface = true};
	layer.neighbors = {{trees, 2.0, nullptr}};
	layer.rules.max_slope_degrees = 3.0;
	layer.rules.slope_falloff_degrees = 2.0;
	layer.rules.min_height = -0.6;
	layer.rules.max_height = 2.0;
	layer.rules.height_falloff = 0.5;
	layer.rules.edge_feather = 3.0;
	layer.placement.align_to_normal = 0.5;
	layer.placement.height_offset = 0.25;
	layer.placement.max_tilt_degrees = 10.0;
	Shape shape;
	shape.kind = ShapeKind::cylinder;
	shape.exclude = true;
	shape.ignore_height = true;
	shape.planet = planet;
	shape.falloff = 4.0;
	shape.center = planet.center + region;
	shape.half_size = {12.0, 1.0, 0.0};
	auto shapes = std::make_shared<ShapeSet>();
	require(shapes->set({shape}));
	layer.rules.shapes = shapes;
	return layer;
}

/// Returns digests of cubic tiles near a pole, at 45 degrees and at the equator of a planet, where the
/// faces of the ball point outward.
inline std::vector<std::pair<std::string, std::uint64_t>> planet_digests(
		void (*require)(const Status &), std::uint64_t (*digest_of)(const TileInstances &)) {
	std::vector<std::pair<std::string, std::uint64_t>> digests;
	const Planet planet{{40.0, -30.0, 20.0}, 300.0};
	const GoldenPlanet ground(golden_ball(planet.center, planet.radius, require));
	TileBuilder builder;
	for (const auto &[name, at] :
			{std::pair("pole", glm::dvec3(10.0, 300.0, -20.0)), std::pair("45 degrees", glm::dvec3(212.0, 212.0, 12.0)),
					std::pair("equator", glm::dvec3(-15.0, 10.0, 299.0))}) {
		const glm::dvec3 middle = planet.center + at;
		const TileSpace space(Rect{{middle.x - 32.0, middle.z - 32.0}, {middle.x + 32.0, middle.z + 32.0}},
				middle.y - 32.0, middle.y + 32.0);
		TileInstances tile;
		require(builder.build(planet_layer(planet, at, require), ground, space, tile));
		digests.emplace_back(std::string("planet, ") + name, digest_of(tile));
	}
	return digests;
}

} // namespace thicket::analysis
