// Tests density rules: their product, their queries on any ground, bounds, threads and errors.

#include "core/explain/density_probe.hpp"
#include "core/explain/rule_messages.hpp"
#include "core/terrain/triangle_parts.hpp"
#include "refusal.hpp"
#include "surface_fixture.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

/// A density of `west` for x below 0 and of `east` elsewhere.
class Halves final : public DensityRule {
public:
	float west = 0.25f;
	float east = 0.75f;
	bool thread_safe = true;
	bool has_bounds = false;
	Status failure;
	mutable std::size_t query_count = 0;
	mutable double lowest_x = 1e9;

	bool is_thread_safe() const override { return thread_safe; }

	Status sample(const DensityBatch &batch, std::span<float> r_densities) const override {
		query_count += r_densities.size();
		for (std::size_t i = 0; i < r_densities.size(); ++i) {
			lowest_x = std::min(lowest_x, batch.positions[i].x);
			r_densities[i] = batch.positions[i].x < 0.0 ? west : east;
		}
		return failure;
	}

	Status find_closed(const Box3 &box, bool &r_closed) const override {
		r_closed = has_bounds && ((west <= 0.0f && box.max.x <= 0.0) || (east <= 0.0f && box.min.x >= 0.0));
		return {};
	}
};

constexpr const char *same_halves = "0.25 + 0.5 * (x >= 0)";

/// Returns a layer with the density of Halves as an expression.
LayerSettings by_expression(LayerSettings layer) {
	ExpressionError error;
	layer.rules.expression = DensityExpression::compile(same_halves, error);
	REQUIRE(layer.rules.expression != nullptr);
	return layer;
}

LayerSettings by_rule(LayerSettings layer, bool thread_safe = true) {
	auto rule = std::make_shared<Halves>();
	rule->thread_safe = thread_safe;
	layer.rules.density_rules = {rule};
	return layer;
}

/// Generates a tile in steps. As on the main thread, rules are queried separately from the ground.
TileInstances built_in_steps(const LayerSettings &layer, const Terrain &terrain, const Rect &rect) {
	TileBuilder builder;
	TileInstances tile;
	std::vector<Ground> ground;
	const auto query = [&] {
		ground.assign(builder.positions().size(), Ground());
		REQUIRE(query_terrain(terrain, builder.positions(), builder.queries(), ground).ok());
		for (const GroundQuery &query : builder.queries()) {
			for (std::size_t i = query.first; i < query.first + query.count; ++i) {
				CHECK(ground[i].density == 1.0f);
				REQUIRE(query.density.query({&builder.positions()[i], 1}, {&ground[i], 1}).ok());
			}
		}
	};
	REQUIRE(builder.find_points(layer, rect, nullptr, nullptr, terrain.surface()).ok());
	query();
	while (!builder.is_complete()) {
		REQUIRE(builder.find_further(ground).ok());
		query();
	}
	REQUIRE(builder.place(ground, tile).ok());
	return tile;
}

void check_same_tiles(const LayerSettings &layer, const Terrain &terrain, const Rect &rect) {
	const TileInstances expected = built(by_expression(layer), terrain, rect);
	CHECK(size_of(expected) > 100);
	CHECK(size_of(expected) < size_of(built(layer, terrain, rect)));
	CHECK(digest(built(by_rule(layer), terrain, rect)) == digest(expected));
	CHECK(digest(built_in_steps(by_rule(layer, false), terrain, rect)) == digest(expected));
}

TriangleParts ground_of(const surfaces::Triangles &triangles) {
	std::vector<glm::dvec3> corners;
	for (const std::uint32_t index : triangles.indices) {
		corners.push_back(triangles.vertices[index]);
	}
	auto terrain_part = std::make_shared<TriangleTerrain>();
	REQUIRE(terrain_part->set(corners, nullptr, Winding::counterclockwise).ok());
	TriangleParts ground;
	REQUIRE(ground.set(std::vector<TriangleParts::Part>{terrain_part}).ok());
	return ground;
}

