#include "core/drawing/lod_runs.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <set>
#include <vector>

using namespace thicket;

namespace {

constexpr LodStep sharp{false, false};
constexpr LodStep soft{false, true};
constexpr LodStep repeated_step{true, true};

LodSettings settings_of(std::vector<double> distances, double fade = 0.1, double sight_end = 0.0) {
	LodSettings settings;
	settings.lod_distances = std::move(distances);
	settings.fade = fade;
	settings.sight_end = sight_end;
	return settings;
}

} // namespace

TEST_CASE("lod runs: consecutive LODs that are drawn alike share one run") {
	const LodRuns runs(settings_of({10.0, 20.0, 30.0, 40.0}),
			std::vector{soft, repeated_step, soft, repeated_step, repeated_step});
	CHECK(runs.count() == 2);
	CHECK(runs.steps().size() == 5);
	CHECK(runs.run_of(0) == 0);
	CHECK(runs.run_of(1) == 0);
	CHECK(runs.run_of(2) == 1);
	CHECK(runs.run_of(9) == 1); // A tile may still display an LOD that its layer no longer has.
	CHECK(runs.extra_run_count({0, 1, false}) == 0);
	CHECK(runs.extra_run_count({1, 3, false}) == 1);
	CHECK(LodRuns().count() == 0);
}

TEST_CASE("lod runs: in a span, each run fades into the next one, and the last may fade out at the view distance") {
	const LodRuns runs(settings_of({10.0, 20.0}, 0.1, 50.0), std::vector{soft, soft, soft});
	const auto fade_of = [&](LodSpan span, std::size_t index) {
		const LodRuns::DrawnRun drawn = runs.drawn_run(span, index);
		CHECK(drawn.run == span.first + index);
		return drawn.fade;
	};
	CHECK_FALSE(fade_of({1, 1, false}, 0)); // The span has one run and is far from any change.
	CHECK(fade_of({0, 1, false}, 0) == RunFade{false, LodEnd::next});
	CHECK(fade_of({0, 1, false}, 1) == RunFade{true, LodEnd::stays});
	CHECK(fade_of({0, 2, true}, 1) == RunFade{true, LodEnd::next});
	CHECK(fade_of({0, 2, true}, 2) == RunFade{true, LodEnd::sight});
	CHECK(fade_of({2, 2, true}, 0) == RunFade{false, LodEnd::sight});
}

TEST_CASE("lod runs: a run that is drawn alone fades only at the view distance, so nothing is missing before it") {
	const LodRuns runs(settings_of({10.0, 20.0}, 0.1, 50.0), std::vector{soft, sharp, soft});
	CHECK(runs.single_run({0, 1, false}, 0).run == 0);
	CHECK_FALSE(runs.single_run({0, 1, false}, 0).fade);
	CHECK(runs.single_run({1, 2, true}, 2).fade == RunFade{false, LodEnd::sight});
	CHECK_FALSE(runs.single_run({1, 1, true}, 1).fade); // The materials of this run cannot fade.
	CHECK(runs.single_run({2, 2, false}, 7).run == 2);
}

TEST_CASE("lod runs: a run that cannot fade never does") {
	const LodRuns runs(settings_of({10.0}, 0.1, 50.0), std::vector{sharp, sharp});
	CHECK_FALSE(runs.fades());
	CHECK_FALSE(runs.drawn_run({0, 1, true}, 0).fade);
	CHECK_FALSE(runs.drawn_run({0, 1, true}, 1).fade);
	CHECK(LodRuns(settings_of({10.0}), std::vector{sharp, soft}).fades());
	CHECK_FALSE(LodRuns(settings_of({10.0}, 0.0), std::vector{soft, soft}).fades());
}

TEST_CASE("lod runs: exactly the fades that a span may need have a range") {
	for (const double sight_end : {0.0, 50.0}) {
		const LodRuns runs(
				settings_of({10.0, 20.0, 30.0}, 0.1, sight_end), std::vector{soft, soft, repeated_step, soft});
		for (std::size_t run = 0; run < runs.count(); ++run) {
			const auto ranges = runs.ranges(run);
			std::set<std::size_t> needed;
			for (std::size_t first = 0; first < 4; ++first) {
				for (std::size_t last = first; last < 4; ++last) {
					for (std::size_t index = 0; index <= runs.extra_run_count({first, last, false}); ++index) {
						for (const bool has_end : {false, sight_end > 0.0}) {
							const LodRuns::DrawnRun drawn = runs.drawn_run({first, last, has_end}, index);
							if (drawn.run == run && drawn.fade) {
								needed.insert(drawn.fade->index());
							}
						}
					}
				}
			}
			for (std::size_t index = 0; index < ranges.size(); ++index) {
				CHECK((ranges[index] != no_fade) == needed.contains(index));
			}
		}
		CHECK(runs.ranges(1)[RunFade{true, LodEnd::next}.index()] ==
				fade_range(settings_of({10.0, 20.0, 30.0}, 0.1, sight_end), 1, 2, true, LodEnd::next));
	}
}
