// Tests layers whose points are in rows: tiles, neighbors, queries by ID, explanations and edits.

#include "core/explain/point_probe.hpp"
#include "core/placement/layer_edits.hpp"
#include "query_fixture.hpp"
#include "refusal.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <cmath>
#include <cstring>
#include <memory>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

/// Returns the rows of a winding avenue through tile_of_hills.
std::shared_ptr<const RowSet> avenue() {
	RowLine line{.identity = 0x123456789abcdef0};
	for (int i = 0; i <= 300; ++i) {
		line.points.emplace_back(-75.0 + 0.5 * i, 60.0 + 40.0 * std::sin(i / 60.0));
	}
	auto rows = std::make_shared<RowSet>();
	const RowSettings settings{.step = 1.5, .offsets = {-3.0, 3.0}, .jitter_along = 0.2, .jitter_across = 0.4};
	REQUIRE(rows->set(settings, {line}).ok());
	return rows;
}

LayerSettings row_layer() {
	LayerSettings layer;
	layer.set = {
			.seed = 99, .radius = equivalent_radius(avenue()->settings()), .levels = 1, .layer = 3, .in_rows = true};
	layer.rows = avenue();
	layer.placement.min_yaw_degrees = -20.0;
	layer.placement.max_yaw_degrees = 30.0;
	layer.placement.align_to_normal = 0.7;
	layer.placement.max_tilt_degrees = 5.0;
	layer.mesh_weights = {1.0f, 2.0f};
	return layer;
}

} // namespace

TEST_CASE("layers in rows: tiles of any size join to the same instances") {
	const Heightfield terrain = hills();
	const LayerSettings layer = row_layer();
	Transforms joined_transforms;
	for (int i = 0; i < 16; ++i) {
		const glm::dvec2 corner{-64.0 + 32.0 * (i % 4), 32.0 * (i / 4)};
		const TileInstances tile = built(layer, terrain, {corner, corner + 32.0});
		for (const MeshInstances &mesh : tile.meshes) {
			for (std::size_t at = 0; at < mesh.size(); ++at) {
				const glm::dvec3 position = world_position(tile, mesh, at);
				joined_transforms[mesh.ids[at]] = {static_cast<float>(position.x), static_cast<float>(position.z)};
			}
		}
	}
	const TileInstances whole_tile = built(layer, terrain, tile_of_hills);
	REQUIRE(size_of(whole_tile) > 150);
	CHECK(joined_transforms.size() == size_of(whole_tile));
	for (const MeshInstances &mesh : whole_tile.meshes) {
		for (std::size_t at = 0; at < mesh.size(); ++at) {
			const glm::dvec3 position = world_position(whole_tile, mesh, at);
			REQUIRE(joined_transforms.contains(mesh.ids[at]));
			CHECK(std::abs(joined_transforms[mesh.ids[at]][0] - position.x) < 1e-4);
			CHECK(std::abs(joined_transforms[mesh.ids[at]][1] - position.z) < 1e-4);
		}
	}
	check_on_threads(layer, terrain, digest(whole_tile));
}

TEST_CASE("layers in rows: instances face along their row, within the yaw of the layer") {
	LayerSettings layer = row_layer();
	layer.placement = {.min_yaw_degrees = -20.0, .max_yaw_degrees = 30.0};
	const Heightfield terrain = hills();
	const TileInstances tile = built(layer, terrain, tile_of_hills);
	for (const MeshInstances &mesh : tile.meshes) {
		for (std::size_t at = 0; at < mesh.size(); ++at) {
			const float *floats = mesh.buffer.data() + at * mesh.stride;
			const glm::dvec2 forward(-floats[2], -floats[10]);
			const Rotation heading = layer.rows->heading(mesh.ids[at]);
			const glm::dvec2 along(-heading.sine, -heading.cosine);
			// A positive yaw turns to the left, toward (along.y, -along.x).
			const double left_offset = glm::dot(forward, glm::dvec2(along.y, -along.x));
			CHECK(left_offset > -0.3422);
			CHECK(left_offset < 0.5002);
			CHECK(glm::dot(forward, along) > 0.8);
		}
	}
}

TEST_CASE("layers in rows: compact tiles return the transforms of the renderer's buffers") {
	const Heightfield terrain = hills();
	LayerSettings layer = row_layer();
	const TileInstances tile = built(layer, terrain, tile_of_hills);
	const auto compact = compact_tile(layer, tile);
	for (std::size_t mesh = 0; mesh < tile.meshes.size(); ++mesh) {
		CHECK(digest(compact->meshes[mesh]) == [&] {
			TileInstances single;
			single.meshes.push_back(tile.meshes[mesh]);
			return digest(single);
		}());
		std::vector<float> floats(tile.meshes[mesh].stride);
		for (std::size_t at = 0; at < tile.meshes[mesh].size(); ++at) {
			compact->meshes[mesh].read(at, floats);
			CHECK(std::memcmp(floats.data(), tile.meshes[mesh].buffer.data() + at * floats.size(),
						  floats.size() * sizeof(float)) == 0);
		}
	}
}

