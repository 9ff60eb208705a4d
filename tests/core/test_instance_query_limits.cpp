// Tests the input that queries reject, queries at the limits of the world, and the allocations of
// queries.

#include "core/query/instance_query.hpp"

#include "allocation_count.hpp"
#include "core/base/instance_id.hpp"
#include "query_fixture.hpp"
#include "refusal.hpp"
#include "rounding.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

/// A world with one layer that has no restricting rules.
struct OneLayer {
	World world;
	std::vector<QueryLayer> layers;

	explicit OneLayer(double radius, double tile_size) {
		LayerSettings settings;
		settings.set = {.seed = 4, .radius = radius, .levels = 1, .layer = 0};
		world.layers = {world_layer(settings, tile_size, {})};
		layers = world.query_layers();
	}

	InstanceQuery query() { return {layers, world, nullptr}; }
};

} // namespace

TEST_CASE("queries: the error for invalid input names the argument, and the result is empty") {
	World world;
	std::vector<QueryLayer> layers = world.query_layers();
	const InstanceQuery query{layers, world, nullptr};
	const std::vector<PlacedInstance> old(3);
	const auto check_rejected = [&](const std::function<Status(std::vector<PlacedInstance> &)> &answer, ErrorCode code,
										const std::string &property, double value) {
		std::vector<PlacedInstance> results = old;
		check_refused(answer(results), code, property, value);
		CHECK(results.empty());
	};
	const auto rect = [&](double a, double b, double c, double d) {
		return [&query, a, b, c, d](std::vector<PlacedInstance> &results) {
			return query.in_rect({{a, b}, {c, d}}, {}, results);
		};
	};
	check_rejected(rect(nan_value, 0.0, 1.0, 1.0), ErrorCode::not_finite, "rect", nan_value);
	check_rejected(rect(0.0, 0.0, 1.0, infinite_value), ErrorCode::not_finite, "rect", infinite_value);
	check_rejected(rect(0.0, 0.0, -1.0, 1.0), ErrorCode::inverted, "rect", -1.0);
	check_rejected(rect(0.0, 5.0, 1.0, 3.0), ErrorCode::inverted, "rect", -2.0);
	check_rejected(rect(0.0, 0.0, 1.0, 1e300), ErrorCode::out_of_range, "rect", 1e300);
	const auto sphere = [&](double y, double radius) {
		return [&query, y, radius](std::vector<PlacedInstance> &results) {
			return query.in_sphere({0.0, y, 0.0}, radius, {}, results);
		};
	};
	check_rejected(sphere(nan_value, 1.0), ErrorCode::not_finite, "center", nan_value);
	check_rejected(sphere(-infinite_value, 1.0), ErrorCode::not_finite, "center", -infinite_value);
	check_rejected(sphere(0.0, nan_value), ErrorCode::not_finite, "radius", nan_value);
	check_rejected(sphere(0.0, -1e-9), ErrorCode::out_of_range, "radius", -1e-9);
	check_rejected(sphere(2e15, 1.0), ErrorCode::out_of_range, "center", 2e15);
	const auto layer = [&](std::uint32_t second) {
		return [&query, second](std::vector<PlacedInstance> &results) {
			return query.in_rect(glade, {{0, second}, {}}, results);
		};
	};
	check_rejected(layer(4), ErrorCode::out_of_range, "layer", 4.0);
	check_rejected(layer(0xffffffff), ErrorCode::out_of_range, "layer", 4294967295.0);

	std::vector<RayHit> hit(1);
	check_refused(query.on_ray({0.0, 0.0, nan_value}, {}, {}, hit), ErrorCode::not_finite, "from", nan_value);
	CHECK(hit.empty());
	check_refused(query.on_ray({}, {infinite_value, 0.0, 0.0}, {}, hit), ErrorCode::not_finite, "to", infinite_value);
	check_refused(query.on_ray({}, {}, {{9}, {}}, hit), ErrorCode::out_of_range, "layer", 9.0);
	std::vector<NearestInstance> nearest(1);
	check_refused(query.nearest({nan_value, 0.0, 0.0}, 1.0, {}, nearest), ErrorCode::not_finite, "position", nan_value);
	CHECK(nearest.empty());
	check_refused(
			query.nearest({}, infinite_value, {}, nearest), ErrorCode::not_finite, "max_distance", infinite_value);
	check_refused(query.nearest({}, -1.0, {}, nearest), ErrorCode::out_of_range, "max_distance", -1.0);
	std::vector<InstanceQuery::Tile> tiles(1);
	check_refused(query.tiles_in_rect({{1.0, 0.0}, {0.0, 0.0}}, {}, tiles), ErrorCode::inverted, "rect", -1.0);
	CHECK(tiles.empty());
	check_refused(query.tiles_in_sphere({}, -1.0, {}, tiles), ErrorCode::out_of_range, "radius", -1.0);
	CHECK(world.requests.empty());
}

