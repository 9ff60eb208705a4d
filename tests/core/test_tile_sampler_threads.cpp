// Tests that threads which the caller lends to a call share a large rectangle. Points, order,
// errors and progress must be the same as without them.

#include "allocation_count.hpp"
#include "core/sampling/tile_sampler.hpp"
#include "counted_threads.hpp"
#include "short_of_memory.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

using namespace thicket;

namespace {

using Threads = test::CountedThreads;

/// Simulates two threads on the calling thread. Their work runs before the caller's part, after it,
/// or never.
class SimulatedThreads final : public CallerThreads {
public:
	enum class Others { first, last, never };

	explicit SimulatedThreads(Others others) : others_(others) {}

	std::size_t count() const override { return 2; }

	void run(const std::function<void(std::size_t)> &work) override {
		if (others_ == Others::first) {
			work(2);
			work(1);
		}
		work(0);
		if (others_ == Others::last) {
			work(1);
			work(2);
		}
	}

private:
	Others others_;
};

constexpr Rect wide{{-500.0, 1000.0}, {400.0, 1900.0}}; ///< The rectangle contains 100 blocks.

struct SampledAlone {
	explicit SampledAlone(const PointSet &set) { REQUIRE(sampler.sample(set, wide, points).ok()); }

	TileSampler sampler;
	std::vector<SamplePoint> points;
};

} // namespace

TEST_CASE("sampler: lent threads change no point and no order") {
	for (const std::uint32_t levels : {1u, 4u}) {
		CAPTURE(levels);
		const PointSet set{.seed = 12, .radius = 1.0, .levels = levels};
		const SampledAlone alone(set);
		TileSampler sampler;
		std::vector<SamplePoint> points;
		for (const std::size_t count : {1, 3, 8}) {
			CAPTURE(count);
			Threads threads(count);
			REQUIRE(sampler.sample(set, wide, points, {}, &threads).ok());
			CHECK(threads.runs > 0);
			CHECK(points == alone.points);
			CHECK(sampler.stats().kept == points.size());
			CHECK(sampler.stats().cells == alone.sampler.stats().cells);
		}
		for (const auto others :
				{SimulatedThreads::Others::first, SimulatedThreads::Others::last, SimulatedThreads::Others::never}) {
			SimulatedThreads threads(others);
			REQUIRE(sampler.sample(set, wide, points, {}, &threads).ok());
			CHECK(points == alone.points);
		}
	}
}

TEST_CASE("sampler: a rectangle of a single block uses no lent threads") {
	Threads threads(2);
	TileSampler sampler;
	std::vector<SamplePoint> points;
	REQUIRE(sampler.sample({.seed = 1}, {{0.0, 0.0}, {80.0, 80.0}}, points, {}, &threads).ok());
	CHECK(threads.runs == 0);
}

TEST_CASE("sampler: with threads, the calling one receives the progress of all, and can cancel") {
	TileSampler sampler;
	std::vector<SamplePoint> points;
	Threads threads(3);
	double last = 0.0;
	std::uint64_t point_count = 0;
	const std::thread::id caller = std::this_thread::get_id();
	const auto watch = [&](double fraction, std::uint64_t new_count) {
		CHECK(std::this_thread::get_id() == caller);
		CHECK(fraction > last);
		CHECK(new_count >= point_count);
		last = fraction;
		point_count = new_count;
	};
	REQUIRE(sampler.sample({.seed = 1}, wide, points, {.cancel = nullptr, .report = watch}, &threads).ok());
	CHECK(last == 1.0);
	CHECK(point_count == points.size());
	std::atomic<bool> cancel = false;
	const auto stop = [&](double fraction, std::uint64_t) {
		cancel = fraction > 0.3;
	};
	CHECK(sampler.sample({.seed = 1}, wide, points, {.cancel = &cancel, .report = stop}, &threads).code ==
			ErrorCode::cancelled);
	REQUIRE(sampler.sample({.seed = 12}, wide, points, {}, &threads).ok());
	CHECK(points == SampledAlone({.seed = 12}).points);
}

TEST_CASE("sampler: with threads, the error names the first block that cannot be decided") {
	constexpr SampleMargins no_margins{.first = 0, .widest = 0};
	TileSampler alone(no_margins), together(no_margins);
	std::vector<SamplePoint> points(7);
	const Status expected = alone.sample({.seed = 3}, wide, points);
	Threads threads(3);
	points.resize(7);
	const Status status = together.sample({.seed = 3}, wide, points, {}, &threads);
	CHECK(status.code == ErrorCode::margin_too_wide);
	CHECK(status.site.position == expected.site.position);
	CHECK(points.empty());
}

TEST_CASE("sampler: with threads, memory may run out anywhere") {
	// All work runs on one thread, so that every allocation is counted.
	const Rect rect{{0.0, 0.0}, {200.0, 100.0}};
	const PointSet set{.seed = 4};
	std::vector<SamplePoint> expected;
	REQUIRE(TileSampler().sample(set, rect, expected).ok());
	struct Prepared {
		TileSampler sampler;
		std::vector<SamplePoint> points{7};
	};
	for (const auto others : {SimulatedThreads::Others::first, SimulatedThreads::Others::last}) {
		test::fail_every_request(
				"rect", [] { return Prepared(); },
				[&](Prepared &prepared) {
					SimulatedThreads threads(others);
					return prepared.sampler.sample(set, rect, prepared.points, {}, &threads);
				},
				[](const Prepared &prepared) { CHECK(prepared.points.empty()); },
				[&](const Prepared &prepared) { CHECK(prepared.points == expected); });
	}
}

TEST_CASE("sampler: lent threads take blocks, and their workspaces are kept for the next call") {
	const PointSet set{.seed = 12, .radius = 1.0};
	SimulatedThreads threads(SimulatedThreads::Others::first);
	TileSampler sampler;
	std::vector<SamplePoint> points;
	int reports = 0;
	const auto allocations = [&] {
		reports = 0;
		const std::size_t before = allocation_count();
		REQUIRE(sampler.sample(set, wide, points,
							   {.cancel = nullptr, .report = [&](double, std::uint64_t) { ++reports; }}, &threads)
						.ok());
		return allocation_count() - before;
	};
	const std::size_t first = allocations();
	// One report for each of three rounds. Blocks that the caller samples would be reported one by
	// one.
	CHECK(reports == 3);
	const std::size_t second = allocations();
	CHECK(second + 50 < first); // The first call also allocates the grids of two more samplers.
}