TEST_CASE("layers in rows: other layers keep their distance, and rows keep theirs from others") {
	const Heightfield terrain = hills();
	const auto rows = std::make_shared<LayerSettings>(row_layer());
	LayerSettings bushes;
	bushes.set = {.seed = 99, .radius = 1.0, .levels = 1, .layer = 4};
	bushes.neighbors = {{rows, 2.0, nullptr}};
	const auto positions = [&](const LayerSettings &layer) {
		const TileInstances tile = built(layer, terrain, tile_of_hills);
		std::vector<glm::dvec2> result;
		for (const MeshInstances &mesh : tile.meshes) {
			for (std::size_t at = 0; at < mesh.size(); ++at) {
				const glm::dvec3 position = world_position(tile, mesh, at);
				result.emplace_back(position.x, position.z);
			}
		}
		return result;
	};
	const auto nearest = [](const std::vector<glm::dvec2> &some, const std::vector<glm::dvec2> &others) {
		double distance = 1e9;
		for (const glm::dvec2 a : some) {
			for (const glm::dvec2 b : others) {
				distance = std::min(distance, glm::distance(a, b));
			}
		}
		return distance;
	};
	const std::vector<glm::dvec2> trees = positions(*rows);
	for (const bool fills : {false, true}) {
		bushes.spacing_fills = fills;
		const double distance = nearest(positions(bushes), trees);
		CHECK(distance > 1.999);
		CHECK(distance < 2.2);
	}
	LayerSettings beside_rows = *rows;
	const auto stones = std::make_shared<LayerSettings>();
	stones->set = {.seed = 12, .radius = 9.0, .levels = 1, .layer = 8};
	beside_rows.neighbors = {{stones, 4.0, nullptr}};
	beside_rows.spacing_fills = true; // Rows cannot fill gaps, so the distance only removes points.
	REQUIRE(validate(beside_rows).ok());
	const std::vector<glm::dvec2> kept_positions = positions(beside_rows);
	CHECK(kept_positions.size() < trees.size());
	CHECK(nearest(kept_positions, positions(*stones)) > 3.999);
}

TEST_CASE("layers in rows: queries find each instance by its ID") {
	World world;
	world.layers = {world_layer(row_layer(), 20.0, {0.5, 2.0})};
	world.layers[0].query_layer.rows = world.layers[0].settings.rows;
	const std::vector<PlacedInstance> all = everything_in(world, {{-100.0, -20.0}, {100.0, 140.0}});
	REQUIRE(all.size() > 150);
	const std::vector<QueryLayer> layers = world.query_layers();
	const InstanceQuery query{layers, world};
	std::vector<PlacedInstance> results;
	for (const PlacedInstance &each : all) {
		world.requests.clear();
		REQUIRE(query.by_id(each.id, results).ok());
		REQUIRE(results.size() == 1);
		CHECK(same(results.front(), each));
		CHECK(world.requests.size() == 1); // The tile follows from the place in the row.
	}
	REQUIRE(query.by_id(all.back().id + 5000, results).ok());
	CHECK(results.empty());
}

TEST_CASE("layers in rows: the nearest point of a row is found, or none") {
	const LayerSettings layer = row_layer();
	std::vector<SamplePoint> points;
	REQUIRE(layer.rows->sample(layer.set, tile_of_hills, points).ok());
	PointProbe probe;
	const std::vector<glm::dvec2> positions{points.front().position + glm::dvec2(0.01, 0.0), {0.0, 5000.0}};
	REQUIRE(probe.find(layer, {positions.data(), 1}).ok());
	CHECK(probe.points().front() == points.front());
	REQUIRE(probe.find(layer, {positions.data() + 1, 1}).ok());
	CHECK_FALSE(std::isfinite(probe.points().front().position.x));
}

TEST_CASE("layers in rows: without lines there are no points, and surfaces are rejected") {
	const Heightfield terrain = hills();
	LayerSettings layer = row_layer();
	layer.rows = nullptr;
	CHECK(size_of(built(layer, terrain, tile_of_hills)) == 0);
	layer.set.on_surface = true;
	CHECK(std::string(validate(layer).property) == "on_surfaces");
}

TEST_CASE("layers in rows: an edited line changes the areas near it, for other layers as well") {
	LayerSettings before = row_layer();
	LayerSettings after = before;
	RowLine line = *before.rows->line(0);
	line.points.back() += glm::dvec2(3.0, 0.0);
	auto rows = std::make_shared<RowSet>();
	REQUIRE(rows->set(before.rows->settings(), {line}).ok());
	after.rows = rows;
	const Rect end{line.points.back() - 1.0, line.points.back() + 1.0};
	EditSearch search;
	const EditedArea &area = search.find(before, after);
	CHECK_FALSE(area.everywhere);
	CHECK(area.touches(end));
	CHECK_FALSE(area.touches({{-80.0, 40.0}, {-60.0, 80.0}}));
	LayerSettings bushes_before;
	bushes_before.neighbors = {{std::make_shared<LayerSettings>(before), 20.0, nullptr}};
	LayerSettings bushes_after;
	bushes_after.neighbors = {{std::make_shared<LayerSettings>(after), 20.0, nullptr}};
	const EditedArea &edits = search.find(bushes_before, bushes_after);
	CHECK_FALSE(edits.everywhere);
	CHECK(edits.touches({end.max + 10.0, end.max + 11.0}));
}