TEST_CASE("queries: the error for an invalid layer names the property, unless the filter skips the layer") {
	World world;
	const auto check_rejected = [&](const std::function<void(QueryLayer &)> &damage, ErrorCode code,
										const std::string &property, double value) {
		std::vector<QueryLayer> layers = world.query_layers();
		damage(layers[1]);
		const InstanceQuery query{layers, world, nullptr};
		std::vector<PlacedInstance> results;
		check_refused(query.in_rect(glade, {}, results), code, property, value);
		CHECK(query.in_rect(glade, {{0, 2}, {}}, results).ok());
		layers[1].wanted = false;
		CHECK(query.in_rect(glade, {}, results).ok());
	};
	check_rejected([](QueryLayer &layer) { layer.set.radius = 0.0; }, ErrorCode::not_positive, "radius", 0.0);
	check_rejected([](QueryLayer &layer) { layer.set.layer = 0x8000; }, ErrorCode::out_of_range, "layer_id", 32768.0);
	check_rejected(
			[](QueryLayer &layer) { layer.tile_size = nan_value; }, ErrorCode::not_finite, "tile_size", nan_value);
	check_rejected([](QueryLayer &layer) { layer.tile_size = 0.0; }, ErrorCode::not_positive, "tile_size", 0.0);
	check_rejected(
			[](QueryLayer &layer) { layer.shape.radius = -1.0; }, ErrorCode::out_of_range, "instance_radius", -1.0);
	check_rejected([](QueryLayer &layer) { layer.shape.height = infinite_value; }, ErrorCode::not_finite,
			"instance_height", infinite_value);
	check_rejected([](QueryLayer &layer) { layer.max_scale = 1e5; }, ErrorCode::out_of_range, "max_scale", 1e5);
	check_rejected([](QueryLayer &layer) { layer.max_offset = -0.5; }, ErrorCode::out_of_range, "max_offset", -0.5);
}

