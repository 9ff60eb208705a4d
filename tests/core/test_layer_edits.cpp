// Tests the rectangles that an edit of shapes, masks and paths affects, also through neighbors and
// edge feathers.

#include "core/placement/layer_edits.hpp"
#include "core/rules/shape_edits.hpp"
#include "refusal.hpp"
#include "rounding.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

using namespace thicket;
using test::rounds;

namespace {

Shape ball(glm::dvec2 at, double radius, bool exclude = true) {
	Shape shape;
	shape.kind = ShapeKind::sphere;
	shape.exclude = exclude;
	shape.center = {at.x, 0.0, at.y};
	shape.half_size = {radius, 0.0, 0.0};
	return shape;
}

std::shared_ptr<const ShapeSet> set_of(std::vector<Shape> shapes) {
	auto set = std::make_shared<ShapeSet>();
	REQUIRE(set->set(std::move(shapes)).ok());
	return set;
}

std::shared_ptr<LayerSettings> layer_with(std::vector<Shape> shapes) {
	auto layer = std::make_shared<LayerSettings>();
	layer->rules.shapes = set_of(std::move(shapes));
	return layer;
}

bool near(const Rect &a, const Rect &b, double tolerance = 0.01) {
	const auto close = [tolerance](glm::dvec2 p, glm::dvec2 q) {
		return std::abs(p.x - q.x) <= tolerance && std::abs(p.y - q.y) <= tolerance;
	};
	return close(a.min, b.min) && close(a.max, b.max);
}

bool contains(const std::vector<Rect> &areas, glm::dvec2 position) {
	return std::ranges::any_of(areas, [position](const Rect &area) { return area.contains(position); });
}

} // namespace

TEST_CASE("edits of shapes: a moved shape touches its old and its new area, in any order") {
	const auto before = set_of({ball({0.0, 0.0}, 2.0), ball({50.0, 0.0}, 3.0), ball({90.0, 90.0}, 1.0)});
	const auto after = set_of({ball({90.0, 90.0}, 1.0), ball({50.0, 10.0}, 3.0), ball({0.0, 0.0}, 2.0)});
	std::vector<Rect> areas;
	REQUIRE(find_shape_edits(before.get(), after.get(), areas));
	REQUIRE(areas.size() == 2);
	CHECK(near(areas[0], {{47.0, 7.0}, {53.0, 13.0}}));
	CHECK(near(areas[1], {{47.0, -3.0}, {53.0, 3.0}}));
	areas.clear();
	CHECK(find_shape_edits(before.get(), before.get(), areas));
	CHECK(find_shape_edits(nullptr, nullptr, areas));
	CHECK(areas.empty());
	// Two equal shapes count twice.
	const auto two_balls = set_of({ball({0.0, 0.0}, 2.0), ball({0.0, 0.0}, 2.0)});
	const auto one_ball = set_of({ball({0.0, 0.0}, 2.0)});
	CHECK(find_shape_edits(two_balls.get(), one_ball.get(), areas));
	CHECK(areas.size() == 1);
}

TEST_CASE("edits of shapes: adding the first including shape, or removing the last, touches everything") {
	const auto outside = set_of({ball({0.0, 0.0}, 2.0)});
	const auto two_places = set_of({ball({0.0, 0.0}, 2.0), ball({9.0, 0.0}, 2.0, false)});
	const auto two = set_of({ball({0.0, 0.0}, 2.0), ball({9.0, 0.0}, 2.0, false), ball({30.0, 0.0}, 2.0, false)});
	std::vector<Rect> areas;
	CHECK_FALSE(find_shape_edits(outside.get(), two_places.get(), areas));
	CHECK_FALSE(find_shape_edits(two_places.get(), nullptr, areas));
	CHECK(areas.empty());
	CHECK(find_shape_edits(two_places.get(), two.get(), areas));
	REQUIRE(areas.size() == 1);
	CHECK(near(areas[0], {{28.0, -2.0}, {32.0, 2.0}}));
}

