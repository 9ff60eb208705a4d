// Tests the detection of ground changes that emit no signal: which heights are read and when, and
// which changes are found.

#include "core/streaming/ground_recheck.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

constexpr float no_height = std::numeric_limits<float>::quiet_NaN();
constexpr double tolerance = 0.01;
constexpr double tile_size = 10.0;

using Height = std::function<std::optional<float>(glm::dvec2)>;

/// A row of tiles along x, generated on flat ground of height 0. Each tile has a row of probes.
class Row {
public:
	explicit Row(int tiles, int probes = 4, std::uint32_t layer = 0) { add(tiles, probes, layer); }

	void add(int tiles, int probes, std::uint32_t layer) {
		for (int x = 0; x < tiles; ++x) {
			show({layer, 0, {x, 0}}, probes, 0.0F);
		}
	}

	void show(const TileKey &key, int probes, float height, bool outdated = false) {
		std::vector<GroundProbe> recorded_probes;
		const double left_edge = tile_size * key.tile.x;
		for (int i = 0; i < probes; ++i) {
			recorded_probes.push_back({{left_edge + (i + 0.5) * tile_size / probes, 5.0}, height});
		}
		recheck.show(key, {{left_edge, 0.0}, {left_edge + tile_size, tile_size}}, recorded_probes, outdated);
	}

	/// Simulates a frame in which up to 16 heights are read.
	void frame(const Height &height) {
		time += 1.0 / 60.0;
		std::vector<glm::dvec2> positions;
		recheck.next(time, 16, positions);
		max_per_call = std::max(max_per_call, positions.size());
		std::vector<std::optional<float>> heights;
		for (const glm::dvec2 position : positions) {
			++reads[position.x];
			heights.push_back(height(position));
		}
		recheck.answer(time, heights, tolerance);
		for (const glm::dvec2 change : recheck.take_changes(time)) {
			changes.push_back(change.x);
		}
	}

	void frames(int count, const Height &height) {
		for (int i = 0; i < count; ++i) {
			frame(height);
		}
	}

	GroundRecheck recheck;
	double time = 100.0;
	std::size_t max_per_call = 0;
	std::map<double, int> reads; ///< The number of reads at each x.
	std::vector<double> changes; ///< The x of each found change.
};

std::optional<float> flat(glm::dvec2) { return 0.0F; }

} // namespace

TEST_CASE("ground recheck: all heights of all tiles are read in turn, a few per frame, equally often") {
	Row row(40);
	row.frames(600, flat);
	CHECK(row.max_per_call == 16);
	REQUIRE(row.reads.size() == 160);
	const auto [least, most] = std::ranges::minmax_element(row.reads, {}, &std::pair<const double, int>::second);
	CHECK(least->second >= 10);
	CHECK(most->second - least->second <= 2);
	CHECK(row.changes.empty());
}

TEST_CASE("ground recheck: a single tile is read no more often than each of many tiles") {
	Row row(1);
	row.frames(600, flat); // 10 s, which is enough for 40 visits that read two heights each.
	int reads = 0;
	for (const auto &[x, count] : row.reads) {
		reads += count;
	}
	CHECK(reads <= 82);
	CHECK(reads >= 70);
}

TEST_CASE("ground recheck: a change is found once, and only in the tiles that it affects") {
	Row row(20);
	const Height raised = [](glm::dvec2 at) {
		return at.x > 50.0 && at.x < 70.0 ? 3.0F : 0.0F;
	};
	row.frames(300, raised);
	REQUIRE(row.changes.size() == 2);
	CHECK(std::floor(row.changes[0] / tile_size) == 5.0);
	CHECK(std::floor(row.changes[1] / tile_size) == 6.0);
	row.show({0, 0, {5, 0}}, 4, 3.0F);
	row.show({0, 0, {6, 0}}, 4, 3.0F);
	row.frames(300, raised);
	CHECK(row.changes.size() == 2);
}

TEST_CASE("ground recheck: a change under a single probe is found eventually") {
	Row row(3, 64);
	row.frames(1200, [](glm::dvec2 at) { return std::abs(at.x - 19.0) < 0.1 ? 1.0F : 0.0F; });
	REQUIRE(row.changes.size() == 1);
	CHECK(row.changes[0] == doctest::Approx(19.0).epsilon(0.01));
}

TEST_CASE("ground recheck: ground that appears or disappears is a change; small and unknown changes are not") {
	Row row(3);
	row.show({0, 0, {1, 0}}, 4, no_height);
	row.frames(200, [](glm::dvec2 at) { return at.x > 10.0 && at.x < 20.0 ? no_height : 0.009F; });
	row.frames(200, [](glm::dvec2) { return std::nullopt; });
	CHECK(row.changes.empty());
	row.frames(100, [](glm::dvec2 at) { return at.x > 10.0 ? 0.0F : no_height; });
	std::ranges::sort(row.changes);
	REQUIRE(row.changes.size() == 2);
	CHECK(row.changes[0] < 10.0);
	CHECK(row.changes[1] > 10.0);
	CHECK(row.changes[1] < 20.0);
}