LayerSettings on_surfaces() {
	LayerSettings layer;
	layer.set = {.seed = 3, .radius = 0.7, .levels = 1, .layer = 7, .on_surface = true};
	layer.rules.max_slope_degrees = 180.0;
	return layer;
}

/// Moss on spheres that are placed like the instances of rich_layer.
LayerSettings on_models() {
	LayerSettings layer = on_surfaces();
	layer.set.radius = 0.4;
	layer.hosted = true;
	LayerSettings host = rich_layer();
	host.set.radius = 6.0;
	host.mesh_weights = {};
	const auto models = std::make_shared<const HostModels>(std::vector{surfaces::sphere(1.2, 8).surface()});
	layer.hosts = {{std::make_shared<const LayerSettings>(host), models, nullptr}};
	return layer;
}

} // namespace

TEST_CASE("density rules: tiles equal those of the same expression, in one or in several steps") {
	const Heightfield ground = hills();
	check_same_tiles(rich_layer(), ground, tile_of_hills);
	LayerSettings edged = rich_layer();
	edged.rules.edge_feather = 4.0;
	check_same_tiles(edged, ground, tile_of_hills);
	check_same_tiles(on_models(), ground, {{-20.0, 0.0}, {20.0, 40.0}});
	LayerSettings edged_models = on_models();
	edged_models.rules.edge_feather = 0.5;
	check_same_tiles(edged_models, ground, {{-20.0, 0.0}, {20.0, 40.0}});
	LayerSettings filled = rich_layer();
	filled.spacing_fills = true;
	LayerSettings trees = by_rule(rich_layer());
	trees.set.radius = 5.0;
	trees.set.layer = 4;
	filled.neighbors = {{std::make_shared<LayerSettings>(trees), 3.0, nullptr}};
	check_same_tiles(filled, ground, tile_of_hills);
}

TEST_CASE("density rules: layers on surfaces equal those of the same expression") {
	const TriangleParts ground = ground_of(surfaces::sphere(9.0, 24));
	check_same_tiles(on_surfaces(), ground, {{-12.0, -12.0}, {12.0, 12.0}});
	LayerSettings edged = on_surfaces();
	edged.rules.max_slope_degrees = 60.0;
	edged.rules.edge_feather = 1.0;
	check_same_tiles(edged, ground, {{-12.0, -12.0}, {12.0, 12.0}});
	LayerSettings on_planet = on_surfaces();
	on_planet.planet = {{0.0, 0.0, 0.0}, 9.0};
	check_same_tiles(on_planet, ground, {{-12.0, -12.0}, {12.0, 12.0}});
}

TEST_CASE("density rules: a rule that is 0 in a tile is not evaluated, and a thread-safe one saves the sampling") {
	const Heightfield ground = hills();
	constexpr Rect west{{-64.0, 0.0}, {0.0, 64.0}};
	for (const bool thread_safe : {false, true}) {
		CAPTURE(thread_safe);
		auto rule = std::make_shared<Halves>();
		rule->thread_safe = thread_safe;
		rule->has_bounds = true;
		rule->west = 0.0f;
		LayerSettings layer = rich_layer();
		layer.rules.density_rules = {rule};
		const TileInstances empty = built(layer, ground, west);
		CHECK(size_of(empty) == 0);
		CHECK((empty.counts.sampled == 0) == thread_safe);
		CHECK(rule->query_count == 0);
		const TileInstances both_rules = built(layer, ground, tile_of_hills);
		CHECK(size_of(both_rules) > 100);
		CHECK(rule->query_count > 100);
		rule->has_bounds = false;
		CHECK(digest(built(layer, ground, tile_of_hills)) == digest(both_rules));
	}
}

