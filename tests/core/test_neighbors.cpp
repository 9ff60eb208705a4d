// Tests spacing and proximity to other layers in tiles of any size.

#include "core/placement/layer_edits.hpp"
#include "core/placement/layer_graph.hpp"
#include "core/placement/tile_builder.hpp"
#include "core/terrain/flat_terrain.hpp"
#include "refusal.hpp"
#include "tests/analysis/curve_table.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

constexpr double everywhere = std::numeric_limits<double>::infinity();

std::shared_ptr<LayerSettings> layer_of(std::uint16_t index, double radius) {
	auto layer = std::make_shared<LayerSettings>();
	layer->set = {.seed = 2007, .radius = radius, .levels = 1, .layer = index};
	return layer;
}

/// Returns the positions of a layer's instances, keyed by ID, in the double precision of the point
/// set.
std::map<std::uint64_t, glm::dvec2> instance_positions(
		const LayerSettings &layer, const Terrain &terrain, const Rect &rect) {
	const TileInstances tile = built(layer, terrain, rect);
	TileSampler sampler;
	std::vector<SamplePoint> points;
	REQUIRE(sampler.sample(layer.set, rect, points).ok());
	std::map<std::uint64_t, glm::dvec2> result;
	for (const SamplePoint &point : points) {
		result.emplace(point.id, point.position);
	}
	std::set<std::uint64_t> standing_ids;
	for (const MeshInstances &mesh : tile.meshes) {
		standing_ids.insert(mesh.ids.begin(), mesh.ids.end());
	}
	std::erase_if(result, [&standing_ids](const auto &entry) { return !standing_ids.contains(entry.first); });
	return result;
}

double nearest(glm::dvec2 position, const std::map<std::uint64_t, glm::dvec2> &positions) {
	double nearest = everywhere;
	for (const auto &[id, other] : positions) {
		nearest = std::min(nearest, glm::distance(position, other));
	}
	return nearest;
}

const std::vector<Rect> windows{{{-20.0, -35.0}, {30.0, 5.0}}, {{1000.25, -7.5}, {1013.5, 60.0}},
		{{3.0, 4.0}, {9.0, 6.5}}, {{-5e6, 5e6}, {-5e6 + 40.0, 5e6 + 25.0}}};

} // namespace

TEST_CASE("neighbors: spacing removes only instances that are too near, also across the window's border") {
	const FlatTerrain terrain(0.0f);
	const auto oaks = layer_of(0, 6.0);
	oaks->rules.density = 0.6;
	const auto ferns = layer_of(1, 1.0);
	LayerSettings spaced = *ferns;
	spaced.neighbors = {{oaks, 2.5, nullptr}};
	for (const Rect &window : windows) {
		const auto trees = instance_positions(*oaks, terrain, grown(window, 10.0));
		const auto all = instance_positions(*ferns, terrain, window);
		const auto remaining = instance_positions(spaced, terrain, window);
		std::size_t expected = 0;
		for (const auto &[id, position] : all) {
			const bool remains = nearest(position, trees) >= 2.5;
			CHECK(remaining.contains(id) == remains);
			expected += remains ? 1 : 0;
		}
		CHECK(remaining.size() == expected);
		CHECK((all.size() < 20 || remaining.size() < all.size()));
	}
}

TEST_CASE("neighbors: only instances have an effect, not points that the neighbor's rules removed") {
	const Heightfield terrain = hills();
	const auto oaks = layer_of(0, 6.0);
	oaks->rules.max_slope_degrees = 20.0;
	LayerSettings ferns = *layer_of(1, 1.0);
	ferns.neighbors = {{oaks, 4.0, nullptr}};
	const auto trees = instance_positions(*oaks, terrain, grown(tile_of_hills, 10.0));
	const auto points = instance_positions(*layer_of(0, 6.0), terrain, grown(tile_of_hills, 10.0));
	CHECK(trees.size() < points.size());
	int near_absent = 0;
	for (const auto &[id, position] : instance_positions(ferns, terrain, tile_of_hills)) {
		CHECK(nearest(position, trees) >= 4.0);
		near_absent += nearest(position, points) < 4.0 ? 1 : 0;
	}
	CHECK(near_absent > 100);
}

TEST_CASE("neighbors: proximity is a density over the distance to the nearest instance") {
	const FlatTerrain terrain(0.0f);
	const auto oaks = layer_of(0, 12.0);
	LayerSettings ferns = *layer_of(1, 0.5);
	const auto all = instance_positions(ferns, terrain, tile_of_hills);
	ferns.neighbors = {{oaks, 6.0, analysis::curve_table(0.0, 6.0, {1.0f, 0.5f, 0.0f})}};
	const auto remaining = instance_positions(ferns, terrain, tile_of_hills);
	const auto trees = instance_positions(*oaks, terrain, grown(tile_of_hills, 20.0));
	std::vector<double> total(8, 0.0);
	std::vector<double> left(8, 0.0);
	for (const auto &[id, position] : all) {
		const double distance = nearest(position, trees);
		const auto ring = static_cast<std::size_t>(std::min(distance, 7.0));
		total[ring] += 1.0;
		left[ring] += remaining.contains(id) ? 1.0 : 0.0;
	}
	for (std::size_t ring = 0; ring < 6; ++ring) {
		CAPTURE(ring);
		const double expected = 1.0 - (static_cast<double>(ring) + 0.5) / 6.0;
		CHECK(std::abs(left[ring] / total[ring] - expected) < 4.0 * std::sqrt(0.25 / total[ring]) + 0.02);
	}
	CHECK(left[6] + left[7] == 0.0);
	CHECK(total[6] + total[7] > 100.0);
}

