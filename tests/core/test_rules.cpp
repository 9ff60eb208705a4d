#include "core/rules/instance_random.hpp"
#include "core/rules/rules.hpp"
#include "core/rules/slope.hpp"
#include "refusal.hpp"

#include <doctest/doctest.h>

#include <glm/vec3.hpp>

#include <cmath>
#include <numbers>
#include <random>
#include <set>

using namespace thicket;

namespace {

constexpr std::uint64_t seed = 42;
constexpr double radian = std::numbers::pi / 180.0;

/// Ground that is inclined by so many degrees, towards any side.
Ground inclined(double degrees, float height = 0.0f, double heading = 30.0) {
	const double across = std::sin(degrees * radian);
	return {height,
			glm::vec3(across * std::cos(heading * radian), std::cos(degrees * radian),
					across * std::sin(heading * radian))};
}

PreparedRules prepared(const Rules &rules) {
	PreparedRules result;
	REQUIRE(result.set(rules).ok());
	return result;
}

/// The fraction of 20,000 ids that pass.
double fraction_passing(const Rules &rules, const Ground &ground) {
	const PreparedRules ready = prepared(rules);
	constexpr int tries = 20000;
	int passed = 0;
	for (std::uint64_t id = 0; id < tries; ++id) {
		passed += ready.passes_ground(ground, id * 0x9e3779b97f4a7c15, seed) ? 1 : 0;
	}
	return passed / static_cast<double>(tries);
}

/// Four standard errors of a fraction of 20,000.
double tolerance(double chance) { return 4.0 * std::sqrt(chance * (1.0 - chance) / 20000.0) + 1e-9; }

} // namespace

TEST_CASE("rules: slopes are true degrees") {
	for (double degrees = 0.0; degrees <= 180.0; degrees += 0.25) {
		for (const double heading : {0.0, 77.0, 200.0}) {
			const glm::vec3 normal = inclined(degrees, 0.0f, heading).normal;
			const double truth = std::atan2(std::hypot(double(normal.x), double(normal.z)), double(normal.y)) / radian;
			CHECK(std::abs(slope_degrees(normal) - truth) < 1e-7);
			CHECK(std::abs(slope_degrees(normal) - degrees) < 1e-4);
		}
	}
	CHECK(slope_degrees({0.0f, 1.0f, 0.0f}) == 0.0);
	CHECK(slope_degrees({1.0f, 1.0f, 0.0f}) == 45.0);
	CHECK(slope_degrees({1.0f, 0.0f, 0.0f}) == 90.0);
	CHECK(slope_degrees({0.0f, -1.0f, 0.0f}) == 180.0);
	CHECK(std::isnan(slope_degrees({0.0f, 0.0f, 0.0f})));
	CHECK(std::isnan(slope_degrees({std::nanf(""), 1.0f, 0.0f})));
}

TEST_CASE("rules: a slope limit cuts at its own angle, on both sides") {
	for (const double limit : {30.0, 45.0, 60.0}) {
		CAPTURE(limit);
		Rules up_to;
		up_to.max_slope_degrees = limit;
		Rules from;
		from.min_slope_degrees = limit;
		for (double degrees = 0.5; degrees < 90.0; degrees += 1.0) {
			CAPTURE(degrees);
			CHECK(prepared(up_to).passes_ground(inclined(degrees), 1, seed) == (degrees < limit));
			CHECK(prepared(from).passes_ground(inclined(degrees), 1, seed) == (degrees > limit));
		}
	}
	Rules flat_only;
	flat_only.max_slope_degrees = 0.0;
	CHECK(prepared(flat_only).passes_ground(Ground{0.0f, {0.0f, 1.0f, 0.0f}}, 1, seed));
	CHECK_FALSE(prepared(flat_only).passes_ground(inclined(0.01), 1, seed));
}

TEST_CASE("rules: what is no ground, a wall or a ceiling never passes") {
	Rules anything;
	anything.max_slope_degrees = 90.0;
	Rules flat;
	flat.max_slope_degrees = 10.0;
	const float nothing = std::numeric_limits<float>::quiet_NaN();
	const float infinite = std::numeric_limits<float>::infinity();
	for (const Rules &rules : {anything, flat}) {
		const PreparedRules ready = prepared(rules);
		CHECK(ready.passes_ground({0.0f, {0.0f, 1.0f, 0.0f}}, 1, seed));
		for (const Ground &ground : {Ground{}, Ground{nothing, {0.0f, 1.0f, 0.0f}},
					 Ground{infinite, {0.0f, 1.0f, 0.0f}}, Ground{-infinite, {0.0f, 1.0f, 0.0f}},
					 Ground{0.0f, {nothing, 1.0f, 0.0f}}, Ground{0.0f, {0.0f, nothing, 0.0f}},
					 Ground{0.0f, {0.0f, 1.0f, nothing}}, Ground{0.0f, {0.0f, infinite, 0.0f}},
					 Ground{0.0f, {0.0f, 0.0f, 0.0f}}, Ground{0.0f, {1.0f, 0.0f, 0.0f}},
					 Ground{0.0f, {0.0f, -1.0f, 0.0f}}, inclined(91.0), inclined(135.0), inclined(179.0)}) {
			CHECK_FALSE(ready.passes_ground(ground, 1, seed));
		}
	}
}

