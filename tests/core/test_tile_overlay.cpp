// Tests a state's changes that are applied to a tile: all unchanged instances must remain
// bit-identical.

#include "core/base/instance_id.hpp"
#include "core/near/tile_overlay.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>

using namespace thicket;
using namespace thicket::test;

namespace {

OverlaidMeshes displayed_meshes(const std::shared_ptr<const CompactTile> &tile, const LayerSettings &layer,
		const Rect &rect, const Overlay &overlay) {
	OverlaidMeshes meshes;
	REQUIRE(overlaid(tile, layer, rect, overlay, meshes).ok());
	return meshes;
}

std::shared_ptr<const CompactTile> shared_tile(const LayerSettings &layer) {
	return compact_tile(layer, built(layer, hills(), tile_of_hills));
}

std::size_t count_of(const OverlaidMeshes &meshes) {
	std::size_t count = 0;
	for (const auto &mesh : meshes) {
		count += mesh->size();
	}
	return count;
}

AddedInstance placed(const LayerSettings &layer, glm::dvec3 position, std::uint8_t mesh) {
	AddedInstance added;
	added.layer = layer.set.layer;
	added.mesh = mesh;
	added.position = position;
	added.basis = glm::mat3(0.0f, 0.0f, -2.0f, 0.0f, 2.0f, 0.0f, 2.0f, 0.0f, 0.0f);
	return added;
}

} // namespace

TEST_CASE("overlay: without changes, and with changes elsewhere, no tile is copied") {
	const LayerSettings layer = rich_layer();
	const auto tile = shared_tile(layer);
	InstanceState state;
	std::uint64_t id = 0;
	REQUIRE(state.add(placed(layer, {500.0, 0.0, 500.0}, 0), id).ok());
	REQUIRE(state.remove(pack({layer.set.layer, {100000, 100000}})));
	for (const Overlay &overlay : {Overlay{}, Overlay{&state, nullptr}}) {
		const auto displayed = displayed_meshes(tile, layer, tile_of_hills, overlay);
		REQUIRE(displayed.size() == tile->meshes.size());
		for (std::size_t mesh = 0; mesh < displayed.size(); ++mesh) {
			CHECK(displayed[mesh].get() == &tile->meshes[mesh]);
		}
	}
}

TEST_CASE("overlay: removed and hidden instances are omitted, and all others are bit-identical, in the same order") {
	const LayerSettings layer = rich_layer();
	const auto tile = shared_tile(layer);
	InstanceState state;
	std::unordered_set<std::uint64_t> hidden_ids;
	std::mt19937 random(5);
	std::size_t removed_count = 0;
	const TileInstances whole_tile = expanded(*tile);
	for (const MeshInstances &mesh : whole_tile.meshes) {
		for (const std::uint64_t id : mesh.ids) {
			const auto draw = random() % 10;
			if (draw < 2) {
				REQUIRE(state.remove(id));
			} else if (draw == 2) {
				hidden_ids.insert(id);
			}
			removed_count += draw <= 2 ? 1 : 0;
		}
	}
	const auto displayed = displayed_meshes(tile, layer, tile_of_hills, {&state, &hidden_ids});
	CHECK(count_of(displayed) == size_of(expanded(*tile)) - removed_count);
	for (std::size_t mesh = 0; mesh < displayed.size(); ++mesh) {
		const MeshInstances &all_instances = whole_tile.meshes[mesh];
		const MeshInstances remaining = expanded(*displayed[mesh]);
		std::size_t at = 0;
		for (std::size_t i = 0; i < all_instances.size(); ++i) {
			if (state.removed(all_instances.ids[i]) || hidden_ids.contains(all_instances.ids[i])) {
				continue;
			}
			REQUIRE(at < remaining.size());
			CHECK(remaining.ids[at] == all_instances.ids[i]);
			CHECK(remaining.ranks[at] == all_instances.ranks[i]);
			const auto from = all_instances.buffer.begin() + static_cast<std::ptrdiff_t>(i * all_instances.stride);
			const auto target = remaining.buffer.begin() + static_cast<std::ptrdiff_t>(at * remaining.stride);
			CHECK(std::equal(from, from + static_cast<std::ptrdiff_t>(all_instances.stride), target));
			++at;
		}
		CHECK(at == remaining.size());
	}
}

TEST_CASE("overlay: hand-placed instances come first, only in their own tile, as they were placed") {
	LayerSettings layer = rich_layer();
	layer.instance_data.use_custom_data = true;
	layer.instance_data.variation.kind = SourceKind::height;
	layer.instance_data.variation.max = 40.0;
	const auto tile = shared_tile(layer);
	InstanceState state;
	std::uint64_t inside_count = 0;
	std::uint64_t on_edge = 0;
	std::uint64_t odd_mesh = 0;
	REQUIRE(state.add(placed(layer, {10.5, 20.0, 30.25}, 1), inside_count).ok());
	REQUIRE(state.add(placed(layer, {64.0, 0.0, 64.0}, 1), on_edge).ok());
	REQUIRE(state.add(placed(layer, {-64.0, 0.0, 0.0}, 200), odd_mesh).ok());
	const auto displayed = displayed_meshes(tile, layer, tile_of_hills, {&state, nullptr});
	CHECK(count_of(displayed) == size_of(expanded(*tile)) + 2);
	CHECK(displayed[1]->find(inside_count) == 0);
	CHECK(displayed[0]->find(odd_mesh) == 0);
	CHECK(displayed[2].get() == &tile->meshes[2]);
	CHECK(displayed[1]->find(on_edge) == displayed[1]->size());
	CHECK(displayed[1]->ranks()[0] == 0);
	CHECK(tile->origin + glm::dvec3(displayed[1]->positions()[0]) == glm::dvec3(10.5, 20.0, 30.25));
	const UnfilledVector<float> floats = expanded(*displayed[1]).buffer;
	CHECK(std::vector<float>(floats.begin(), floats.begin() + 3) == std::vector<float>{0.0f, 0.0f, 2.0f});
	CHECK(floats[transform_floats] == 0.5f); // The color depends on the instance's height.
	CHECK(floats[transform_floats + 3] == 2.0f);
	CHECK(displayed[1]->max_scale() >= 2.0f);
	CHECK(visible_prefix(displayed[1]->ranks(), 1e-9) >= 1);

	const Rect next{{64.0, 0.0}, {192.0, 128.0}};
	const auto neighbor = compact_tile(layer, built(layer, hills(), next));
	CHECK(displayed_meshes(neighbor, layer, next, {&state, nullptr})[1]->find(on_edge) == 0);
}

TEST_CASE("overlay: the box contains all instances") {
	const LayerSettings layer = rich_layer();
	const auto tile = shared_tile(layer);
	InstanceState state;
	std::uint64_t id = 0;
	REQUIRE(state.add(placed(layer, {0.0, 900.0, 64.0}, 0), id).ok());
	const auto displayed = displayed_meshes(tile, layer, tile_of_hills, {&state, nullptr});
	const CompactMesh &mesh = *displayed[0];
	CHECK(mesh.max().y == static_cast<float>(900.0 - tile->origin.y));
	CHECK(mesh.min() == tile->meshes[0].min());
}
