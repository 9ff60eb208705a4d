// Tests the checks of the program bench/billion with handmade points, and with points of the
// sampler to which errors are added.

#include "tests/bench/billion/run.hpp"

#include "core/sampling/tile_sampler.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <random>
#include <set>
#include <utility>
#include <vector>

using namespace thicket;
using namespace thicket::bench::billion;

namespace {

constexpr std::int32_t unit_cell = static_cast<std::int32_t>(cell_size);

/// Returns the options for the smallest region: 64 cells on each axis, from -32 to 31.
RunOptions small_run(std::int32_t tile, TileOrder order = TileOrder::rows, unsigned threads = 1) {
	RunOptions options{.seed = 11, .points = 1e3, .tile = tile, .order = order, .threads = threads, .gaps = 1};
	REQUIRE(options.region().side == 64);
	return options;
}

SamplePoint point_at(glm::ivec2 lattice) {
	const glm::ivec2 cell(lattice.x >> lattice_bits, lattice.y >> lattice_bits);
	return {glm::dvec2(lattice) / static_cast<double>(cell_size), pack({0, cell}), 0, 0};
}

Outcome run_on(const RunOptions &options, const TileSource &source) {
	Run run(options, [&source] { return source; });
	return run.go([](std::uint64_t) {});
}

/// Runs all checks on handmade points except the check for gaps, because handmade sets have gaps.
Outcome check_by_hand(RunOptions options, const std::vector<glm::ivec2> &lattice) {
	options.gaps = 0;
	return run_on(options, [&lattice](const Rect &rect, std::vector<SamplePoint> &r_points) {
		r_points.clear();
		for (const glm::ivec2 position : lattice) {
			if (rect.contains(point_at(position).position)) {
				r_points.push_back(point_at(position));
			}
		}
		return Status{};
	});
}

/// A function that changes the sampler's points for a rectangle.
using TamperTile = std::function<void(const Rect &rect, std::vector<SamplePoint> &r_points)>;

Outcome run_tampered(const RunOptions &options, const TamperTile &tamper) {
	Run run(options, [&options, &tamper]() -> TileSource {
		auto sampler = std::make_shared<TileSampler>();
		return [sampler, &options, &tamper](const Rect &rect, std::vector<SamplePoint> &r_points) {
			const Status status = sampler->sample(options.set(), rect, r_points);
			tamper(rect, r_points);
			return status;
		};
	});
	return run.go([](std::uint64_t) {});
}

Outcome run_untampered(const RunOptions &options) {
	return run_tampered(options, [](const Rect &, std::vector<SamplePoint> &) {});
}

bool is_perfect(const Outcome &outcome) {
	return outcome.status.ok() && outcome.found.too_close == 0 && outcome.found.misplaced == 0 &&
			outcome.found.doubled == 0 && outcome.gaps.uncovered == 0 && outcome.gaps.changed == 0 &&
			outcome.tiles_repeated == 0;
}

/// A small run in which the point of the cell `taken` is tampered with.
struct TamperedRun {
	static constexpr std::int32_t tile = 16;

	using Points = std::vector<SamplePoint>;
	using Tamper = std::function<void(const Rect &rect, Points &r_points, Points::iterator found)>;

	RunOptions options = small_run(tile);
	Digest digest = run_untampered(options).found.digest;
	/// Cells in the middle row of a tile: one with a point and one without.
	glm::ivec2 taken_cell{0}, open{0};

	TamperedRun() {
		Points points;
		TileSampler sampler;
		REQUIRE(sampler.sample(options.set(), {{0.0, 0.0}, {tile, tile}}, points).ok());
		for (glm::ivec2 cell(0, tile / 2); cell.x < tile; ++cell.x) {
			(find(points, cell) != points.end() ? taken_cell : open) = cell;
		}
	}

	static Points::iterator find(Points &r_points, glm::ivec2 cell) {
		return std::find_if(r_points.begin(), r_points.end(),
				[cell](const SamplePoint &point) { return unpack(point.id).cell == cell; });
	}

	/// Calls `tamper` for every list that contains the point.
	Outcome run(const Tamper &tamper) const {
		const Outcome outcome = run_tampered(options, [&](const Rect &rect, Points &r_points) {
			if (const auto found = find(r_points, taken_cell); found != r_points.end()) {
				tamper(rect, r_points, found);
			}
		});
		CHECK(outcome.found.digest != digest);
		return outcome;
	}
};

const std::vector<TileOrder> all_orders{TileOrder::rows, TileOrder::shuffled, TileOrder::hilbert};

} // namespace