TEST_CASE("ground recheck: tiles that will be regenerated are not read until then") {
	Row row(3);
	row.recheck.suspend(0, {{12.0, 0.0}, {13.0, 1.0}});
	row.show({0, 0, {2, 0}}, 4, 0.0F, true);
	row.frames(100, flat);
	CHECK(row.reads.rbegin()->first < 10.0);
	row.recheck.keep({0, 0, {1, 0}});
	row.frames(100, flat);
	CHECK(row.reads.rbegin()->first < 20.0);
	CHECK(row.reads.rbegin()->first > 10.0);
	row.recheck.hide({0, 0, {0, 0}});
	row.reads.clear();
	row.frames(100, flat);
	CHECK(row.reads.begin()->first > 10.0);
	CHECK(row.recheck.size() == 2);
}

TEST_CASE("ground recheck: heights read for a tile before it was regenerated are ignored") {
	Row row(1);
	std::vector<glm::dvec2> positions;
	row.recheck.next(row.time, 16, positions);
	REQUIRE(positions.size() == 2);
	row.show({0, 0, {0, 0}}, 1, 7.0F);
	row.recheck.answer(row.time, std::vector<std::optional<float>>{3.0F, 3.0F}, tolerance);
	CHECK_FALSE(row.recheck.has_changes());
	row.frames(100, [](glm::dvec2) { return 7.0F; });
	CHECK(row.changes.empty());
}

TEST_CASE("ground recheck: changes are collected for a short time, unless there are many") {
	const Height raised = [](glm::dvec2) {
		return 1.0F;
	};
	Row row(2);
	row.frame(raised);
	CHECK(row.changes.empty());
	CHECK(row.recheck.has_changes());
	row.frames(16, raised);
	CHECK(row.changes.size() == 2);
	CHECK_FALSE(row.recheck.has_changes());
	Row many(100);
	many.frames(5, raised);
	CHECK(many.changes.size() >= 32);
}

TEST_CASE("ground recheck: only changes in tiles that are regenerated anyway are dropped") {
	for (const std::uint32_t is_suspended : {0U, 1U}) {
		Row row(1);
		row.frame([](glm::dvec2) { return 1.0F; });
		REQUIRE(row.recheck.has_changes());
		row.recheck.suspend(is_suspended, {{0.0, 0.0}, {10.0, 10.0}});
		CHECK(row.recheck.has_changes() == (is_suspended == 1));
	}
}

TEST_CASE("ground recheck: constantly moving ground regenerates a tile less and less often") {
	Row row(1);
	float height = 0.0F;
	const auto regenerated_in = [&](int seconds, bool moves) {
		const std::size_t before = row.changes.size();
		for (int i = 0; i < 60 * seconds; ++i) {
			height += moves ? 1.0F : 0.0F;
			const std::size_t changes = row.changes.size();
			row.frame([&](glm::dvec2) { return height; });
			if (row.changes.size() > changes) {
				row.show({0, 0, {0, 0}}, 4, height);
			}
		}
		return row.changes.size() - before;
	};
	CHECK(regenerated_in(60, true) <= 13);
	CHECK(regenerated_in(60, false) <= 1);
	height += 1.0F;
	CHECK(regenerated_in(1, false) == 1);
}

TEST_CASE("ground recheck: a tile stores some of the heights that it was built with, spread over the tile") {
	const Rect rect{{-20.0, 10.0}, {44.0, 74.0}};
	TileBuilder builder;
	TileInstances tile;
	const Heightfield ground = hills();
	REQUIRE(builder.build(rich_layer(), ground, rect, tile).ok());
	REQUIRE(builder.probes().size() == max_ground_probes);
	std::map<std::pair<bool, bool>, int> of_first_16;
	for (std::size_t i = 0; i < builder.probes().size(); ++i) {
		const GroundProbe &probe = builder.probes()[i];
		CHECK(rect.contains(probe.position));
		CHECK(probe.height == ground.at(probe.position).height);
		of_first_16[{probe.position.x < rect.center().x, probe.position.y < rect.center().y}] += i < 16 ? 1 : 0;
	}
	for (const auto &[quarter, count] : of_first_16) {
		CHECK(count >= 2);
	}
	CHECK(of_first_16.size() == 4);
	LayerSettings closed = rich_layer();
	closed.rules.density = 0.0;
	REQUIRE(builder.build(closed, ground, rect, tile).ok());
	CHECK(builder.probes().empty());
}
