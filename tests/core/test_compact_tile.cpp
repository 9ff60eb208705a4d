// Tests that a compact tile restores a tile bit for bit and uses a third to half of its memory.

#include "core/base/instance_id.hpp"
#include "core/placement/compact_tile.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

/// `max_bytes` is the memory limit per instance, without the fixed cost of each mesh.
struct Case {
	std::string name;
	LayerSettings layer;
	double max_bytes = 0.0;
};

LayerSettings upright() {
	LayerSettings layer = rich_layer();
	layer.placement.align_to_normal = 0.0;
	return layer;
}

/// Returns layers whose instance data is derived from different inputs.
std::vector<Case> cases() {
	std::vector<Case> result{{"upright", upright(), 20.0}, {"aligned", rich_layer(), 32.0}};
	LayerSettings layer = upright();
	layer.placement.max_tilt_degrees = 20.0;
	layer.placement.min_yaw_degrees = layer.placement.max_yaw_degrees = 0.0;
	result.push_back({"leaning", layer, 20.0});
	layer.placement.align_to_normal = 1.0;
	layer.placement.offset_along_normal = -0.4;
	result.push_back({"leaning and off its point", layer, 32.0});
	layer = upright();
	// The basis contains zeros whose sign depends on the ground.
	layer.placement.min_yaw_degrees = layer.placement.max_yaw_degrees = 90.0;
	layer.placement.offset_along_normal = 0.3;
	result.push_back({"upright and off its point", layer, 20.0});
	layer = upright();
	layer.instance_data.use_colors = true;
	layer.instance_data.use_custom_data = true;
	layer.instance_data.colors = std::make_shared<const ColorTable>(
			ColorTable{{1.0f, 0.0f, 0.0f, 1.0f}, {0.0f, 1.0f, 0.0f, 1.0f}, {0.0f, 0.0f, 1.0f, 1.0f}});
	result.push_back({"with random colors", layer, 20.0});
	layer.instance_data.color.kind = SourceKind::slope;
	layer.instance_data.color.max = 45.0;
	result.push_back({"with colors of the slope", layer, 24.0});
	layer.instance_data.scale.kind = SourceKind::height;
	layer.instance_data.scale.max = 60.0;
	result.push_back({"with colors of the slope and scales of the height", layer, 28.0});
	layer.instance_data.scale = {};
	layer.placement.align_to_normal = 0.3;
	layer.instance_data.variation.kind = SourceKind::height;
	layer.instance_data.variation.max = 60.0;
	result.push_back({"aligned, with sources", layer, 40.0});
	return result;
}

std::size_t bytes_of(const CompactTile &tile) {
	std::size_t bytes = 0;
	for (const CompactMesh &mesh : tile.meshes) {
		bytes += mesh.bytes();
	}
	return bytes;
}

/// Returns handmade instances that no layer could generate.
MeshInstances handmade(const std::vector<std::uint64_t> &ids) {
	MeshInstances mesh;
	mesh.resize(ids.size());
	for (std::size_t i = 0; i < ids.size(); ++i) {
		std::ranges::fill(mesh.floats_of(i), static_cast<float>(i) + 0.5f);
		mesh.ids[i] = ids[i];
		mesh.ranks[i] = static_cast<std::uint32_t>(i);
	}
	return mesh;
}

} // namespace

TEST_CASE("compact tile: instances are restored bit for bit, for every source of instance data") {
	for (const Case &each : cases()) {
		CAPTURE(each.name);
		const TileInstances tile = built(each.layer, hills(), tile_of_hills);
		REQUIRE(size_of(tile) > 1000);
		const std::shared_ptr<const CompactTile> compact = compact_tile(each.layer, tile);
		CHECK(digest(expanded(*compact)) == digest(tile));
		CHECK(compact->counts.placed == tile.counts.placed);
		for (std::size_t at = 0; at < tile.meshes.size(); ++at) {
			const MeshInstances &mesh = tile.meshes[at];
			CHECK(compact->meshes[at].min() == mesh.min);
			CHECK(compact->meshes[at].max() == mesh.max);
			CHECK(compact->meshes[at].max_scale() == mesh.max_scale);
		}
	}
}

