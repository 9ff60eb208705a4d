// Tests layers that fill the gaps that their spacing to other layers leaves.

#include "core/placement/layer_edits.hpp"
#include "core/placement/parallel_tile_builder.hpp"
#include "core/placement/tile_builder.hpp"
#include "core/placement/tile_filter.hpp"
#include "core/terrain/flat_terrain.hpp"
#include "counted_threads.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <random>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

const FlatTerrain flat(0.0f);

std::shared_ptr<LayerSettings> layer_of(std::uint16_t index, double radius) {
	auto layer = std::make_shared<LayerSettings>();
	layer->set = {.seed = 2007, .radius = radius, .levels = 1, .layer = index};
	return layer;
}

/// Returns a layer that fills the gaps around `other`, at `distance` meters.
std::shared_ptr<LayerSettings> filling(
		std::uint16_t index, double radius, std::shared_ptr<const LayerSettings> other, double distance) {
	auto layer = layer_of(index, radius);
	layer->neighbors = {{std::move(other), distance, nullptr}};
	layer->spacing_fills = true;
	return layer;
}

using Instances = std::map<std::uint64_t, glm::dvec2>;

/// Returns the positions of a layer's instances, keyed by ID, in the double precision of the point
/// set.
Instances instance_positions(const LayerSettings &layer, const Terrain &terrain, const Rect &rect) {
	TileFilter filter{SampleMargins()};
	filter.set(layer);
	std::vector<glm::dvec2> positions;
	std::vector<GroundQuery> queries;
	std::vector<Ground> ground;
	REQUIRE(filter.sample(rect, nullptr, nullptr).ok());
	REQUIRE(filter.complete(terrain, positions, queries, ground, nullptr).ok());
	REQUIRE(filter.filter(ground, nullptr).ok());
	Instances result;
	for (const std::uint32_t point : filter.own().accepted()) {
		result.emplace(filter.own().ids()[point], filter.own().positions()[point]);
	}
	return result;
}

bool any_near(glm::dvec2 position, const Instances &placed, double distance) {
	return std::ranges::any_of(placed, [&](const auto &entry) {
		const glm::dvec2 offset = entry.second - position;
		return offset.x * offset.x + offset.y * offset.y < distance * distance;
	});
}

/// Returns how many of `count` random lattice positions of `rect` are open to an instance of the
/// layer. `all` are its instances in and around the rectangle.
int open_positions(const LayerSettings &layer, const Instances &all, const Rect &rect, int count) {
	std::vector<Instances> neighbors;
	for (const Neighbor &neighbor : layer.neighbors) {
		neighbors.push_back(instance_positions(*neighbor.layer, flat, grown(rect, neighbor.distance)));
	}
	std::mt19937_64 random(17);
	const auto along = [&random](double from, double to) {
		return from + (to - from) * (static_cast<double>(random() >> 11) * 0x1p-53);
	};
	const double unit = lattice_unit(layer.set);
	int open = 0;
	for (int i = 0; i < count; ++i) {
		glm::dvec2 position(along(rect.min.x, rect.max.x), along(rect.min.y, rect.max.y));
		if (i % 2 == 0 && !neighbors[0].empty()) {
			// The last gaps lie just outside of the spacing.
			auto random_entry = neighbors[0].begin();
			std::advance(random_entry, static_cast<std::ptrdiff_t>(random() % neighbors[0].size()));
			const double angle = along(0.0, 6.283);
			position = random_entry->second +
					(layer.neighbors[0].distance + 3.0 * unit) * glm::dvec2(std::cos(angle), std::sin(angle));
		}
		position = glm::floor(position / unit) * unit;
		bool is_open = rect.contains(position) && !any_near(position, all, layer.set.radius * (1.0 - 1e-9));
		for (std::size_t other = 0; other < neighbors.size(); ++other) {
			is_open = is_open && !any_near(position, neighbors[other], layer.neighbors[other].distance);
		}
		open += is_open ? 1 : 0;
	}
	return open;
}

