#pragma once

// Helpers for query tests: a world with several layers, a source of its tiles, and a brute-force
// list of all its instances.

#include "core/base/tile_grid.hpp"
#include "core/placement/compact_tile.hpp"
#include "core/placement/tile_builder.hpp"
#include "core/query/instance_query.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

namespace thicket::test {

/// Unbounded hills with slopes of up to 30 degrees. The lowest valleys are holes without ground
/// (NaN).
class EndlessHills final : public Terrain {
public:
	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override {
		for (std::size_t i = 0; i < positions.size(); ++i) {
			const glm::dvec2 p = positions[i];
			const double height = 8.0 * std::sin(p.x / 16.0) + 6.0 * std::cos(p.y / 23.0);
			const double along_x = 0.5 * std::cos(p.x / 16.0);
			const double along_y = -6.0 / 23.0 * std::sin(p.y / 23.0);
			const double length = std::sqrt(1.0 + along_x * along_x + along_y * along_y);
			r_ground[i].height = height < -12.0 ? std::nanf("") : static_cast<float>(height);
			r_ground[i].normal = glm::vec3(glm::dvec3(-along_x, 1.0, -along_y) / length);
		}
		return {};
	}
};

/// The settings of a layer, and the layer's description for queries.
struct WorldLayer {
	LayerSettings settings;
	QueryLayer query_layer;
};

inline WorldLayer world_layer(const LayerSettings &settings, double tile_size, const InstanceShape &shape) {
	return {settings,
			{.set = settings.set,
					.tile_size = tile_size,
					.shape = shape,
					.max_scale = settings.placement.max_scale,
					.max_offset = std::abs(settings.placement.offset_along_normal)}};
}

/// Returns four layers: leaning trees; colored ferns that are offset from the ground; stones whose
/// tiles are narrower than the base squares of their point set; and a layer that queries skip. The
/// tile sizes of the first three are not multiples of each other.
inline std::vector<WorldLayer> world_layers() {
	LayerSettings trees;
	trees.set = {.seed = 12, .radius = 5.0, .levels = 2, .layer = 3};
	trees.rules.max_slope_degrees = 25.0;
	trees.placement.min_scale = 0.7;
	trees.placement.max_scale = 1.6;
	trees.placement.max_tilt_degrees = 25.0;
	trees.mesh_weights = {1.0f, 2.0f};
	LayerSettings ferns;
	ferns.set = {.seed = 12, .radius = 1.7, .levels = 1, .layer = 7};
	ferns.placement.align_to_normal = 1.0;
	ferns.placement.offset_along_normal = -1.5;
	ferns.neighbors = {{std::make_shared<LayerSettings>(trees), 2.0, nullptr}};
	ferns.instance_data.use_colors = true;
	ferns.instance_data.use_custom_data = true;
	ferns.mesh_weights = {1.0f, 0.5f, 1.0f};
	LayerSettings stones;
	stones.set = {.seed = 13, .radius = 9.0, .levels = 1, .layer = max_state_layer};
	stones.rules.density = 0.7;
	stones.placement.min_scale = 0.25;
	stones.placement.max_scale = 4.0;
	std::vector<WorldLayer> layers{world_layer(trees, 64.0, {0.6, 12.0}), world_layer(ferns, 23.5, {0.8, 1.0}),
			world_layer(stones, 5.0, {0.5, 0.4}), world_layer(trees, 64.0, {0.6, 12.0})};
	layers.back().query_layer.wanted = false;
	return layers;
}

/// A tile source that generates tiles on request and caches them.
class World final : public TileSource {
public:
	explicit World(const SampleMargins &margins = {}) : builder_(margins) {}

	std::vector<WorldLayer> layers = world_layers();
	std::vector<std::tuple<std::uint32_t, int, int>> requests; ///< Layer, x and y of every requested tile, in order.
	bool makes = true;                                         ///< If false, missing tiles are not generated.
	Status failure;                                            ///< If this is an error, `find_tile` returns it.

	Status find_tile(const WorldTile &wanted, std::shared_ptr<const CompactTile> &r_tile) override {
		const auto &[layer, tile, slab] = wanted;
		requests.emplace_back(layer, tile.x, tile.y);
		r_tile = nullptr;
		if (!failure.ok()) {
			return failure;
		}
		std::shared_ptr<const CompactTile> &cached = tiles_[{layer, tile.x, tile.y}];
		if (cached == nullptr && makes) {
			TileInstances generated;
			if (const Status status = build(layer, tile, generated); !status.ok()) {
				return status;
			}
			cached = std::make_shared<const CompactTile>(
					generated, std::make_shared<LayerSettings>(layers[layer].settings));
		}
		r_tile = cached;
		return {};
	}

	/// Generates a tile. The cached tiles are neither read nor changed.
	Status build(std::uint32_t layer, glm::ivec2 tile, TileInstances &r_generated) {
		const WorldLayer &settings = layers[layer];
		return builder_.build(
				settings.settings, terrain_, tile_rect(settings.query_layer.tile_size, tile), r_generated);
	}

	void forget() { tiles_.clear(); }