TEST_CASE("queries: a query for too many points is rejected before any tile is generated") {
	OneLayer dense(1.0, 50.0);
	const InstanceQuery query = dense.query();
	const double limit = InstanceQuery::max_points;
	const double tile_points = point_density(dense.layers[0].set) * 2500.0;
	const double side = std::floor(std::sqrt(limit / tile_points)) * 50.0;
	std::vector<InstanceQuery::Tile> tiles;
	std::vector<PlacedInstance> results;
	const auto code_of = [](const Status &status, const char *property) {
		CHECK((status.ok() || std::string(status.property) == property));
		return status.code;
	};
	// The square ends inside its outermost tiles, so that it touches no tiles around them.
	const auto code_in_square = [&](double width) {
		return code_of(query.tiles_in_rect({{1.0, 1.0}, {width - 1.0, width - 1.0}}, {}, tiles), "rect");
	};
	CHECK(code_in_square(side) == ErrorCode::none);
	CHECK(code_in_square(side + 50.0) == ErrorCode::too_many_points);
	CHECK(code_in_square(1e15) == ErrorCode::too_many_points);
	CHECK(code_of(query.tiles_in_sphere({}, 0.54 * side, {}, tiles), "radius") == ErrorCode::none);
	CHECK(code_of(query.tiles_in_sphere({}, 0.59 * side, {}, tiles), "radius") == ErrorCode::too_many_points);
	CHECK(code_of(query.in_sphere({}, 1e15, {}, results), "radius") == ErrorCode::too_many_points);
	std::vector<NearestInstance> nearest;
	CHECK(code_of(query.nearest({}, 1e9, {}, nearest), "max_distance") == ErrorCode::too_many_points);
	std::vector<RayHit> hit;
	CHECK(code_of(query.on_ray({}, {1e7, 0.0, 1.0}, {}, hit), "to") == ErrorCode::too_many_points);
	CHECK(code_of(query.on_ray({}, {1.0, 0.0, 1e7}, {}, hit), "to") == ErrorCode::too_many_points);
	CHECK(code_of(query.on_ray({}, {1e15, 1.0, -1e15}, {}, hit), "to") == ErrorCode::too_many_points);
	// Tiles are counted even if they are empty.
	OneLayer sparse(1000.0, 0.1);
	CHECK(code_of(sparse.query().tiles_in_rect({{0.0, 0.0}, {100.0, 100.0}}, {}, tiles), "rect") ==
			ErrorCode::too_many_points);
	CHECK(dense.world.requests.empty());
}

TEST_CASE("queries: nothing overflows at the last cells and far beyond them") {
	OneLayer layer(1.0, 64.0);
	const InstanceQuery query = layer.query();
	const double edge = 8388608.0 / std::sqrt(2.0);
	std::vector<PlacedInstance> results;
	// The rectangle covers the last whole tile, the partial one after it, and positions beyond all
	// cells.
	const double last = std::floor(edge / 64.0) * 64.0;
	REQUIRE(query.in_rect({{last - 30.0, -edge - 99.0}, {edge + 99.0, -last + 30.0}}, {}, results).ok());
	CHECK(results.size() > 400);
	for (const PlacedInstance &each : results) {
		CHECK(each.position.x < last + 1e-5);
		std::vector<PlacedInstance> repeated;
		REQUIRE(query.by_id(each.id, repeated).ok());
		REQUIRE(repeated.size() == 1);
		CHECK(same(repeated[0], each));
	}
	for (const double coordinate : {edge + 64.0, 1e9, 1e12, 9e14}) {
		for (const double sign : {-1.0, 1.0}) {
			const glm::dvec3 position(sign * coordinate, 0.0, coordinate);
			REQUIRE(query.in_sphere(position, 60.0, {}, results).ok());
			CHECK(results.empty());
			REQUIRE(query.in_rect({{position.x, position.z}, {position.x + 99.0, position.z + 99.0}}, {}, results)
							.ok());
			CHECK(results.empty());
			std::vector<NearestInstance> nearest;
			REQUIRE(query.nearest(position, 60.0, {}, nearest).ok());
			CHECK(nearest.empty());
			std::vector<RayHit> hit;
			REQUIRE(query.on_ray(position, position - glm::dvec3(sign * 60.0, 9.0, 60.0), {}, hit).ok());
			CHECK(hit.empty());
		}
	}
	for (const glm::ivec2 cell :
			{glm::ivec2(-cell_limit), glm::ivec2(cell_limit - 1), glm::ivec2(-cell_limit, cell_limit - 1)}) {
		REQUIRE(query.by_id(pack({0, cell}), results).ok());
		CHECK(results.empty());
	}
	// A set whose cells extend beyond the largest tile coordinates of this tile size.
	OneLayer wide(1e6, 0.1);
	REQUIRE(wide.query().in_rect({{1e9, 1e9}, {1e9 + 5.0, 1e9 + 5.0}}, {}, results).ok());
	CHECK(results.empty());
	REQUIRE(wide.query().by_id(pack({0, {77, -7000000}}), results).ok());
	CHECK(results.empty());
}