/// Checks that a filled layer keeps all distances and leaves no gap.
void check_full(const LayerSettings &layer, const Rect &rect) {
	const Instances all = instance_positions(layer, flat, grown(rect, layer.set.radius));
	for (const Neighbor &neighbor : layer.neighbors) {
		const Instances expected =
				instance_positions(*neighbor.layer, flat, grown(rect, neighbor.distance + layer.set.radius));
		CHECK(std::ranges::none_of(
				all, [&](const auto &entry) { return any_near(entry.second, expected, neighbor.distance); }));
	}
	CHECK(open_positions(layer, all, rect, 3000) == 0);
}

std::size_t count_in(const LayerSettings &layer, const Rect &rect) {
	return instance_positions(layer, flat, rect).size();
}

const Rect meadow{{-40.0, 100.0}, {80.0, 220.0}};

} // namespace

TEST_CASE("fill: a filled layer keeps its distances and leaves no gap, also far from the origin") {
	const auto oaks = layer_of(0, 4.0);
	oaks->rules.density = 0.6;
	for (const Rect &rect : {Rect{{-20.0, -35.0}, {30.0, 5.0}}, Rect{{3.0, 4.0}, {9.0, 6.5}},
				 Rect{{-5e6, 5e6}, {-5e6 + 40.0, 5e6 + 25.0}}}) {
		check_full(*filling(1, 2.0, oaks, 2.5), rect);
		check_full(*filling(1, 6.0, oaks, 1.0), rect);
		const auto with_levels = filling(1, 1.5, oaks, 3.0);
		with_levels->set.levels = 3;
		check_full(*with_levels, rect);
	}
}

TEST_CASE("fill: two species of one radius are together as dense as one") {
	const auto oaks = layer_of(0, 4.0);
	oaks->rules.density = 0.5;
	LayerSettings birches = *filling(1, 4.0, oaks, 4.0);
	const std::size_t single_count = count_in(*layer_of(0, 4.0), meadow);
	const std::size_t filled_count = count_in(birches, meadow);
	birches.spacing_fills = false;
	const std::size_t thinned = count_in(birches, meadow);
	CHECK(static_cast<double>(count_in(*oaks, meadow) + filled_count) / static_cast<double>(single_count) ==
			doctest::Approx(1.0).epsilon(0.05));
	CHECK(filled_count > thinned * 17 / 10);
}

TEST_CASE("fill: any tiling has the same instances, in one step or several, on any number of threads") {
	const Heightfield terrain = hills();
	const auto oaks = layer_of(0, 5.0);
	oaks->rules.max_slope_degrees = 30.0;
	oaks->rules.edge_feather = 4.0;
	const auto birches = filling(1, 3.0, oaks, 3.5);
	birches->rules.max_height = 70.0;
	const auto ferns = filling(2, 1.0, birches, 1.2);
	ferns->neighbors.push_back({oaks, 2.0, nullptr});
	ferns->set.levels = 2;
	const Rect region{{-100.0, -60.0}, {140.0, 120.0}};
	for (const LayerSettings &layer : {*birches, *ferns}) {
		const Instances whole_region = instance_positions(layer, terrain, region);
		CHECK(whole_region.size() > 500);
		for (const double side : {14.0, 47.0}) {
			Instances parts;
			for (double y = region.max.y; y > region.min.y; y -= side) {
				for (double x = region.min.x; x < region.max.x; x += side) {
					const Rect tile{{x, std::max(y - side, region.min.y)}, {std::min(x + side, region.max.x), y}};
					parts.merge(instance_positions(layer, terrain, tile));
				}
			}
			CHECK(parts == whole_region);
		}
		const TileInstances tile = built(layer, terrain, region);
		CHECK(size_of(tile) == whole_region.size());
		CountedThreads threads(3);
		TileInstances joined_tile;
		REQUIRE(TileBuilder().build(layer, terrain, region, joined_tile, nullptr, &threads).ok());
		CHECK(transforms_of(joined_tile) == transforms_of(tile));

		TileBuilder steps;
		REQUIRE(steps.find_points(layer, region).ok());
		int count = 1;
		std::vector<Ground> ground;
		for (;; ++count) {
			ground.assign(steps.positions().size(), Ground{});
			REQUIRE(query_ground(terrain, steps.positions(), steps.queries(), ground).ok());
			if (steps.is_complete()) {
				break;
			}
			TileInstances early_tile;
			CHECK_FALSE(steps.place(ground, early_tile).ok());
			REQUIRE(steps.find_further(ground).ok());
		}
		CHECK(count >= (layer.set.layer == 1 ? 2 : 3)); // There are more if a chain leaves the first margin.
		for (int round = 0; round < 2; ++round) {
			TileInstances last;
			REQUIRE(steps.place(ground, last).ok());
			CHECK(digest(last) == digest(tile));
		}
	}
}