	std::vector<QueryLayer> query_layers() const {
		std::vector<QueryLayer> result;
		std::transform(layers.begin(), layers.end(), std::back_inserter(result),
				[](const WorldLayer &layer) { return layer.query_layer; });
		return result;
	}

private:
	EndlessHills terrain_;
	TileBuilder builder_;
	std::map<std::tuple<std::uint32_t, int, int>, std::shared_ptr<const CompactTile>> tiles_;
};

/// Returns the generated instances of all tiles that touch `area`, except the removed ones, and all
/// hand-placed instances, sorted by layer and ID. Leaves out the layer that queries skip. The
/// function reads the tiles' buffers, not their compact copies.
inline std::vector<PlacedInstance> everything_in(World &world, const Rect &area, const InstanceState *state = nullptr) {
	std::vector<PlacedInstance> all;
	for (std::uint32_t layer = 0; layer < world.layers.size(); ++layer) {
		const QueryLayer &query_layer = world.layers[layer].query_layer;
		if (!query_layer.wanted) {
			continue;
		}
		const glm::ivec2 first = tile_at(query_layer.tile_size, area.min);
		const glm::ivec2 last = tile_at(query_layer.tile_size, area.max);
		for (int i = 0; i < (last.x - first.x + 1) * (last.y - first.y + 1); ++i) {
			TileInstances tile;
			std::shared_ptr<const CompactTile> cached_tile; // Caches the tile, as a query would.
			const int width = last.x - first.x + 1;
			REQUIRE(world.find_tile({layer, first + glm::ivec2(i % width, i / width)}, cached_tile).ok());
			REQUIRE(world.build(layer, first + glm::ivec2(i % width, i / width), tile).ok());
			for (std::uint32_t mesh = 0; mesh < tile.meshes.size(); ++mesh) {
				const MeshInstances &instances = tile.meshes[mesh];
				for (std::size_t at = 0; at < instances.size(); ++at) {
					const float *t = &instances.buffer[at * instances.stride];
					PlacedInstance each{instances.ids[at], layer, mesh,
							tile.origin + glm::dvec3(glm::vec3(t[3], t[7], t[11])),
							glm::mat3(glm::vec3(t[0], t[4], t[8]), glm::vec3(t[1], t[5], t[9]),
									glm::vec3(t[2], t[6], t[10]))};
					if (state == nullptr || !state->removed(each.id)) {
						all.push_back(each);
					}
				}
			}
		}
		if (state != nullptr) {
			for (const std::uint64_t id : state->added_ids(query_layer.set.layer)) {
				const AddedInstance &added = *state->added(id);
				all.push_back({id, layer, added.mesh, added.position, added.basis});
			}
		}
	}
	std::sort(all.begin(), all.end(), [](const PlacedInstance &a, const PlacedInstance &b) {
		return std::tie(a.layer, a.id) < std::tie(b.layer, b.id);
	});
	return all;
}

template <class Pass>
std::vector<PlacedInstance> matching(const std::vector<PlacedInstance> &all, const Pass &pass) {
	std::vector<PlacedInstance> nearby;
	std::copy_if(all.begin(), all.end(), std::back_inserter(nearby), pass);
	return nearby;
}

/// Returns true if all fields are equal.
inline bool same(const PlacedInstance &a, const PlacedInstance &b) {
	return std::tie(a.id, a.layer, a.mesh, a.position.x, a.position.y, a.position.z) ==
			std::tie(b.id, b.layer, b.mesh, b.position.x, b.position.y, b.position.z) &&
			a.basis == b.basis;
}

inline bool same(const std::vector<PlacedInstance> &a, const std::vector<PlacedInstance> &b) {
	return std::equal(a.begin(), a.end(), b.begin(), b.end(),
			[](const PlacedInstance &x, const PlacedInstance &y) { return same(x, y); });
}

inline double between(std::mt19937 &random, double low, double high) {
	return std::uniform_real_distribution<double>(low, high)(random);
}

/// Corners of areas to query: at the origin, at negative coordinates, and more than 1,000 km away.
inline constexpr glm::dvec2 world_centers[] = {{0.0, 0.0}, {-431.7, -905.2}, {1.0e6 + 0.37, -1.0e6 + 0.81}};

/// Returns a state that removes about a fifth of `all` and adds 40 hand-placed instances within 80
/// m of `position`. Some of them are tilted, flat, mirrored or very tall.
inline InstanceState changed_state(const std::vector<PlacedInstance> &all, glm::dvec2 position, std::mt19937 &random) {
	InstanceState state;
	for (const PlacedInstance &each : all) {
		if (random() % 5 == 0) {
			state.remove(each.id);
		}
	}
	for (int i = 0; i < 40; ++i) {
		AddedInstance added;
		added.layer = i % 2 == 0 ? std::uint16_t{3} : max_state_layer;
		added.mesh = static_cast<std::uint8_t>(i % 3);
		added.position = {position.x + between(random, -80.0, 80.0), between(random, -15.0, 15.0),
				position.y + between(random, -80.0, 80.0)};
		for (int column = 0; column < 3; ++column) {
			for (int row = 0; row < 3; ++row) {
				added.basis[column][row] += static_cast<float>(between(random, -0.6, 0.6));
			}
		}
		added.basis[1] *= i % 10 == 0 ? 9.0f : 1.0f;
		added.basis[2] *= i == 7 ? 0.0f : i == 8 ? -1.0f : 1.0f;
		std::uint64_t id = 0;
		REQUIRE(state.add(added, id).ok());
	}
	return state;
}

inline constexpr Rect glade{{0.0, 0.0}, {70.0, 70.0}};

inline std::vector<PlacedInstance> found_in(const InstanceQuery &query, const Rect &rect) {
	std::vector<PlacedInstance> results;
	REQUIRE(query.in_rect(rect, {}, results).ok());
	return results;
}

} // namespace thicket::test
