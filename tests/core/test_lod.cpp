#include "core/drawing/lod.hpp"
#include "refusal.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

using namespace thicket;

namespace {

LodSettings thinning() {
	LodSettings settings;
	settings.lod_distances = {20.0, 50.0, 51.0};
	settings.thin_begin = 30.0;
	settings.thin_end = 130.0;
	settings.thin_density = 0.2;
	settings.scale_compensation = true;
	return settings;
}

} // namespace

TEST_CASE("lod: each mesh is used from its distance on, until the viewer is 5 % nearer") {
	const LodSettings settings = thinning();
	CHECK(lod_at(settings, 0.0, 0) == 0);
	CHECK(lod_at(settings, 19.99, 0) == 0);
	CHECK(lod_at(settings, 20.0, 0) == 1);
	CHECK(lod_at(settings, 19.01, 1) == 1);
	CHECK(lod_at(settings, 18.99, 1) == 0);
	CHECK(lod_at(settings, 1e5, 0) == 3);
	CHECK(lod_at(settings, 50.5, 0) == 2);
	CHECK(lod_at(settings, 50.5, 3) == 3);
	CHECK(lod_at(settings, 0.0, 3) == 0);
	CHECK(lod_at({}, 1e5, 0) == 0);
	CHECK(lod_at({}, 1e5, 7) == 0);
}

TEST_CASE("lod: moving back and forth within 5 % changes the mesh only once") {
	const LodSettings settings = thinning();
	std::size_t current_lod = lod_at(settings, 10.0, 0);
	int changes = 0;
	for (int step = 0; step < 1000; ++step) {
		const double distance = 19.6 + 0.55 * std::sin(step * 0.3);
		const std::size_t lod = lod_at(settings, distance, current_lod);
		changes += lod != current_lod ? 1 : 0;
		current_lod = lod;
	}
	CHECK(changes == 1);
}

TEST_CASE("lod: the density falls linearly from begin to end, never rises, and then stays constant") {
	const LodSettings settings = thinning();
	CHECK(thinned_density(settings, 0.0) == 1.0);
	CHECK(thinned_density(settings, 30.0) == 1.0);
	CHECK(thinned_density(settings, 80.0) == doctest::Approx(0.6));
	CHECK(thinned_density(settings, 130.0) == doctest::Approx(0.2));
	CHECK(thinned_density(settings, 1e6) == doctest::Approx(0.2));
	double last = 1.0;
	for (double distance = 0.0; distance < 200.0; distance += 0.1) {
		const double density = thinned_density(settings, distance);
		const double exact = 1.0 - 0.8 * std::fmin(std::fmax((distance - 30.0) / 100.0, 0.0), 1.0);
		CHECK(density <= last);
		CHECK(density >= exact - 1e-12);
		CHECK(density <= exact + 0.8 / thin_steps + 1e-12);
		last = density;
	}
	CHECK(thinned_density({}, 1e6) == 1.0);

	LodSettings sudden = settings;
	sudden.thin_end = sudden.thin_begin;
	CHECK(thinned_density(sudden, 29.9) == 1.0);
	CHECK(thinned_density(sudden, 30.0) == doctest::Approx(0.2));
}

TEST_CASE("lod: the instances that remain are enlarged to cover the same area, up to a limit") {
	LodSettings settings = thinning();
	CHECK(compensating_scale(settings, 1.0) == 1.0);
	CHECK(compensating_scale(settings, 0.25) == 2.0);
	CHECK(compensating_scale(settings, 0.01) == max_scale_compensation);
	CHECK(compensating_scale(settings, 0.0) == max_scale_compensation);
	settings.scale_compensation = false;
	CHECK(compensating_scale(settings, 0.25) == 1.0);
}