TEST_CASE("neighbors: beyond the distance, the curve's last density applies") {
	const FlatTerrain terrain(0.0f);
	const auto oaks = layer_of(0, 12.0);
	LayerSettings grass = *layer_of(1, 1.0);
	const auto all = instance_positions(grass, terrain, tile_of_hills);
	grass.neighbors = {{oaks, 3.0, analysis::curve_table(0.0, 3.0, {0.0f, 1.0f})}};
	const auto remaining = instance_positions(grass, terrain, tile_of_hills);
	const auto trees = instance_positions(*oaks, terrain, grown(tile_of_hills, 20.0));
	for (const auto &[id, position] : all) {
		if (nearest(position, trees) >= 3.0) {
			CHECK(remaining.contains(id));
		}
	}
	CHECK(remaining.size() < all.size());
	// The same is true if the other layer is empty.
	oaks->rules.density = 0.0;
	CHECK(instance_positions(grass, terrain, tile_of_hills).size() == all.size());
}

TEST_CASE("neighbors: chains are consistent across tiles of any size, in any order") {
	const Heightfield terrain = hills();
	const auto oaks = layer_of(0, 7.0);
	oaks->rules.max_slope_degrees = 35.0;
	const auto shrubs = layer_of(1, 3.0);
	shrubs->neighbors = {{oaks, 4.0, nullptr}};
	const auto stones = layer_of(2, 5.0);
	stones->neighbors = {{oaks, 3.0, nullptr}, {shrubs, 2.0, nullptr}};
	LayerSettings ferns = *layer_of(3, 1.25);
	ferns.rules.min_height = 10.0;
	ferns.neighbors = {{shrubs, 5.0, analysis::curve_table(0.0, 5.0, {1.0f, 0.25f})}, {stones, 1.5, nullptr},
			{oaks, 1.0, nullptr}};
	CHECK(reach(ferns) == 5.0 + 4.0);
	const auto whole_tile = instance_positions(ferns, terrain, tile_of_hills);
	CHECK(whole_tile.size() > 200);
	for (const double side : {64.0, 17.0, 8.5}) {
		std::map<std::uint64_t, glm::dvec2> joined_parts;
		for (double y = tile_of_hills.max.y; y > tile_of_hills.min.y; y -= side) {
			for (double x = tile_of_hills.min.x; x < tile_of_hills.max.x; x += 2.0 * side) {
				const Rect slice{{x, std::max(y - side, tile_of_hills.min.y)},
						{std::min(x + 2.0 * side, tile_of_hills.max.x), y}};
				joined_parts.merge(instance_positions(ferns, terrain, slice));
			}
		}
		CHECK(joined_parts == whole_tile);
	}
	const auto standing_stones = instance_positions(*stones, terrain, grown(tile_of_hills, 20.0));
	for (const auto &[id, position] : whole_tile) {
		CHECK(nearest(position, standing_stones) >= 1.5);
	}
}

TEST_CASE("neighbors: building in two steps produces the same tile as in one") {
	const Heightfield terrain = hills();
	const auto oaks = layer_of(0, 7.0);
	oaks->rules.max_slope_degrees = 30.0;
	LayerSettings ferns = *layer_of(3, 1.5);
	ferns.rules.edge_feather = 6.0;
	ferns.neighbors = {{oaks, 5.0, nullptr}};
	TileBuilder builder;
	REQUIRE(builder.find_points(ferns, tile_of_hills).ok());
	std::vector<Ground> ground(builder.positions().size());
	REQUIRE(terrain.sample(builder.positions(), ground).ok());
	std::size_t covered_count = 0;
	for (const GroundQuery &query : builder.queries()) {
		CHECK(query.first == covered_count);
		covered_count += query.count;
	}
	CHECK(covered_count == builder.positions().size());
	TileInstances tile;
	REQUIRE(builder.place(ground, tile).ok());
	CHECK(digest(tile) == digest(built(ferns, terrain, tile_of_hills)));
}

