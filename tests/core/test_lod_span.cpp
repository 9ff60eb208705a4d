#include "core/drawing/lod_span.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

using namespace thicket;

namespace {

constexpr LodStep sharp{false, false};
constexpr LodStep soft{false, true};
constexpr LodStep repeated_step{true, true};

LodSettings settings_of(std::vector<double> distances, double fade, double sight_end = 0.0) {
	LodSettings settings;
	settings.lod_distances = std::move(distances);
	settings.fade = fade;
	settings.sight_end = sight_end;
	return settings;
}

/// Returns the fraction of an instance that a mesh draws: the faded-in fraction minus the faded-out
/// fraction, computed as in scatter_fade_shares.
double visible_fraction(const FadeRange &range, double distance) {
	if (range.z == 0.0F) {
		return 1.0;
	}
	const auto visible_part = [distance, &range](double end) {
		return std::clamp((distance - end) / std::max(end * range.z, 1e-4) + 1.0, 0.0, 1.0);
	};
	return visible_part(range.x) - visible_part(std::abs(range.y));
}

/// Returns the sum of the fractions of visible_fraction over all meshes that are drawn for a box
/// with this span.
double drawn_fraction(
		const LodSettings &settings, const std::vector<LodStep> &steps, const LodSpan &span, double distance) {
	double sum = 0.0;
	for (std::size_t from = span.first; from <= span.last;) {
		std::size_t to = from;
		while (to < span.last && steps[to + 1].same_mesh) {
			++to;
		}
		const LodEnd end = to < span.last ? LodEnd::next : span.fades_out ? LodEnd::sight : LodEnd::stays;
		sum += visible_fraction(fade_range(settings, from, to, from > span.first, end), distance);
		from = to + 1;
	}
	return sum;
}

} // namespace

TEST_CASE("lod span: without a fade, or with a mesh that cannot fade, a whole box changes as in lod_at") {
	const LodSettings without_fade = settings_of({20.0, 50.0, 51.0}, 0.0);
	const LodSettings with_fade = settings_of({20.0, 50.0, 51.0}, 0.2);
	LodSpan displayed[2];
	std::mt19937 random(3);
	for (int step = 0; step < 2000; ++step) {
		const double near_distance = 0.04 * static_cast<double>(random() % 2000);
		const std::size_t expected = lod_at(without_fade, near_distance, displayed[0].first);
		displayed[0] = lod_span(
				without_fade, std::vector<LodStep>(4, soft), {near_distance, near_distance + 30.0}, displayed[0]);
		displayed[1] = lod_span(
				with_fade, std::vector<LodStep>(4, sharp), {near_distance, near_distance + 30.0}, displayed[1]);
		for (const LodSpan &span : displayed) {
			CHECK(span == LodSpan{expected, expected, false});
		}
	}
	CHECK(span_margin(settings_of({}, 0.2, 90.0), std::vector<LodStep>(1, sharp), {0.0, 5.0}) > 1e300);
	CHECK(lod_span({}, std::vector<LodStep>(1, soft), {5.0, 1e5}, {}) == LodSpan{});
	CHECK(lod_span(with_fade, {}, {5.0, 1e5}, {}) == LodSpan{});
}

TEST_CASE("lod span: for every viewer position, each instance is drawn once, with and without a view limit") {
	const std::vector<std::vector<LodStep>> kinds{{soft, soft, soft, soft}, {soft, soft, repeated_step, soft},
			{soft, repeated_step, sharp, soft}, {sharp, soft, soft, repeated_step}, {soft, sharp, soft, soft}};
	std::mt19937 random(5);
	for (const std::vector<LodStep> &steps : kinds) {
		for (const double sight_end : {0.0, 90.0}) {
			const LodSettings settings = settings_of({20.0, 40.0, 60.0}, 0.2, sight_end);
			LodSpan span;
			double near_distance = 0.0;
			for (int step = 0; step < 3000; ++step) {
				near_distance =
						std::clamp(near_distance + 0.01 * (static_cast<double>(random() % 401) - 200.0), 0.0, 100.0);
				const double far_distance = near_distance + 1.0 + static_cast<double>(step % 40);
				span = lod_span(settings, steps, {near_distance, far_distance}, span);
				REQUIRE(span.first <= span.last);
				REQUIRE(span.last < steps.size());
				for (const double fraction : {0.0, 0.3, 0.7, 1.0}) {
					const double distance = near_distance + fraction * (far_distance - near_distance);
					const bool fades_out = sight_end > 0.0 && steps[span.last].fades;
					const double expected = fades_out ? std::clamp((90.0 - distance) / 18.0, 0.0, 1.0) : 1.0;
					CHECK(drawn_fraction(settings, steps, span, distance) == doctest::Approx(expected).epsilon(1e-4));
				}
			}
		}
	}
}

TEST_CASE("lod span: a mesh is drawn for every instance within its distances") {
	const LodSettings settings = settings_of({20.0, 40.0, 60.0}, 0.2);
	const std::vector<LodStep> steps(4, soft);
	for (double near_distance = 0.0; near_distance < 80.0; near_distance += 0.5) {
		const LodSpan span = lod_span(settings, steps, {near_distance, near_distance + 5.0}, {3, 3, false});
		for (std::size_t lod = 0; lod < 4; ++lod) {
			const double begin = lod > 0 ? 0.8 * settings.lod_distances[lod - 1] : 0.0;
			const double end = lod < 3 ? settings.lod_distances[lod] : 1e9;
			const bool needed = near_distance < end && near_distance + 5.0 > begin;
			CHECK((!needed || (lod >= span.first && lod <= span.last)));
		}
		CHECK(span.last - span.first <= 1);
	}
}

TEST_CASE("lod span: within the margin nothing changes, and moving back and forth causes no change") {
	const LodSettings settings = settings_of({20.0, 40.0}, 0.1, 80.0);
	const std::vector<LodStep> steps(3, soft);
	std::mt19937 random(7);
	for (int step = 0; step < 2000; ++step) {
		const double near_distance = 0.05 * static_cast<double>(random() % 2000);
		const DistanceRange distance{near_distance, near_distance + 8.0};
		const LodSpan displayed = lod_span(settings, steps, distance, {});
		const LodSpan settled = lod_span(settings, steps, distance, displayed);
		CHECK(settled == displayed);
		const double margin = 0.999 * span_margin(settings, steps, distance);
		for (const double offset : {-margin, margin}) {
			CHECK(lod_span(settings, steps, {near_distance + offset, near_distance + 8.0 + offset}, displayed) ==
					displayed);
		}
	}
	LodSpan displayed = lod_span(settings, steps, {20.1, 21.0}, {});
	int changes = 0;
	for (int step = 0; step < 40; ++step) {
		const double near_distance = step % 2 == 0 ? 20.45 : 20.95;
		const LodSpan next = lod_span(settings, steps, {near_distance, near_distance + 1.0}, displayed);
		changes += next == displayed ? 0 : 1;
		displayed = next;
	}
	CHECK(changes <= 1);
}
