// Tests that the margin of a block grows up to a limit where a chain of darts requires it, and
// never changes the result.

#include "query_fixture.hpp"

#include <doctest/doctest.h>

#include <string>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

constexpr SampleMargins no_margins{.first = 0, .widest = 0};
constexpr SampleMargins growing_margins{.first = 0, .widest = 64};

/// Checks that the error specifies the set that could not be sampled and a position in or near
/// `rect`.
void check_too_wide(const Status &status, const PointSet &set, const Rect &rect) {
	CHECK(status.code == ErrorCode::margin_too_wide);
	CHECK(status.property == std::string("rect"));
	CHECK(status.site.seed == set.seed);
	CHECK(status.site.radius == set.radius);
	const double max_offset = 200.0 * set.radius;
	CHECK(expanded(rect, max_offset).contains(status.site.position));
}

} // namespace

TEST_CASE("sample margins: a margin that has to grow produces the same points") {
	for (const std::uint32_t levels : {1u, 3u}) {
		CAPTURE(levels);
		const PointSet set{.seed = 5, .radius = 0.5, .levels = levels, .layer = 2};
		const Rect rect{{-40.0, 100.0}, {60.0, 130.0}};
		TileSampler default_sampler, narrow(growing_margins);
		std::vector<SamplePoint> expected, points;
		REQUIRE(default_sampler.sample(set, rect, expected).ok());
		REQUIRE(narrow.sample(set, rect, points).ok());
		CHECK(narrow.stats().retries > 0);
		CHECK(points == expected);
	}
}

TEST_CASE("sample margins: the error for an area that the widest margin cannot decide names the set and a position") {
	for (const std::uint32_t levels : {1u, 3u}) {
		CAPTURE(levels);
		const PointSet set{.seed = ~std::uint64_t{0}, .radius = 2.5, .levels = levels};
		const Rect rect{{1000.0, -500.0}, {1100.0, -420.0}};
		TileSampler sampler(no_margins);
		std::vector<SamplePoint> points(7);
		const Status status = sampler.sample(set, rect, points);
		check_too_wide(status, set, rect);
		CHECK(status.value == 0.0);
		CHECK(points.empty());
		const std::string text = describe(status);
		CAPTURE(text);
		CHECK(text.starts_with(
				"rect requires a wider margin of cells than is allowed, got 0 (seed 18446744073709551615, radius "
				"2.5, position ("));
		CHECK(text.find(")). Choose a different seed") != std::string::npos);
	}
	// In a large block, some darts remain undecided within the widest margin. An empty rectangle
	// needs no block, so it succeeds.
	TileSampler sampler({.first = 1, .widest = 2});
	std::vector<SamplePoint> points;
	CHECK(sampler.sample({.seed = 1}, {{0.0, 0.0}, {300.0, 300.0}}, points).value == 2.0);
	CHECK(sampler.sample({.seed = 1}, {}, points).ok());
}

TEST_CASE("sample margins: a tile that cannot be sampled stays unchanged") {
	const std::vector<WorldLayer> layers = world_layers();
	const EndlessHills terrain;
	TileBuilder default_builder, narrow(no_margins);
	TileInstances tile;
	const Rect rect{{0.0, 0.0}, {64.0, 64.0}};
	REQUIRE(default_builder.build(layers[0].settings, terrain, rect, tile).ok());
	const std::uint64_t before = digest(tile);
	check_too_wide(narrow.build(layers[0].settings, terrain, rect, tile), layers[0].settings.set, rect);
	CHECK(digest(tile) == before);
	// The neighbors of a layer are sampled before the layer.
	check_too_wide(narrow.build(layers[1].settings, terrain, rect, tile), layers[0].settings.set, rect);
	TileBuilder patient(growing_margins);
	REQUIRE(patient.build(layers[0].settings, terrain, rect, tile).ok());
	CHECK(digest(tile) == before);
}

TEST_CASE("sample margins: queries return the error of a tile that could not be sampled") {
	World world(no_margins);
	const std::vector<QueryLayer> query_layers = world.query_layers();
	const InstanceQuery query{query_layers, world, nullptr, no_margins};
	const PointSet &trees = query_layers[0].set;
	std::vector<PlacedInstance> found(3);
	check_too_wide(query.in_rect(glade, {}, found), trees, glade);
	CHECK(found.empty());
	found.resize(3);
	check_too_wide(query.in_sphere({30.0, 0.0, 30.0}, 20.0, {}, found), trees, glade);
	CHECK(found.empty());
	std::vector<NearestInstance> nearest(3);
	check_too_wide(query.nearest({30.0, 0.0, 30.0}, 20.0, {.layers = {0}, .accepts = {}}, nearest), trees, glade);
	CHECK(nearest.empty());
	std::vector<RayHit> hit(3);
	check_too_wide(
			query.on_ray({30.0, 50.0, 30.0}, {31.0, -50.0, 31.0}, {.layers = {0}, .accepts = {}}, hit), trees, glade);
	CHECK(hit.empty());
	// The tiles of the stones are smaller than the cells of their set. Therefore, the query samples the set
	// before it reads any tile.
	const PointSet &stones = query_layers[2].set;
	TileSampler sampler;
	std::vector<SamplePoint> points;
	REQUIRE(sampler.sample(stones, glade, points).ok());
	world.requests.clear();
	found.resize(3);
	check_too_wide(query.by_id(points.front().id, found), stones, glade);
	CHECK(found.empty());
	CHECK(world.requests.empty());
}