TEST_CASE("neighbors: the layer graph has each layer once, with the margin of the longest path") {
	const auto oaks = layer_of(0, 4.0);
	const auto shrubs = layer_of(1, 2.0);
	shrubs->neighbors = {{oaks, 20.0, nullptr}};
	LayerSettings ferns = *layer_of(2, 1.0);
	ferns.neighbors = {{oaks, 25.0, nullptr}, {shrubs, 10.0, nullptr}};
	const LayerGraph graph(ferns);
	REQUIRE(graph.status().ok());
	REQUIRE(graph.nodes().size() == 3);
	const LayerGraph::Node &tree = graph.nodes()[0];
	const LayerGraph::Node &shrub = graph.nodes()[1];
	const LayerGraph::Node &fern = graph.nodes()[2];
	CHECK((tree.layer == oaks.get() && shrub.layer == shrubs.get() && fern.layer == &ferns));
	CHECK((tree.margin == 30.0 && shrub.margin == 10.0 && fern.margin == 0.0));
	CHECK((tree.max_dependent_distance == 25.0 && shrub.max_dependent_distance == 10.0 &&
			fern.max_dependent_distance == 0.0));
	CHECK((tree.depth == 2 && shrub.depth == 1 && fern.depth == 0));
	CHECK(graph.index_of(shrubs.get()) == 1);
}

TEST_CASE("neighbors: the areas that a tile samples are known beforehand") {
	const auto oaks = layer_of(0, 4.0);
	const auto shrubs = layer_of(1, 2.0);
	shrubs->neighbors = {{oaks, 20.0, nullptr}};
	LayerSettings ferns = *layer_of(2, 1.0);
	ferns.neighbors = {{shrubs, 10.0, nullptr}};
	const auto expected = [](const LayerSettings &layer, double side) {
		return point_density(layer.set) * side * side;
	};
	CHECK(points_to_sample(*oaks, 64.0) == expected(*oaks, 64.0));
	CHECK(points_to_sample(ferns, 64.0) ==
			doctest::Approx(expected(ferns, 64.0) + expected(*shrubs, 84.0) + expected(*oaks, 124.0)));
}

TEST_CASE("neighbors: in a graph where each layer depends on all earlier ones, each layer is listed once") {
	std::vector<std::shared_ptr<const LayerSettings>> layers;
	double points = 0.0;
	for (std::size_t i = 0; i <= max_neighbor_depth; ++i) {
		const auto layer = layer_of(static_cast<std::uint16_t>(i), 2.0);
		layer->rules.edge_feather = 0.25;
		for (const auto &other : layers) {
			layer->neighbors.push_back({other, 1.5, nullptr});
		}
		layers.push_back(layer);
		const double side = 64.0 + 3.0 * static_cast<double>(i);
		points += point_density(layer->set) * side * side;
		CHECK(validate(*layer).ok());
		CHECK(reach(*layer) == doctest::Approx(1.5 * static_cast<double>(i) + 0.25));
		CHECK(points_to_sample(*layer, 64.0) == doctest::Approx(points));
	}
	LayerSettings deeper = *layer_of(20, 2.0);
	deeper.neighbors = {{layers[0], 1.0, nullptr}, {layers.back(), 1.0, nullptr}};
	check_refused(validate(deeper), ErrorCode::out_of_range, "length of the chain of layers", max_neighbor_depth + 1.0);
}

TEST_CASE("neighbors: the error for invalid input names the property") {
	LayerSettings layer = *layer_of(0, 1.0);
	const auto refuse = [&layer](const Neighbor &neighbor, ErrorCode code, const char *property, double value) {
		layer.neighbors = {neighbor};
		check_refused(validate(layer), code, property, value);
		TileInstances tile;
		CHECK_FALSE(TileBuilder().build(layer, FlatTerrain(0.0f), tile_of_hills, tile).ok());
	};
	const auto good = layer_of(1, 2.0);
	refuse({nullptr, 1.0, nullptr}, ErrorCode::missing, "neighbors", 0.0);
	refuse({good, 0.0, nullptr}, ErrorCode::not_positive, "neighbor distance", 0.0);
	refuse({good, nan_value, nullptr}, ErrorCode::not_finite, "neighbor distance", nan_value);
	refuse({good, 1001.0, nullptr}, ErrorCode::out_of_range, "neighbor distance", 1001.0);
	const auto bad = layer_of(1, -2.0);
	refuse({bad, 1.0, nullptr}, ErrorCode::not_positive, "radius", -2.0);
	auto chain = layer_of(0, 1.0);
	for (std::size_t depth = 0; depth <= max_neighbor_depth; ++depth) {
		auto next = layer_of(0, 1.0);
		next->neighbors = {{chain, 1.0, nullptr}};
		chain = next;
	}
	check_refused(validate(*chain), ErrorCode::out_of_range, "length of the chain of layers", max_neighbor_depth + 1.0);
	// Many layers in a shallow graph: 5 neighbors with 16 neighbors each.
	layer.neighbors.clear();
	for (std::uint16_t i = 0; i < 5; ++i) {
		const auto middle = layer_of(i, 1.0);
		for (std::uint16_t j = 0; j < max_neighbors; ++j) {
			middle->neighbors.push_back({layer_of(j, 1.0), 1.0, nullptr});
		}
		layer.neighbors.push_back({middle, 1.0, nullptr});
	}
	check_refused(validate(layer), ErrorCode::out_of_range, "number of layers that this one depends on",
			max_graph_layers + 1.0);
	layer.neighbors.assign(max_neighbors + 1, {good, 1.0, nullptr});
	check_refused(validate(layer), ErrorCode::out_of_range, "neighbors", max_neighbors + 1.0);
}
