#pragma once

// Helpers for tests of whole tiles.

#include "core/placement/compact_tile.hpp"
#include "core/placement/tile_builder.hpp"
#include "core/terrain/heightfield.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <thread>
#include <vector>

namespace thicket::test {

/// Returns hills on 600 x 400 m, with gentle and steep slopes.
inline Heightfield hills() {
	const HeightfieldFrame frame{{61, 41}, {{-300.0, -200.0}, {300.0, 200.0}}, 0.0, 90.0};
	std::vector<std::uint16_t> posts;
	for (int row = 0; row < 41; ++row) {
		for (int column = 0; column < 61; ++column) {
			posts.push_back(static_cast<std::uint16_t>((column * column * 7919 + row * row * 104729) % 65536));
		}
	}
	Heightfield field;
	REQUIRE(field.set(frame, posts).ok());
	return field;
}

/// A field that always fails, with an error that names `noise`.
class FailingField final : public DensityField {
	Status sample(std::span<const glm::dvec2>, std::span<float>) const override {
		return {ErrorCode::wrong_type, "noise", 0.0};
	}
};

inline LayerSettings rich_layer() {
	LayerSettings layer;
	layer.set = {.seed = 99, .radius = 1.5, .levels = 2, .layer = 3};
	layer.rules.max_slope_degrees = 50.0;
	layer.rules.slope_falloff_degrees = 15.0;
	layer.rules.min_height = 10.0;
	layer.rules.height_falloff = 20.0;
	layer.placement.align_to_normal = 0.7;
	layer.placement.min_scale = 0.5;
	layer.placement.height_offset = -0.125;
	layer.mesh_weights = {1.0f, 2.0f, 0.5f};
	return layer;
}

inline constexpr Rect tile_of_hills{{-64.0, 0.0}, {64.0, 128.0}};

inline TileInstances built(const LayerSettings &layer, const Terrain &terrain, const Rect &rect) {
	TileBuilder builder;
	TileInstances tile;
	REQUIRE(builder.build(layer, terrain, rect, tile).ok());
	return tile;
}

inline std::shared_ptr<const CompactTile> compact_tile(const LayerSettings &layer, const TileInstances &tile) {
	return std::make_shared<const CompactTile>(tile, std::make_shared<LayerSettings>(layer));
}

/// Returns a digest of all bits of the mesh's instances.
inline std::uint64_t digest(const CompactMesh &mesh) {
	TileInstances tile;
	tile.meshes.push_back(expanded(mesh));
	return digest(tile);
}

inline std::size_t size_of(const TileInstances &tile) {
	std::size_t size = 0;
	for (const MeshInstances &mesh : tile.meshes) {
		size += mesh.size();
	}
	return size;
}

inline glm::dvec3 world_position(const TileInstances &tile, const MeshInstances &mesh, std::size_t i) {
	const float *transform = mesh.buffer.data() + i * transform_floats;
	return tile.origin + glm::dvec3(transform[3], transform[7], transform[11]);
}

using Transforms = std::map<std::uint64_t, std::vector<float>>;

/// Returns the transforms of all instances, keyed by ID.
inline Transforms transforms_of(const TileInstances &tile) {
	Transforms result;
	for (const MeshInstances &mesh : tile.meshes) {
		for (std::size_t i = 0; i < mesh.size(); ++i) {
			const float *transform = mesh.buffer.data() + i * transform_floats;
			result[mesh.ids[i]] = std::vector<float>(transform, transform + transform_floats);
		}
	}
	return result;
}

/// Checks that a filter reduced `all` to `some`: more than 50 but not all instances, with
/// bit-identical transforms.
inline void check_filtered(const Transforms &all, const Transforms &remaining) {
	CHECK(remaining.size() > 50);
	CHECK(remaining.size() < all.size());
	for (const auto &[id, transform] : remaining) {
		const auto match = all.find(id);
		REQUIRE(match != all.end());
		CHECK(std::memcmp(match->second.data(), transform.data(), sizeof(float) * transform_floats) == 0);
	}
}

/// Checks that tile_of_hills has the digest `expected` on several concurrent threads, both as the
/// first tile of a builder and after another tile.
inline void check_on_threads(const LayerSettings &layer, const Terrain &terrain, std::uint64_t expected) {
	std::array<std::array<std::uint64_t, 2>, 3> digests{};
	std::vector<std::thread> threads;
	for (std::array<std::uint64_t, 2> &each : digests) {
		threads.emplace_back([&each, &terrain, &layer] {
			const Rect other{{-200.0, -90.0}, {-150.0, -10.0}};
			TileBuilder builder;
			TileInstances part_tile;
			for (std::uint64_t &part_digest : each) {
				part_digest = builder.build(layer, terrain, tile_of_hills, part_tile).ok() ? digest(part_tile) : 0;
				if (!builder.build(layer, terrain, other, part_tile).ok()) {
					return;
				}
			}
		});
	}
	for (std::thread &thread : threads) {
		thread.join();
	}
	for (const std::array<std::uint64_t, 2> &each : digests) {
		CHECK(each[0] == expected);
		CHECK(each[1] == expected);
	}
}

} // namespace thicket::test