TEST_CASE("fill: the last of three species fills the gaps that the other two leave") {
	const auto oaks = layer_of(0, 6.0);
	oaks->rules.density = 0.7;
	const auto birches = filling(1, 4.0, oaks, 4.0);
	birches->rules.density = 0.5;
	const auto hazels = filling(2, 2.5, birches, 2.0);
	hazels->neighbors.push_back({oaks, 3.0, nullptr});
	check_full(*hazels, {{0.0, 0.0}, {60.0, 45.0}});
}

TEST_CASE("fill: an edit of the earlier layer moves points near the edit, and none beyond the edited area") {
	Shape clearing;
	clearing.kind = ShapeKind::sphere;
	clearing.exclude = true;
	clearing.center = {20.0, 0.0, 160.0};
	clearing.half_size = {12.0, 0.0, 0.0};
	const auto shapes = std::make_shared<ShapeSet>();
	REQUIRE(shapes->set({clearing}).ok());
	const auto no_shapes = std::make_shared<ShapeSet>();
	const auto oaks = layer_of(0, 4.0);
	oaks->rules.density = 0.7;
	oaks->rules.shapes = no_shapes;
	auto cut_oaks = std::make_shared<LayerSettings>(*oaks);
	cut_oaks->rules.shapes = shapes;
	const auto before = filling(1, 2.0, oaks, 2.5);
	const auto after = filling(1, 2.0, cut_oaks, 2.5);
	const auto ferns_before = filling(2, 1.0, before, 1.0);
	const auto ferns_after = filling(2, 1.0, after, 1.0);
	using Versions = std::pair<const LayerSettings *, const LayerSettings *>;
	for (const auto &[was, is] :
			{Versions{before.get(), after.get()}, Versions{ferns_before.get(), ferns_after.get()}}) {
		EditSearch search;
		const EditedArea &area = search.find(*was, *is);
		REQUIRE_FALSE(area.everywhere);
		const Instances old = instance_positions(*was, flat, meadow);
		const Instances updated = instance_positions(*is, flat, meadow);
		const auto is_far = [](glm::dvec2 position) {
			return glm::distance(position, {20.0, 160.0}) > 12.0 + 2.5;
		};
		std::size_t moved_far = 0;
		for (const auto &[id, position] : old) {
			const auto match = updated.find(id);
			if (match == updated.end() || match->second != position) {
				CHECK(area.touches({position, position}));
				moved_far += is_far(position) ? 1 : 0;
			}
		}
		for (const auto &[id, position] : updated) {
			CHECK((old.contains(id) || area.touches({position, position})));
		}
		CHECK(moved_far > 0);
		CHECK(updated.size() != old.size());
	}
	CHECK(reach(*ferns_after) > reach(*after));
	CHECK(reach(*after) > 2.5 + 13.0 * 2.0);
}

TEST_CASE("fill: proximity, surfaces and layers without neighbors do not fill") {
	const auto oaks = layer_of(0, 4.0);
	LayerSettings layer = *layer_of(1, 2.0);
	layer.spacing_fills = true;
	CHECK_FALSE(fills(layer));
	layer.neighbors = {{oaks, 3.0, std::make_shared<CurveTable>()}};
	CHECK_FALSE(fills(layer));
	layer.neighbors = {{oaks, 3.0, nullptr}};
	CHECK(fills(layer));
	const double filled_count = points_to_sample(layer, 64.0);
	layer.set.on_surface = true;
	CHECK_FALSE(fills(layer));
	layer.set.on_surface = false;
	layer.spacing_fills = false;
	CHECK_FALSE(fills(layer));
	CHECK(points_to_sample(layer, 64.0) < filled_count);
}