TEST_CASE("queries: an error of the source is returned, and an unavailable tile is empty") {
	World world;
	const std::vector<QueryLayer> layers = world.query_layers();
	const InstanceQuery query{layers, world, nullptr};
	const auto all = found_in(query, glade);
	world.failure = {ErrorCode::out_of_memory, "tile", 7.0};
	std::vector<PlacedInstance> found(1);
	check_refused(query.in_rect(glade, {}, found), ErrorCode::out_of_memory, "tile", 7.0);
	CHECK(found.empty());
	check_refused(query.by_id(all[0].id, found), ErrorCode::out_of_memory, "tile", 7.0);
	std::vector<NearestInstance> nearest(1);
	check_refused(query.nearest({}, 9.0, {}, nearest), ErrorCode::out_of_memory, "tile", 7.0);
	CHECK(nearest.empty());
	std::vector<RayHit> hit(1);
	check_refused(query.on_ray({}, {9.0, 0.0, 0.0}, {}, hit), ErrorCode::out_of_memory, "tile", 7.0);
	CHECK(hit.empty());

	world.failure = {};
	world.forget();
	world.makes = false;
	CHECK(found_in(query, glade).empty());
	REQUIRE(query.by_id(all[0].id, found).ok());
	CHECK(found.empty());
	REQUIRE(query.nearest({}, 9.0, {}, nearest).ok());
	CHECK(nearest.empty());
	REQUIRE(query.on_ray({}, {9.0, 0.0, 0.0}, {}, hit).ok());
	CHECK(hit.empty());
}

TEST_CASE("queries: the number of allocations does not depend on the number of instances") {
	OneLayer layer(0.5, 40.0);
	const InstanceQuery query = layer.query();
	std::vector<PlacedInstance> results;
	std::vector<NearestInstance> nearest;
	std::vector<RayHit> hit;
	REQUIRE(query.in_rect(glade, {}, results).ok());
	REQUIRE(results.size() > 10000);
	const auto allocated_by = [](const auto &answer) {
		const std::size_t before = allocation_count();
		REQUIRE(answer().ok());
		return allocation_count() - before;
	};
	CHECK(allocated_by([&] { return query.in_rect(glade, {}, results); }) < 80);
	CHECK(allocated_by([&] { return query.nearest({33.0, 5.0, 33.0}, 30.0, {}, nearest); }) < 80);
	CHECK(allocated_by([&] { return query.on_ray({1.0, 1.0, 1.0}, {60.0, 0.5, 50.0}, {}, hit); }) < 80);
}

TEST_CASE("queries: only large results are sorted by cells, which allocates memory") {
	const auto sorting_allocates = [](int side, int spacing) {
		FoundInstances results;
		for (int i = 0; i < side * side; ++i) {
			const glm::ivec2 cell = spacing * glm::ivec2(side - 1 - i % side, i / side);
			results.add(FoundInstances::Ref{pack({3, cell}), 0, static_cast<std::uint32_t>(i)});
		}
		const std::size_t before = allocation_count();
		results.sort_from(0);
		const std::size_t after = allocation_count();
		for (std::size_t i = 1; i < results.size(); ++i) {
			REQUIRE(results.id(i - 1) < results.id(i));
		}
		return after - before;
	};
	CHECK(sorting_allocates(50, 1) == 3); // One allocation each for the rows, the columns and the instances.
	CHECK(sorting_allocates(50, 1000) == 0);
}

TEST_CASE("queries: a position is returned without computing the whole instance") {
	OneLayer layer(0.5, 40.0);
	FoundInstances results;
	REQUIRE(layer.query().in_rect({{0.0, 0.0}, {5.0, 5.0}}, {}, results).ok());
	REQUIRE(results.size() > 10);
	// Computing the basis rounds, so this detects whether it is computed.
	CHECK_FALSE(rounds([&] { CHECK(results.position(7).x >= 0.0); }));
	CHECK(rounds([&] { CHECK(results[7].position == results.position(7)); }));
}
