// A flat world with one layer, for tests of instances near a position.

#pragma once

#include "core/base/tile_grid.hpp"
#include "core/placement/tile_builder.hpp"
#include "core/query/instance_world.hpp"
#include "core/state/instance_state.hpp"
#include "core/terrain/flat_terrain.hpp"

#include <doctest/doctest.h>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <memory>
#include <set>
#include <vector>

namespace thicket::test {

struct FlatWorld {
	static constexpr double tile_size = 32.0;

	LayerSettings settings;
	InstanceWorld world;
	InstanceState state;

	FlatWorld() {
		settings.set = {.seed = 3, .radius = 2.0, .levels = 1, .layer = 5};
		set_layers();
		world.set_state(&state);
	}

	void set_layers() {
		QueryLayer layer;
		layer.set = settings.set;
		layer.tile_size = tile_size;
		world.set_layers({layer});
	}

	std::shared_ptr<const CompactTile> make(glm::ivec2 tile, double height = 0.0) const {
		TileInstances generated;
		TileBuilder builder;
		CHECK(builder.build(settings, FlatTerrain(static_cast<float>(height)), tile_rect(tile_size, tile), generated)
						.ok());
		return std::make_shared<const CompactTile>(generated, std::make_shared<LayerSettings>(settings));
	}

	/// Stores the tiles from -reach to reach in the world.
	void load(int tile_radius = 2, double height = 0.0) {
		for (int y = -tile_radius; y <= tile_radius; ++y) {
			for (int x = -tile_radius; x <= tile_radius; ++x) {
				world.keep({0, {x, y}}, make({x, y}, height));
			}
		}
	}

	/// Returns the IDs of all instances within `radius` meters of a position.
	std::set<std::uint64_t> within(glm::dvec3 center, double radius) const {
		std::vector<PlacedInstance> results;
		CHECK(world.query_known([&](const InstanceQuery &query) {
					   return query.in_sphere(center, radius, {}, results);
				   }).ok());
		std::set<std::uint64_t> ids;
		for (const PlacedInstance &instance : results) {
			ids.insert(instance.id);
		}
		return ids;
	}
};

} // namespace thicket::test