TEST_CASE("edits of shapes: a long path touches only the area along it") {
	Shape road;
	road.kind = ShapeKind::path;
	road.half_size.x = 2.0;
	for (int i = 0; i <= 1000; ++i) {
		road.outline.emplace_back(i, i);
	}
	std::vector<Rect> areas;
	REQUIRE(add_touched(road, areas).ok());
	CHECK(areas.size() <= max_path_pieces);
	CHECK_FALSE(contains(areas, {100.0, 900.0}));
	for (const glm::dvec2 position : road.outline) {
		CHECK(contains(areas, position + glm::dvec2(1.4, -1.4)));
	}
	road.outline.resize(2);
	areas.clear();
	REQUIRE(add_touched(road, areas).ok());
	REQUIRE(areas.size() == 1);
	CHECK(near(areas[0], bounds(road)));
}

TEST_CASE("edits of a mask: the pixels that differ, and the reach of their blending") {
	PaintedMask before;
	REQUIRE(before.reset(0.5, 1.0).ok());
	PaintedMask after = before;
	Rect area;
	CHECK_FALSE(before.differs(after, area));
	CHECK(area.empty());
	Rect changed_rect;
	const std::vector<std::uint8_t> dark(6, 7);
	// The pixels are around a corner that four blocks share.
	REQUIRE(after.write({{63, -1}, {66, 1}}, dark, changed_rect).ok());
	CHECK(before.differs(after, area));
	CHECK(near(area, {{31.25, -0.75}, {33.25, 0.75}}, 1e-9));
	CHECK(near(area, changed_rect, 1e-9));
	Rect reversed_rect;
	CHECK(after.differs(before, reversed_rect));
	CHECK(near(area, reversed_rect, 0.0));
	// After the pixels are painted back, nothing differs.
	const std::vector<std::uint8_t> bright(6, 255);
	REQUIRE(after.write({{63, -1}, {66, 1}}, bright, changed_rect).ok());
	CHECK_FALSE(before.differs(after, area));

	PaintedMask other;
	REQUIRE(other.reset(0.25, 1.0).ok());
	CHECK(before.differs(other, area));
	CHECK_FALSE(area.finite());
}

TEST_CASE("edits of a layer: grown by its edge, and by the distances along chains of neighbors") {
	const auto oak_before = layer_with({ball({0.0, 0.0}, 2.0)});
	const auto oak_after = layer_with({});
	const auto link = [](const std::shared_ptr<LayerSettings> &oak) {
		auto birch = std::make_shared<LayerSettings>();
		birch->set.layer = 1;
		birch->neighbors = {{oak, 3.0, nullptr}};
		auto fern = std::make_shared<LayerSettings>();
		fern->set.layer = 2;
		fern->neighbors = {{birch, 4.0, nullptr}, {oak, 1.0, nullptr}};
		return fern;
	};
	oak_before->rules.edge_feather = oak_after->rules.edge_feather = 5.0;
	const auto before = link(oak_before);
	const auto after = link(oak_after);
	EditSearch search;
	const EditedArea own_edits = search.find(*oak_before, *oak_after);
	CHECK_FALSE(own_edits.everywhere);
	REQUIRE(own_edits.areas.size() == 1);
	CHECK(near(own_edits.areas[0], {{-7.0, -7.0}, {7.0, 7.0}}, 0.02));
	const EditedArea linked_edits = search.find(*before, *after);
	CHECK_FALSE(linked_edits.everywhere);
	REQUIRE(linked_edits.areas.size() ==
			1); // The area that the shorter chain affects is within the area of the longer one.
	CHECK(near(linked_edits.areas[0], {{-14.0, -14.0}, {14.0, 14.0}}, 0.05));
	CHECK(linked_edits.areas[0].min.x < -14.0);
	CHECK(search.find(*before, *before).empty());
}

