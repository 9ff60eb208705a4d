#include "core/drawing/lod.hpp"
#include "core/drawing/lod_schedule.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <random>
#include <vector>

using namespace thicket;

namespace {

TileKey key_of(int x) { return {0, 1, {x, 0}}; }

std::vector<int> due(LodSchedule &schedule) {
	std::vector<int> result;
	while (const auto due_tile = schedule.next()) {
		result.push_back(due_tile->tile.x);
	}
	return result;
}

} // namespace

TEST_CASE("lod schedule: a tile is checked once viewers have moved as far as its margin") {
	LodSchedule schedule;
	CHECK(schedule.move(std::vector<Viewer>{{{0.0, 0.0}}}));
	schedule.add(key_of(1), 0.0);
	schedule.add(key_of(2), 10.0);
	schedule.add(key_of(3), 4.0);
	schedule.add(key_of(4), std::numeric_limits<double>::infinity());
	CHECK_FALSE(schedule.settled());
	CHECK(due(schedule) == std::vector{1});
	CHECK(schedule.settled());
	CHECK_FALSE(schedule.move(std::vector<Viewer>{{{3.0, 0.0}}}));
	CHECK(due(schedule).empty());
	CHECK_FALSE(schedule.move(std::vector<Viewer>{{{0.0, 0.0}}})); // The viewer returns, so it has moved 6 m in total.
	CHECK(due(schedule) == std::vector{3});
	CHECK_FALSE(schedule.move(std::vector<Viewer>{{{0.0, 0.0}, 1.0, 5.0}})); // The viewer moves up.
	CHECK(due(schedule) == std::vector{2});
	CHECK_FALSE(schedule.move(std::vector<Viewer>{{{1e6, 0.0}}}));
	CHECK(due(schedule).empty());
	CHECK(schedule.move(std::vector<Viewer>{{{1e6, 0.0}}, {{0.0, 0.0}}}));
	schedule.add(key_of(5), 0.0);
	schedule.clear();
	CHECK(due(schedule).empty());
}

TEST_CASE("lod schedule: a tile has one pending visit, no matter how often it is scheduled") {
	LodSchedule schedule;
	schedule.move(std::vector<Viewer>{{{0.0, 0.0}}});
	for (int time = 0; time < 1000; ++time) {
		schedule.add(key_of(1), 5.0 + time % 3);
		schedule.add(key_of(2), 3.0);
	}
	CHECK(schedule.size() == 2);
	schedule.move(std::vector<Viewer>{{{4.0, 0.0}}});
	CHECK(due(schedule) == std::vector{2});
	schedule.move(std::vector<Viewer>{{{5.0, 0.0}}});
	CHECK(due(schedule) == std::vector{1}); // Only the last margin applies, which is 5 m.
	CHECK(schedule.size() == 0);
	schedule.add(key_of(1), 0.0);
	schedule.add(key_of(2), 0.0);
	schedule.remove(key_of(1));
	schedule.remove(key_of(3)); // This tile was never scheduled.
	schedule.add(key_of(2), std::numeric_limits<double>::infinity());
	CHECK(schedule.size() == 0);
	CHECK(schedule.settled());
}

TEST_CASE("lod schedule: distances are measured from the nearest viewer, in three dimensions up to the height limit") {
	LodSchedule schedule;
	Sight sight;
	const auto near_distance = [&](glm::dvec3 min, glm::dvec3 max) {
		return schedule.distances_to(min, max, sight).near;
	};
	CHECK(near_distance(glm::dvec3(0.0), glm::dvec3(1.0)) == std::numeric_limits<double>::infinity());
	schedule.move(std::vector<Viewer>{{{-3.0, 0.5}, 1.0, 5.0}, {{100.0, 100.0}, 1.0, 0.5}});
	CHECK(near_distance(glm::dvec3(0.0), glm::dvec3(1.0)) == doctest::Approx(5.0));
	CHECK(near_distance(glm::dvec3(99.0, 0.0, 99.0), glm::dvec3(101.0, 1.0, 101.0)) == 0.0);
	sight = {5.0, 0.2};
	CHECK(near_distance(glm::dvec3(0.0), glm::dvec3(1.0)) ==
			doctest::Approx(4.0)); // The fade-out begins at this distance.
	sight = {2.0, 0.2};
	CHECK(near_distance(glm::dvec3(0.0), glm::dvec3(1.0)) ==
			doctest::Approx(3.0)); // The distance is the horizontal distance.
}

