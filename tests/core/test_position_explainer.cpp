// Tests explanations of positions on the top of the ground. The caller supplies the heights step by step, as a node does.

#include "core/explain/position_explainer.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <memory>
#include <random>
#include <set>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

/// Returns a layer on gentle slopes that fills the gaps around rocks.
LayerSettings heath() {
	LayerSettings rocks;
	rocks.set = {.seed = 4, .radius = 6.0, .levels = 1, .layer = 1};
	rocks.rules.max_slope_degrees = 40.0;
	LayerSettings layer;
	layer.set = {.seed = 4, .radius = 2.0, .levels = 2, .layer = 2};
	layer.rules.max_slope_degrees = 50.0;
	layer.rules.slope_falloff_degrees = 20.0;
	layer.neighbors = {{std::make_shared<const LayerSettings>(rocks), 5.0, nullptr}};
	layer.spacing_fills = true;
	return layer;
}

PositionExplanation explanation_at(const LayerSettings &layer, const Terrain &terrain, glm::dvec2 position) {
	PositionExplainer explainer;
	std::vector<Ground> ground;
	const auto query = [&] {
		ground.assign(explainer.positions().size(), Ground{});
		REQUIRE(query_ground(terrain, explainer.positions(), explainer.queries(), ground).ok());
	};
	REQUIRE(explainer.find(layer, {position.x, 0.0, position.y}).ok());
	while (!explainer.is_complete()) {
		query();
		REQUIRE(explainer.find_further(ground).ok());
	}
	query();
	PositionExplanation explanation;
	REQUIRE(explainer.explain(ground, explanation).ok());
	return explanation;
}

} // namespace

TEST_CASE("position explainer: the verdict on a layer that fills gaps is that of its tile") {
	const Heightfield terrain = hills();
	const LayerSettings layer = heath();
	const TileInstances tile = built(layer, terrain, tile_of_hills);
	const std::set<std::uint64_t> placed(tile.meshes[0].ids.begin(), tile.meshes[0].ids.end());
	const TileInstances rocks = built(*layer.neighbors[0].layer, terrain, tile_of_hills);
	std::mt19937 random(8);
	std::uniform_real_distribution<double> meters(5.0, 123.0);
	std::size_t placed_count = 0;
	std::size_t pointless_count = 0;
	for (int i = 0; i < 300; ++i) {
		const glm::dvec2 position = tile_of_hills.min + glm::dvec2(meters(random), meters(random));
		const PositionExplanation explanation = explanation_at(layer, terrain, position);
		CHECK(explanation.is_placed() == placed.contains(explanation.point.id));
		placed_count += explanation.is_placed() ? 1 : 0;
		if (explanation.has_point) {
			CHECK(explanation.distance < layer.set.radius);
			continue;
		}
		// Only a rock can keep a position farther than the radius from all points.
		++pointless_count;
		CHECK(explanation.point.position == position);
		double nearest = std::numeric_limits<double>::infinity();
		for (std::size_t rock = 0; rock < rocks.meshes[0].size(); ++rock) {
			const glm::dvec3 at = world_position(rocks, rocks.meshes[0], rock);
			nearest = std::min(nearest, glm::distance(glm::dvec2(at.x, at.z), position));
		}
		CHECK(nearest < layer.neighbors[0].distance);
	}
	CHECK(placed_count > 30);
	CHECK(pointless_count > 20);
}

TEST_CASE("position explainer: positions that are not finite and too little ground are rejected") {
	const LayerSettings layer = heath();
	PositionExplainer explainer;
	CHECK(explainer.find(layer, {std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}).code == ErrorCode::not_finite);
	PointProbe probe;
	const glm::dvec2 nowhere(std::numeric_limits<double>::infinity(), 0.0);
	CHECK(probe.find(layer, {&nowhere, 1}).code == ErrorCode::not_finite);
	LayerSettings in_rows = layer;
	in_rows.neighbors.clear();
	in_rows.spacing_fills = false;
	in_rows.set.in_rows = true;
	CHECK(probe.find(in_rows, {&nowhere, 1}).code == ErrorCode::not_finite);
	REQUIRE(explainer.find(layer, {10.0, 0.0, 10.0}).ok());
	REQUIRE_FALSE(explainer.is_complete());
	CHECK(explainer.find_further({}).code == ErrorCode::wrong_size);
}