TEST_CASE("billion: every order visits every tile once") {
	for (const TileOrder order : all_orders) {
		for (const std::int32_t side : {16, 48, 64, 80, 1616}) {
			const Region region{side, 16};
			const TileSequence sequence(region, order, 77);
			std::set<std::uint64_t> seen;
			std::uint64_t visits = 0;
			for (std::uint64_t slot = 0; slot < sequence.slots(); ++slot) {
				if (const auto position = sequence.at(slot)) {
					REQUIRE(region.has_tile(*position));
					seen.insert(region.index_of(*position));
					++visits;
				}
			}
			CHECK(visits == region.tiles());
			CHECK(seen.size() == region.tiles());
		}
	}
}

TEST_CASE("billion: a pair that is too close is detected inside a tile, across its borders and its corners") {
	// Four tiles share a corner at the origin of the cell (0, 0).
	const std::pair<glm::ivec2, glm::ivec2> pairs[] = {
			{{5 * unit_cell, 5 * unit_cell}, {5 * unit_cell + 23170, 5 * unit_cell}},
			{{-1, 5 * unit_cell}, {23169, 5 * unit_cell}},
			{{-23170, -3 * unit_cell}, {0, -3 * unit_cell}},
			{{5 * unit_cell, -1}, {5 * unit_cell, 23169}},
			{{-3 * unit_cell, -23170}, {-3 * unit_cell, 0}},
			{{-1, -1}, {unit_cell - 1, unit_cell - 2}},
			{{-unit_cell, -unit_cell}, {0, -1}},
			{{-unit_cell, unit_cell - 1}, {0, 0}},
			{{-1, 0}, {unit_cell - 1, 1 - unit_cell}},
			{{-unit_cell + 1, -unit_cell}, {0, 0}},
	};
	for (const TileOrder order : all_orders) {
		for (const std::pair<glm::ivec2, glm::ivec2> &pair : pairs) {
			const glm::ivec2 a = pair.first;
			const glm::ivec2 b = pair.second;
			CAPTURE(a.x);
			CAPTURE(a.y);
			const Outcome close = check_by_hand(small_run(16, order), {a, b});
			CHECK(close.found.points == 2);
			CHECK(close.found.pairs == 1);
			CHECK(close.found.too_close == 1);
			CHECK(close.found.min_squared_distance < std::int64_t{radius_squared});

			const glm::ivec2 direction = glm::sign(b - a) * 2; // The second point is at the radius or just beyond it.
			const Outcome separated = check_by_hand(small_run(16, order), {a, b + direction});
			CHECK(separated.found.too_close == 0);
			CHECK(separated.found.min_squared_distance >= std::int64_t{radius_squared});
		}
	}
	CHECK(check_by_hand(small_run(16), {{-1, -1}, {unit_cell - 1, unit_cell - 1}}).found.too_close == 0);
}

TEST_CASE("billion: all pair distances match brute force, for any tiles, order and threads") {
	std::mt19937 random(3);
	std::vector<glm::ivec2> points;
	for (std::int32_t cell = 0; cell < 64 * 64; ++cell) {
		if (random() % 4 == 0) {
			const glm::ivec2 inside(random() % cell_size, random() % cell_size);
			points.push_back((glm::ivec2(cell % 64, cell / 64) - 32) * unit_cell + inside);
		}
	}
	Findings expected;
	for (std::size_t i = 0; i < points.size(); ++i) {
		for (std::size_t j = 0; j < i; ++j) {
			const glm::i64vec2 offset(points[i] - points[j]);
			const std::int64_t squared = offset.x * offset.x + offset.y * offset.y;
			const glm::ivec2 cells = glm::abs((points[i] >> lattice_bits) - (points[j] >> lattice_bits));
			expected.pairs += cells.x <= 2 && cells.y <= 2 ? 1 : 0;
			expected.too_close += squared < std::int64_t{radius_squared} ? 1 : 0;
			expected.min_squared_distance = std::min(expected.min_squared_distance, squared);
		}
	}
	REQUIRE(expected.too_close > 100);
	for (const TileOrder order : all_orders) {
		for (const std::int32_t tile : {16, 17, 21, 31, 40, 64}) {
			for (const unsigned threads : {1u, 3u}) {
				const Outcome outcome = check_by_hand(small_run(tile, order, threads), points);
				CHECK(outcome.found.points == points.size());
				CHECK(outcome.found.pairs == expected.pairs);
				CHECK(outcome.found.too_close == expected.too_close);
				CHECK(outcome.found.min_squared_distance == expected.min_squared_distance);
				CHECK(outcome.tiles_finished == small_run(tile).region().tiles());
			}
		}
	}
}