TEST_CASE("density rules: densities are multiplied, clamped and explained one by one") {
	auto outside = std::make_shared<Halves>();
	outside->west = 5.0f;
	outside->east = std::nanf("");
	LayerSettings layer = by_rule(by_rule(rich_layer()));
	layer.rules.density_rules.push_back(outside);
	layer.rules.density_rules.push_back(layer.rules.density_rules.front());
	const std::vector<glm::dvec2> positions{{-1.0, 0.0}, {1.0, 0.0}, {3.0, 0.0}};
	DensityProbe probe;
	REQUIRE(probe.find(layer, positions).ok());
	std::vector<Ground> ground(3, Ground{50.0f, {0.0f, 1.0f, 0.0f}});
	ground[2] = Ground();
	for (const GroundQuery &query : probe.queries()) {
		REQUIRE(query.density.query(positions, ground).ok());
	}
	CHECK(ground[0].density == 0.0625f);
	CHECK(ground[1].density == 0.0f);
	CHECK(ground[2].density == 1.0f);
	REQUIRE(probe.evaluate(ground).ok());
	CHECK(probe.density_at(0) == 0.0625);
	CHECK(probe.density_at(1) == 0.0);
	std::vector<RuleFactor> factors;
	REQUIRE(probe.factors_at(0, factors).ok());
	std::vector<double> of_rules;
	for (const RuleFactor &factor : factors) {
		if (factor.rule == RuleKind::density_rule) {
			CHECK(factor.index == of_rules.size());
			of_rules.push_back(factor.density);
		}
	}
	CHECK(of_rules == std::vector<double>{0.25, 1.0, 0.25});
	CHECK(product_of(factors) == 0.0625);
	REQUIRE(probe.factors_at(2, factors).ok());
	CHECK(factors.back().rule == RuleKind::ground);
	RuleNames names;
	names.density_rules = {"Roads"};
	const RuleMessage message = describe({RuleKind::density_rule, 0.25, 0.25, 0}, layer, names);
	CHECK(message.rule == "density_rules");
	CHECK(message.message == "The density rule Roads permits 25 % of the instances here.");
	CHECK(describe({RuleKind::density_rule, 0.0, 0.0, 1}, layer, names).message ==
			"The density rule without a name permits no instances here.");
}

TEST_CASE("density rules: layers that depend on a rule for the main thread are found") {
	CHECK_FALSE(needs_main_thread(rich_layer()));
	CHECK_FALSE(needs_main_thread(by_rule(rich_layer())));
	CHECK(needs_main_thread(by_rule(rich_layer(), false)));
	LayerSettings dependent = rich_layer();
	LayerSettings trees = by_rule(rich_layer(), false);
	trees.set.layer = 4;
	dependent.neighbors = {{std::make_shared<LayerSettings>(trees), 3.0, nullptr}};
	CHECK(needs_main_thread(dependent));
	LayerSettings moss = on_models();
	CHECK_FALSE(needs_main_thread(moss));
	moss.hosts[0].layer = std::make_shared<LayerSettings>(trees);
	CHECK(needs_main_thread(moss));
}

TEST_CASE("density rules: errors of rules and invalid lists are returned") {
	auto failing = std::make_shared<Halves>();
	failing->failure = Status::wrong_size("densities", 3.0, exactly(4));
	LayerSettings layer = rich_layer();
	layer.rules.density_rules = {failing};
	TileBuilder builder;
	TileInstances tile;
	check_refused(builder.build(layer, hills(), tile_of_hills, tile), ErrorCode::wrong_size, "densities", 3.0);
	DensityProbe probe;
	const std::vector<glm::dvec2> positions{{1.0, 0.0}};
	REQUIRE(probe.find(layer, positions).ok());
	REQUIRE(probe.evaluate(std::vector<Ground>{{50.0f}}).ok());
	std::vector<RuleFactor> factors;
	check_refused(probe.factors_at(0, factors), ErrorCode::wrong_size, "densities", 3.0);
	layer.rules.density_rules = {nullptr};
	check_refused(validate(layer), ErrorCode::missing, "density_rules", 0.0);
	layer.rules.density_rules.assign(17, std::make_shared<Halves>());
	check_refused(validate(layer), ErrorCode::wrong_size, "density_rules", 17.0);
	LayerSettings meshes = rich_layer();
	meshes.mesh_rules = {open_rules()};
	meshes.mesh_rules[0]->density_rules = {std::make_shared<Halves>()};
	CHECK(validate(meshes).code == ErrorCode::wrong_type);
}