TEST_CASE("compact tile: the memory stays below the documented limit") {
	for (const Case &each : cases()) {
		CAPTURE(each.name);
		const TileInstances tile = built(each.layer, hills(), tile_of_hills);
		CHECK(static_cast<double>(bytes_of(*compact_tile(each.layer, tile))) <=
				each.max_bytes * static_cast<double>(size_of(tile)));
	}
}

TEST_CASE("compact tile: an instance is found only by its ID") {
	const LayerSettings layer = rich_layer();
	const TileInstances tile = built(layer, hills(), tile_of_hills);
	const std::shared_ptr<const CompactTile> compact = compact_tile(layer, tile);
	const MeshInstances &mesh = tile.meshes[1];
	for (std::size_t i = 0; i < mesh.size(); ++i) {
		REQUIRE(compact->meshes[1].find(mesh.ids[i]) == i);
		REQUIRE(compact->meshes[0].find(mesh.ids[i]) == compact->meshes[0].size());
	}
	for (const std::uint64_t id : {std::uint64_t{0}, ~std::uint64_t{0}, mesh.ids[0] + (std::uint64_t{1} << 48),
				 mesh.ids[0] - (std::uint64_t{1} << 48), pack({3, {cell_limit - 1, 0}})}) {
		CHECK(compact->meshes[1].find(id) == compact->meshes[1].size());
	}
}

TEST_CASE("compact tile: handmade instances and very distant ones are stored uncompressed") {
	const LayerSettings layer = rich_layer();
	MeshInstances far_apart = handmade({pack({3, {0, 0}}), pack({3, {1 << 15, 0}})});
	MeshInstances layers = handmade({pack({3, {0, 0}}), pack({4, {0, 0}})});
	far_apart.normals.resize(far_apart.size());
	layers.normals.resize(layers.size());
	for (const MeshInstances &mesh : {handmade({5, 9, ~std::uint64_t{0} >> 1}), far_apart, layers}) {
		TileInstances tile;
		tile.meshes.push_back(mesh);
		const CompactTile known(tile, std::make_shared<LayerSettings>(layer));
		CHECK(digest(expanded(known)) == digest(tile));
		for (std::size_t i = 0; i < mesh.size(); ++i) {
			CHECK(known.meshes[0].find(mesh.ids[i]) == i);
		}
	}
}

TEST_CASE("compact tile: a subset appended to other instances has the same instances") {
	const LayerSettings layer = rich_layer();
	const std::shared_ptr<const CompactTile> compact = compact_tile(layer, built(layer, hills(), tile_of_hills));
	const CompactMesh &base = compact->meshes[0];
	const MeshInstances first = handmade({~std::uint64_t{0} >> 1, 7});
	std::vector<std::uint32_t> retained;
	for (std::uint32_t i = 0; i < base.size(); i += i % 7 == 0 ? 2 : 1) {
		retained.push_back(i);
	}
	const CompactMesh some(first, base, retained);
	REQUIRE(some.size() == first.size() + retained.size());
	CHECK(some.bytes() <= 80 * first.size() + 32 * retained.size());
	const MeshInstances floats = expanded(some);
	CHECK(std::equal(first.buffer.begin(), first.buffer.end(), floats.buffer.begin()));
	CHECK(std::equal(first.ids.begin(), first.ids.end(), floats.ids.begin()));
	for (std::size_t i = 0; i < retained.size(); ++i) {
		CHECK(some.same(first.size() + i, base, retained[i]));
	}
	// A subset of the previous subset, whose first instances are still uncompressed.
	const std::vector<std::uint32_t> fewer{1, 2, 5};
	const CompactMesh rest(handmade({3}), some, fewer);
	CHECK(rest.same(1, some, 1));
	CHECK(rest.same(2, some, 2));
	CHECK(rest.same(3, some, 5));
	CHECK_FALSE(rest.same(3, some, 6));
	CHECK_FALSE(rest.same(1, some, 0));
}