TEST_CASE("lod: a limited fraction approaches the requested fraction in few steps and never exceeds the limit") {
	double fraction = 1.0;
	int changes = 0;
	const auto follow = [&fraction, &changes](std::uint64_t wanted_count, std::uint64_t max_instances) {
		const double next = limited_fraction(fraction, wanted_count, max_instances);
		changes += next != fraction ? 1 : 0;
		fraction = next;
		CHECK(fraction * static_cast<double>(wanted_count) <= static_cast<double>(max_instances));
		CHECK(fraction >= 0.0);
		CHECK(fraction <= 1.0);
		// The fraction has settled, so a second call returns the same value.
		CHECK(limited_fraction(fraction, wanted_count, max_instances) == fraction);
	};
	for (std::uint64_t wanted_count = 0; wanted_count <= 1000000; wanted_count += 500) {
		follow(wanted_count, 100000);
		CHECK((wanted_count > 100000 || fraction == 1.0));
		CHECK((wanted_count < 100000 || fraction * static_cast<double>(wanted_count) > 0.69 * 100000.0));
	}
	CHECK(changes < 30);
	for (std::uint64_t wanted_count = 1000000; wanted_count > 0; wanted_count -= 500) {
		follow(wanted_count, 100000);
	}
	CHECK(fraction == 1.0);
	CHECK(changes < 60);
	follow(10, 0);
	CHECK(fraction == 0.0);
	follow(10, std::numeric_limits<std::uint64_t>::max());
	CHECK(fraction == 1.0);
}

TEST_CASE("lod: within the margin nothing changes, for every displayed state") {
	std::mt19937 random(11);
	std::uniform_real_distribution<double> any(0.0, 160.0);
	std::uniform_real_distribution<double> fraction(-0.9999, 0.9999);
	const LodSettings settings = thinning();
	double min_margin = 1e9;
	for (int i = 0; i < 20000; ++i) {
		const double distance = any(random);
		const double margin = distance_margin(settings, distance);
		min_margin = std::fmin(min_margin, margin);
		const double near_distance = distance + margin * fraction(random);
		CHECK(thinned_density(settings, near_distance) == thinned_density(settings, distance));
		for (std::size_t current_lod = 0; current_lod < 4; ++current_lod) {
			CHECK(lod_at(settings, near_distance, current_lod) == lod_at(settings, distance, current_lod));
		}
	}
	CHECK(min_margin < 0.01);
	CHECK(distance_margin(settings, 10.0) == doctest::Approx(9.0));
	CHECK(distance_margin(settings, 200.0) == doctest::Approx(70.0));
	CHECK(distance_margin({}, 10.0) == std::numeric_limits<double>::infinity());
}

TEST_CASE("lod: the error for an invalid setting names the property and the value") {
	const auto refuse = [](double LodSettings::*member, const char *property, double value, ErrorCode code) {
		LodSettings bad = thinning();
		bad.*member = value;
		check_refused(validate(bad), code, property, value);
	};
	refuse(&LodSettings::thin_begin, "thin_begin", nan_value, ErrorCode::not_finite);
	refuse(&LodSettings::thin_begin, "thin_begin", -1.0, ErrorCode::out_of_range);
	refuse(&LodSettings::thin_end, "thin_end", 2e6, ErrorCode::out_of_range);
	refuse(&LodSettings::thin_end, "thin_end", 29.0, ErrorCode::inverted);
	refuse(&LodSettings::thin_density, "thin_density", 1.5, ErrorCode::out_of_range);
	refuse(&LodSettings::thin_density, "thin_density", infinite_value, ErrorCode::not_finite);
	const auto refuse_distances = [](std::vector<double> distances, ErrorCode code, double value) {
		LodSettings bad;
		bad.lod_distances = std::move(distances);
		check_refused(validate(bad), code, "lod_distances", value);
	};
	refuse_distances({10.0, 5.0}, ErrorCode::inverted, 5.0);
	refuse_distances({-1.0}, ErrorCode::out_of_range, -1.0);
	refuse_distances({1.0, nan_value}, ErrorCode::not_finite, nan_value);
	refuse_distances(std::vector<double>(max_lods + 1, 1.0), ErrorCode::out_of_range, max_lods + 1.0);
	CHECK(validate(LodSettings{}).ok());
	CHECK(validate(thinning()).ok());
}