TEST_CASE("rules: defaults let all ground pass") {
	const PreparedRules ready = prepared({});
	for (const float height : {0.0f, -1e-30f, 8848.0f, -11000.0f, 3e38f, -3e38f}) {
		for (const double degrees : {0.0, 45.0, 89.9}) {
			CHECK(ready.passes_ground(inclined(degrees, height), 1, seed));
		}
	}
	CHECK(ready.passes_density(0));
	CHECK(ready.passes_density(0xffffffff));
}

TEST_CASE("rules: height limits are hard and include themselves, negative ones too") {
	Rules rules;
	rules.min_height = -20.5;
	rules.max_height = -3.25;
	for (const double falloff : {0.0, 5.0}) {
		rules.height_falloff = falloff;
		CHECK(fraction_passing(rules, inclined(0.0, -20.6f)) == 0.0);
		CHECK(fraction_passing(rules, inclined(0.0, -3.2f)) == 0.0);
		CHECK(fraction_passing(rules, inclined(0.0, 0.0f)) == 0.0);
		CHECK(fraction_passing(rules, inclined(0.0, -12.0f)) == 1.0);
	}
	rules.height_falloff = 0.0;
	CHECK(fraction_passing(rules, inclined(0.0, -20.5f)) == 1.0);
	CHECK(fraction_passing(rules, inclined(0.0, -3.25f)) == 1.0);
}

TEST_CASE("rules: a falloff thins linearly inside its limit") {
	Rules rules;
	rules.min_height = 100.0;
	rules.height_falloff = 40.0;
	rules.max_slope_degrees = 30.0;
	rules.slope_falloff = 10.0;
	for (const double share : {0.0, 0.1, 0.25, 0.5, 0.75, 0.9, 1.0}) {
		CAPTURE(share);
		const auto height = static_cast<float>(100.0 + 40.0 * share);
		CHECK(std::abs(fraction_passing(rules, inclined(0.0, height)) - share) < tolerance(share));
		const double degrees = 30.0 - 10.0 * share;
		CHECK(std::abs(fraction_passing(rules, inclined(degrees, 500.0f)) - share) < tolerance(share));
		// The two falloffs roll dice of their own.
		CHECK(std::abs(fraction_passing(rules, inclined(degrees, height)) - share * share) < tolerance(share * share));
	}
	CHECK(fraction_passing(rules, inclined(0.0, 1e6f)) == 1.0);
}

TEST_CASE("rules: where both bands meet the smaller chance counts, and an open limit has no band") {
	Rules tent;
	tent.min_height = 0.0;
	tent.max_height = 10.0;
	tent.height_falloff = 20.0;
	CHECK(std::abs(fraction_passing(tent, inclined(0.0, 5.0f)) - 0.25) < tolerance(0.25));
	CHECK(std::abs(fraction_passing(tent, inclined(0.0, 8.0f)) - 0.1) < tolerance(0.1));

	Rules open;
	open.slope_falloff = 90.0;
	open.height_falloff = 1e9;
	CHECK(fraction_passing(open, inclined(1.0, -5000.0f)) == 1.0);
	CHECK(fraction_passing(open, inclined(89.0, 5000.0f)) == 1.0);
}

