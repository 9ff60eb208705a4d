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
constexpr LodStep again{true, true};

LodSettings settings_of(std::vector<double> distances, double fade, double sight_end = 0.0) {
	LodSettings settings;
	settings.lod_distances = std::move(distances);
	settings.fade = fade;
	settings.sight_end = sight_end;
	return settings;
}

/// Returns the fraction of an instance that a mesh draws: the faded-in fraction minus the faded-out
/// fraction, computed as in scatter_fade_shares.
double visible_fraction(const FadeRange &range, double away) {
	if (range.z == 0.0F) {
		return 1.0;
	}
	const auto part = [away, &range](double end) {
		return std::clamp((away - end) / std::max(end * range.z, 1e-4) + 1.0, 0.0, 1.0);
	};
	return part(range.x) - part(std::abs(range.y));
}

/// Returns the sum of the fractions of visible_fraction over all meshes that are drawn for a box
/// with this span.
double drawn_fraction(
		const LodSettings &settings, const std::vector<LodStep> &steps, const LodSpan &span, double away) {
	double sum = 0.0;
	for (std::size_t from = span.first; from <= span.last;) {
		std::size_t to = from;
		while (to < span.last && steps[to + 1].same_mesh) {
			++to;
		}
		const LodEnd end = to < span.last ? LodEnd::next : span.fades_out ? LodEnd::sight : LodEnd::stays;
		sum += visible_fraction(fade_range(settings, from, to, from > span.first, end), away);
		from = to + 1;
	}
	return sum;
}

} // namespace

TEST_CASE("lod span: without a fade, or with a mesh that cannot fade, a whole box changes as in lod_at") {
	const LodSettings none = settings_of({20.0, 50.0, 51.0}, 0.0);
	const LodSettings some = settings_of({20.0, 50.0, 51.0}, 0.2);
	LodSpan displayed[2];
	std::mt19937 random(3);
	for (int step = 0; step < 2000; ++step) {
		const double near = 0.04 * static_cast<double>(random() % 2000);
		const std::size_t expected = lod_at(none, near, displayed[0].first);
		displayed[0] = lod_span(none, std::vector<LodStep>(4, soft), {near, near + 30.0}, displayed[0]);
		displayed[1] = lod_span(some, std::vector<LodStep>(4, sharp), {near, near + 30.0}, displayed[1]);
		for (const LodSpan &span : displayed) {
			CHECK(span == LodSpan{expected, expected, false});
		}
	}
	CHECK(span_margin(settings_of({}, 0.2, 90.0), std::vector<LodStep>(1, sharp), {0.0, 5.0}) > 1e300);
	CHECK(lod_span({}, std::vector<LodStep>(1, soft), {5.0, 1e5}, {}) == LodSpan{});
	CHECK(lod_span(some, {}, {5.0, 1e5}, {}) == LodSpan{});
}

TEST_CASE("lod span: for every viewer position, each instance is drawn once, with and without a view limit") {
	const std::vector<std::vector<LodStep>> kinds{{soft, soft, soft, soft}, {soft, soft, again, soft},
			{soft, again, sharp, soft}, {sharp, soft, soft, again}, {soft, sharp, soft, soft}};
	std::mt19937 random(5);
	for (const std::vector<LodStep> &steps : kinds) {
		for (const double sight_end : {0.0, 90.0}) {
			const LodSettings settings = settings_of({20.0, 40.0, 60.0}, 0.2, sight_end);
			LodSpan displayed;
			double near = 0.0;
			for (int step = 0; step < 3000; ++step) {
				near = std::clamp(near + 0.01 * (static_cast<double>(random() % 401) - 200.0), 0.0, 100.0);
				const double far = near + 1.0 + static_cast<double>(step % 40);
				displayed = lod_span(settings, steps, {near, far}, displayed);
				REQUIRE(displayed.first <= displayed.last);
				REQUIRE(displayed.last < steps.size());
				for (const double along : {0.0, 0.3, 0.7, 1.0}) {
					const double away = near + along * (far - near);
					const bool fades_out = sight_end > 0.0 && steps[displayed.last].fades;
					const double expected = fades_out ? std::clamp((90.0 - away) / 18.0, 0.0, 1.0) : 1.0;
					CHECK(drawn_fraction(settings, steps, displayed, away) == doctest::Approx(expected).epsilon(1e-4));
				}
			}
		}
	}
}

TEST_CASE("lod span: a mesh is drawn for every instance within its distances") {
	const LodSettings settings = settings_of({20.0, 40.0, 60.0}, 0.2);
	const std::vector<LodStep> steps(4, soft);
	for (double near = 0.0; near < 80.0; near += 0.5) {
		const LodSpan span = lod_span(settings, steps, {near, near + 5.0}, {3, 3, false});
		for (std::size_t lod = 0; lod < 4; ++lod) {
			const double begin = lod > 0 ? 0.8 * settings.lod_distances[lod - 1] : 0.0;
			const double end = lod < 3 ? settings.lod_distances[lod] : 1e9;
			const bool needed = near < end && near + 5.0 > begin;
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
		const double near = 0.05 * static_cast<double>(random() % 2000);
		const DistanceRange distance{near, near + 8.0};
		const LodSpan displayed = lod_span(settings, steps, distance, {});
		const LodSpan settled = lod_span(settings, steps, distance, displayed);
		CHECK(settled == displayed);
		const double margin = 0.999 * span_margin(settings, steps, distance);
		for (const double moved : {-margin, margin}) {
			CHECK(lod_span(settings, steps, {near + moved, near + 8.0 + moved}, displayed) == displayed);
		}
	}
	LodSpan displayed = lod_span(settings, steps, {20.1, 21.0}, {});
	int changes = 0;
	for (int step = 0; step < 40; ++step) {
		const double near = step % 2 == 0 ? 20.45 : 20.95;
		const LodSpan next = lod_span(settings, steps, {near, near + 1.0}, displayed);
		changes += next == displayed ? 0 : 1;
		displayed = next;
	}
	CHECK(changes <= 1);
}