TEST_CASE("lod schedule: tiles in range on the map are visible from any height, and scales apply per viewer") {
	const Sight sight{100.0, 0.2};
	for (const double scale : {0.1, 0.5, 1.0, 3.0}) {
		for (const double height : {0.0, 60.0, 90.0, 300.0, 1e6}) {
			LodSchedule schedule;
			schedule.move(std::vector<Viewer>{{{0.0, 0.0}, scale, height}});
			for (const double offset_x : {0.0, 5.0, 40.0, 79.0, 99.0, 250.0, 299.0}) {
				const glm::dvec3 at(offset_x, 0.0, 0.0);
				const DistanceRange distance = schedule.distances_to(at, at, sight);
				const bool in_view = offset_x <= 100.0 * scale;
				INFO("scale ", scale, ", height ", height, ", across ", offset_x);
				CHECK((distance.sight <= 100.0) == in_view);
				if (offset_x <= 100.0 * (scale - 0.2)) {
					CHECK(distance.sight <= 80.0 + 1e-9); // The fade-out has not begun.
				}
			}
		}
	}
}

TEST_CASE("lod schedule: with LOD margins, no change is ever missed, and checks are few") {
	std::mt19937 random(12);
	std::uniform_real_distribution<double> turn(-0.3, 0.3);
	LodSettings settings;
	settings.lod_distances = {30.0, 80.0};
	settings.thin_begin = 50.0;
	settings.thin_end = 200.0;
	settings.thin_density = 0.1;
	struct DrawnTile {
		std::size_t lod = 0;
		double density = 1.0;
	};
	std::map<int, DrawnTile> tiles;
	LodSchedule schedule;
	std::vector<Viewer> viewers{{{0.0, 0.0}, 1.0, 2.0}};
	schedule.move(viewers);
	const auto box_min = [](int x) {
		return glm::dvec3(x * 32.0, 0.0, 0.0);
	};
	const auto distance = [&](int x) {
		return schedule.distances_to(box_min(x), box_min(x) + glm::dvec3(32.0, 10.0, 32.0), settings.sight()).near;
	};
	for (int x = -20; x < 20; ++x) {
		tiles[x] = {};
		schedule.add(key_of(x), 0.0);
	}
	std::uint64_t checks = 0;
	double heading = 0.0;
	for (int frame = 0; frame < 4000; ++frame) {
		heading += turn(random);
		viewers[0].position += 0.2 * glm::dvec2(std::cos(heading), std::sin(heading));
		schedule.move(viewers);
		while (const auto due_tile = schedule.next()) {
			const int x = due_tile->tile.x;
			DrawnTile &drawn = tiles[x];
			++checks;
			drawn.lod = lod_at(settings, distance(x), drawn.lod);
			drawn.density = thinned_density(settings, distance(x));
			schedule.add(*due_tile, distance_margin(settings, distance(x)));
		}
		for (const auto &[x, drawn] : tiles) {
			CHECK(drawn.lod == lod_at(settings, distance(x), drawn.lod));
			CHECK(drawn.density == thinned_density(settings, distance(x)));
		}
	}
	CHECK(checks > 100);
	CHECK(checks < 4000 * 40 / 4);
}

TEST_CASE("lod schedule: a viewer that jumps is a new viewer, and moved meters count as before") {
	LodSchedule schedule;
	std::vector<Viewer> viewers{{{0.0, 0.0}, 0.0, 2.0}};
	schedule.move(viewers);
	viewers[0].position.x = 9e5;
	CHECK_FALSE(schedule.move(viewers));
	for (const double coordinate : {1e20, -1e20, 2e7, 0.0}) {
		viewers[0].position.x = coordinate;
		CHECK(schedule.move(viewers));
	}
	schedule.add(key_of(0), 0.5);
	CHECK(schedule.settled());
	viewers[0].position.x = 0.6;
	CHECK_FALSE(schedule.move(viewers));
	CHECK(schedule.next().has_value());
}