TEST_CASE("rules: narrowing any limit only takes instances away") {
	std::mt19937_64 random(11);
	std::uniform_real_distribution<double> unit(0.0, 1.0);
	for (int round = 0; round < 50; ++round) {
		Rules wide;
		wide.min_slope_degrees = 30.0 * unit(random);
		wide.max_slope_degrees = 50.0 + 40.0 * unit(random);
		wide.slope_falloff = 15.0 * unit(random);
		wide.min_height = -100.0 * unit(random);
		wide.max_height = 50.0 + 50.0 * unit(random);
		wide.height_falloff = 30.0 * unit(random);
		wide.density = 0.5 + 0.5 * unit(random);
		Rules narrow = wide;
		switch (round % 7) {
			case 0: narrow.min_slope_degrees += 10.0; break;
			case 1: narrow.max_slope_degrees -= 10.0; break;
			case 2: narrow.slope_falloff += 10.0; break;
			case 3: narrow.min_height += 20.0; break;
			case 4: narrow.max_height -= 20.0; break;
			case 5: narrow.height_falloff += 10.0; break;
			default: narrow.density *= 0.5; break;
		}
		const PreparedRules a = prepared(wide);
		const PreparedRules b = prepared(narrow);
		int lost = 0;
		for (int i = 0; i < 2000; ++i) {
			const Ground ground = inclined(90.0 * unit(random), static_cast<float>(250.0 * unit(random) - 125.0));
			const std::uint64_t id = random();
			const auto rank = static_cast<std::uint32_t>(random());
			const bool passes_wide = a.passes_density(rank) && a.passes_ground(ground, id, seed);
			const bool passes_narrow = b.passes_density(rank) && b.passes_ground(ground, id, seed);
			CHECK_FALSE((passes_narrow && !passes_wide));
			lost += passes_wide && !passes_narrow ? 1 : 0;
		}
		CHECK(lost > 0);
	}
}

TEST_CASE("rules: density is a threshold on the rank") {
	Rules rules;
	rules.density = 0.25;
	const PreparedRules quarter = prepared(rules);
	CHECK(quarter.passes_density(0));
	CHECK(quarter.passes_density(0x3fffffff));
	CHECK_FALSE(quarter.passes_density(0x40000000));
	rules.density = 0.0;
	CHECK_FALSE(prepared(rules).passes_density(0));
	rules.density = 1.0;
	CHECK(prepared(rules).passes_density(0xffffffff));
}

TEST_CASE("rules: bad settings are refused by name and value, and the last good ones stay") {
	Rules good;
	good.max_height = 50.0;
	PreparedRules ready = prepared(good);
	const auto refuse = [&](double Rules::*member, const char *property, double value, ErrorCode code) {
		Rules bad;
		bad.*member = value;
		check_refused(ready.set(bad), code, property, value);
		CHECK(ready.rules() == good);
		CHECK_FALSE(ready.passes_ground(inclined(0.0, 51.0f), 1, seed));
	};
	struct Limits {
		double Rules::*member;
		const char *property;
		double above;
	};
	for (const Limits &each : {Limits{&Rules::density, "density", 1.001},
				 {&Rules::slope_falloff, "slope_falloff", 90.5}, {&Rules::min_slope_degrees, "min_slope_degrees", 91.0},
				 {&Rules::max_slope_degrees, "max_slope_degrees", 180.0}}) {
		refuse(each.member, each.property, nan_value, ErrorCode::not_finite);
		refuse(each.member, each.property, infinite_value, ErrorCode::not_finite);
		refuse(each.member, each.property, -0.1, ErrorCode::out_of_range);
		refuse(each.member, each.property, each.above, ErrorCode::out_of_range);
	}
	refuse(&Rules::min_height, "min_height", nan_value, ErrorCode::not_finite);
	refuse(&Rules::max_height, "max_height", -infinite_value, ErrorCode::not_finite);
	refuse(&Rules::height_falloff, "height_falloff", nan_value, ErrorCode::not_finite);
	refuse(&Rules::height_falloff, "height_falloff", -1.0, ErrorCode::out_of_range);

	Rules inverted;
	inverted.min_slope_degrees = 40.0;
	inverted.max_slope_degrees = 30.0;
	check_refused(ready.set(inverted), ErrorCode::inverted, "max_slope_degrees", 30.0);
	inverted = {};
	inverted.min_height = 10.0;
	inverted.max_height = 9.0;
	check_refused(ready.set(inverted), ErrorCode::inverted, "max_height", 9.0);
	CHECK(ready.rules() == good);
}

TEST_CASE("rules: an instance's random words differ by seed, id and purpose") {
	std::set<std::uint32_t> words;
	for (std::uint64_t s = 0; s < 4; ++s) {
		for (std::uint64_t id = 0; id < 4; ++id) {
			for (const Draw draw : {Draw::rules, Draw::placement, Draw::mesh}) {
				for (const std::uint32_t word : instance_random(s << 32, id << 24, draw)) {
					words.insert(word);
				}
			}
		}
	}
	CHECK(words.size() == 4 * 4 * 3 * 4);
	CHECK(unit_interval(0) == 0.0);
	CHECK(unit_interval(0xffffffff) < 1.0);
}