TEST_CASE("billion: the sampler's set passes, with the same digest for any tiles, order and threads") {
	const Outcome first = run_untampered(small_run(16));
	CHECK(is_perfect(first));
	CHECK(first.gaps.tiles == 16);
	CHECK(first.found.points >= 1000);
	for (const TileOrder order : all_orders) {
		for (const std::int32_t tile : {19, 64}) {
			const Outcome other = run_untampered(small_run(tile, order, 2));
			CHECK(is_perfect(other));
			CHECK(other.found.digest == first.found.digest);
			CHECK(other.found.pairs == first.found.pairs);
			CHECK(other.coverage == first.coverage);
			CHECK(other.coverage_error == first.coverage_error);
		}
	}
	RunOptions another = small_run(16);
	another.seed = 12;
	CHECK(run_untampered(another).found.digest != first.found.digest);
}

TEST_CASE("billion: missing and added points are detected") {
	const TamperedRun tampered;
	const Outcome missing = tampered.run([](const Rect &, auto &r_points, auto found) { r_points.erase(found); });
	CHECK(missing.gaps.uncovered > 0);
	CHECK(missing.gaps.changed == 0);

	const Outcome missing_in_tile = tampered.run([](const Rect &rect, auto &r_points, auto found) {
		if (rect.size().x == TamperedRun::tile) {
			r_points.erase(found);
		}
	});
	CHECK(missing_in_tile.gaps.uncovered > 0);
	CHECK(missing_in_tile.gaps.changed == 1);

	const Outcome close_pair = tampered.run(
			[&](const Rect &, auto &r_points, auto) { r_points.push_back(point_at(tampered.open * unit_cell)); });
	CHECK(close_pair.found.too_close > 0);
}

TEST_CASE("billion: repeated, moved and renamed points are detected") {
	const TamperedRun tampered;
	const Outcome repeated_point =
			tampered.run([](const Rect &, auto &r_points, auto found) { r_points.push_back(*found); });
	CHECK(repeated_point.found.doubled == 1);

	const Outcome off_lattice =
			tampered.run([](const Rect &, auto &, auto found) { found->position.x += 1.0 / (4 * unit_cell); });
	CHECK(off_lattice.found.misplaced == 1);

	const Outcome renamed =
			tampered.run([&](const Rect &, auto &, auto found) { found->id = pack({0, tampered.open}); });
	CHECK(renamed.found.misplaced == 1);

	const Outcome ranked = tampered.run([](const Rect &, auto &, auto found) { found->rank ^= 1; });
	CHECK(is_perfect(ranked)); // `run` has checked that the digest differs.
}

TEST_CASE("billion: dropped, repeated and swapped tiles are detected") {
	const RunOptions options = small_run(16);
	const Outcome untampered = run_untampered(options);
	const Rect chosen{{0.0, 0.0}, {16.0, 16.0}};

	const Outcome dropped = run_tampered(options, [&](const Rect &rect, std::vector<SamplePoint> &r_points) {
		if (rect.min == chosen.min) {
			r_points.clear();
		}
	});
	CHECK(dropped.found.digest != untampered.found.digest);
	CHECK(dropped.gaps.uncovered > 0);

	TileSampler sampler;
	const Outcome exchanged = run_tampered(options, [&](const Rect &rect, std::vector<SamplePoint> &r_points) {
		if (rect.min == chosen.min && rect.max == chosen.max) {
			REQUIRE(sampler.sample(options.set(), {{-16.0, 0.0}, {0.0, 16.0}}, r_points).ok());
		}
	});
	CHECK(exchanged.found.digest != untampered.found.digest);
	CHECK(exchanged.found.misplaced > 0);

	Seams seams(options.region());
	CHECK(seams.finish({1, 1}, {{0, 0}}).empty());
	CHECK(seams.finish({2, 2}, {}).size() == 1);
	CHECK(seams.finish({1, 1}, {{0, 0}}).empty());
	CHECK(seams.finish({2, 1}, {}).size() == 2);
	CHECK(seams.repeated() == 1);
	CHECK(seams.finished() == 3);
}

TEST_CASE("billion: rims are freed as soon as all neighbors are complete") {
	const Region region{1600, 16};
	for (const TileOrder order : all_orders) {
		Seams seams(region);
		const TileSequence sequence(region, order, 5);
		std::size_t pairs = 0;
		for (std::uint64_t slot = 0; slot < sequence.slots(); ++slot) {
			if (const auto position = sequence.at(slot)) {
				pairs += seams.finish(*position, {{0, 0}}).size();
			}
		}
		CHECK(pairs == 2 * 100 * 99 + 2 * 99 * 99);
		CHECK(seams.max_kept() < 7 * 100); // At most a few rows of the 10,000 tiles.
	}
}

TEST_CASE("billion: an error of the sampler ends the run") {
	const Outcome outcome = run_on(small_run(16, TileOrder::rows, 2),
			[](const Rect &, std::vector<SamplePoint> &) { return Status{ErrorCode::out_of_range, "rect", 1.0}; });
	CHECK(outcome.status.code == ErrorCode::out_of_range);
	CHECK(outcome.tiles_finished == 0);
}
