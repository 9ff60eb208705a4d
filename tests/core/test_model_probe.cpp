// Tests explanations of positions on the models of other layers.

#include "core/explain/model_probe.hpp"
#include "core/explain/position_explainer.hpp"
#include "core/terrain/flat_terrain.hpp"
#include "placement_fixture.hpp"
#include "surface_fixture.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <memory>
#include <string_view>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

LayerSettings moss_on_spheres() {
	LayerSettings stones;
	stones.set = {.seed = 5, .radius = 5.0, .levels = 1, .layer = 1};
	LayerSettings moss;
	moss.set = {.seed = 5, .radius = 0.3, .levels = 1, .layer = 2, .on_surface = true};
	moss.rules.max_slope_degrees = 60.0;
	moss.hosted = true;
	moss.hosts = {{std::make_shared<const LayerSettings>(stones),
			std::make_shared<const HostModels>(std::vector{surfaces::sphere(1.0, 12).surface()}), nullptr}};
	return moss;
}

} // namespace

TEST_CASE("model probe: the instances on a model are explained, and so are positions away from models") {
	const FlatTerrain ground(3.0);
	const LayerSettings moss = moss_on_spheres();
	const TileInstances tile = built(moss, ground, {{-10.0, -10.0}, {10.0, 10.0}});
	REQUIRE(tile.meshes[0].size() > 100);
	std::vector<Ground> heights;
	ModelProbe probe;
	std::unique_ptr<const Surface> models;
	PositionExplainer explainer;
	const auto explain = [&](const glm::dvec3 &position, PositionExplanation &r_explanation) {
		REQUIRE(probe.find(moss, position, nullptr).ok());
		heights.assign(probe.positions().size(), Ground{});
		REQUIRE(query_ground(ground, probe.positions(), probe.queries(), heights).ok());
		REQUIRE(probe.models(heights, models).ok());
		Status status = explainer.find(moss, position, nullptr, models.get());
		if (status.ok()) {
			heights.assign(explainer.positions().size(), Ground{});
			REQUIRE(query_ground(ground, explainer.positions(), explainer.queries(), heights).ok());
			status = explainer.explain(heights, r_explanation);
		}
		return status;
	};
	for (std::size_t i = 0; i < tile.meshes[0].size(); i += 10) {
		PositionExplanation explanation;
		REQUIRE(explain(world_position(tile, tile.meshes[0], i), explanation).ok());
		CHECK(explanation.point.id == tile.meshes[0].ids[i]);
		CHECK(explanation.is_placed());
	}
	PositionExplanation explanation;
	const glm::dvec3 first = world_position(tile, tile.meshes[0], 0);
	CHECK(std::string_view(explain(first + glm::dvec3(0.0, 2.0, 0.0), explanation).property) ==
			"model of surface_layers");
	CHECK(std::string_view(explainer.find(moss, first).property) == "model of surface_layers");
	heights.resize(1000);
	CHECK(std::string_view(probe.models(heights, models).property) == "ground");
}