TEST_CASE("edits of a layer: a changed setting affects everything, a neighbor's placement nothing") {
	const auto oak = layer_with({});
	LayerSettings before;
	before.set.layer = 1;
	before.neighbors = {{oak, 3.0, nullptr}};
	EditSearch search;
	const auto everywhere_after = [&](const auto &change) {
		auto changed_oak = std::make_shared<LayerSettings>(*oak);
		LayerSettings after = before;
		change(after, *changed_oak);
		after.neighbors[0].layer = changed_oak;
		const EditedArea area = EditSearch().find(before, after);
		CHECK(area.areas.empty());
		return area.everywhere;
	};
	CHECK_FALSE(everywhere_after([](LayerSettings &, LayerSettings &) {}));
	CHECK(everywhere_after([](LayerSettings &layer, LayerSettings &) { layer.rules.density = 0.5; }));
	CHECK(everywhere_after([](LayerSettings &layer, LayerSettings &) { layer.placement.max_scale = 2.0; }));
	CHECK(everywhere_after([](LayerSettings &layer, LayerSettings &) { layer.mesh_weights = {1.0f, 2.0f}; }));
	CHECK(everywhere_after([](LayerSettings &layer, LayerSettings &) { layer.neighbors[0].distance = 4.0; }));
	CHECK(everywhere_after([](LayerSettings &, LayerSettings &other) { other.rules.density = 0.5; }));
	CHECK(everywhere_after([](LayerSettings &, LayerSettings &other) { other.set.seed = 5; }));
	CHECK_FALSE(everywhere_after([](LayerSettings &, LayerSettings &other) { other.placement.max_scale = 2.0; }));
	CHECK_FALSE(everywhere_after([](LayerSettings &, LayerSettings &other) { other.mesh_weights = {1.0f, 2.0f}; }));
	CHECK(everywhere_after([](LayerSettings &layer, LayerSettings &) {
		auto mask = std::make_shared<PaintedMask>();
		layer.rules.mask = mask;
	}));
}

TEST_CASE("edited areas: no area is inside another, and growing rounds outward") {
	EditedArea area;
	area.add(Rect{{0.0, 0.0}, {1.0, 1.0}});
	area.add(Rect{{5.0, 5.0}, {6.0, 6.0}});
	area.add(Rect{{0.2, 0.2}, {0.5, 0.5}});
	area.add(Rect{{3.0, 3.0}, {3.0, 4.0}});
	CHECK(area.areas.size() == 2);
	area.add(Rect{{1.0, 1.0}, {2.0, 2.0}}, 5.0);
	REQUIRE(area.areas.size() == 1);
	CHECK(near(area.areas[0], {{-4.0, -4.0}, {7.0, 7.0}}));
	CHECK(area.areas[0].min.x < -4.0);
	CHECK(grown({{0.0, 0.0}, {1.0, 1.0}}, 0.0).max == glm::dvec2(1.0, 1.0));
}

TEST_CASE("edits of a layer: results are cached, for the layer and for its neighbors") {
	const auto trees_before = layer_with({ball({0.0, 0.0}, 2.0)});
	const auto trees_after = layer_with({ball({0.0, 0.0}, 3.0)});
	LayerSettings before;
	before.neighbors = {{trees_before, 5.0, nullptr}};
	LayerSettings after;
	after.neighbors = {{trees_after, 5.0, nullptr}};
	for (LayerSettings *layer : {&before, &after}) { // The sources of the layers depend on the trees as well.
		layer->instance_data.use_custom_data = true;
		layer->instance_data.variation.kind = SourceKind::distance;
		layer->instance_data.variation.layer = layer->neighbors[0].layer;
		layer->instance_data.variation.max = 3.0;
	}
	LayerSettings others_before = before;
	LayerSettings others_after = after;
	EditSearch search;
	// Expanding an area rounds, so a result without rounding comes from the cache.
	CHECK(rounds([&] { REQUIRE(search.find(before, after).areas.size() == 1); }));
	CHECK(near(search.find(before, after).areas[0], {glm::dvec2(-8.0), glm::dvec2(8.0)}, 0.1));
	CHECK_FALSE(rounds([&] { REQUIRE(search.find(before, after).areas.size() == 1); }));
	trees_after->rules.density = 0.5; // A search without this cache would report that everything differs.
	CHECK_FALSE(search.find(others_before, others_after).everywhere);
	CHECK(EditSearch().find(before, after).everywhere);
}
