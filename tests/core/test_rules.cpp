#include "core/rules/instance_random.hpp"
#include "core/rules/rules.hpp"
#include "refusal.hpp"
#include "rules_fixture.hpp"
#include "tests/analysis/curve_table.hpp"

#include <doctest/doctest.h>

#include <glm/vec3.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <set>
#include <span>
#include <utility>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

constexpr double radian = std::numbers::pi / 180.0;

/// Returns ground with a slope of `degrees` whose normal leans toward `heading`, also in degrees.
Ground inclined(double degrees, float height = 0.0f, double heading = 30.0) {
	const double slope = std::sin(degrees * radian);
	return {height,
			glm::vec3(slope * std::cos(heading * radian), std::cos(degrees * radian),
					slope * std::sin(heading * radian))};
}

double density_on(const Rules &rules, const Ground &ground) { return prepared(rules).ground_density(ground, {}); }

bool allowed(const PreparedRules &rules, const Ground &ground) { return rules.ground_density(ground, {}) > 0.0; }

/// Returns the density that the rules for positions yield at a position, independent of the ground.
double density_at(const Rules &rules, glm::dvec2 position) {
	std::vector<float> scratch;
	double density = -1.0;
	REQUIRE(prepared(rules).position_densities({{&position, 1}}, {&density, 1}, scratch).ok());
	return density;
}

/// A density field that evaluates a function.
class FunctionField final : public DensityField {
public:
	explicit FunctionField(std::function<float(glm::dvec2)> function) : function_(std::move(function)) {}

	Status sample(std::span<const glm::dvec2> positions, std::span<float> r_density) const override {
		std::ranges::transform(positions, r_density.begin(), function_);
		return {};
	}

private:
	std::function<float(glm::dvec2)> function_;
};

std::shared_ptr<const DensityField> constant_field(float value) {
	return std::make_shared<FunctionField>([value](glm::dvec2) { return value; });
}

} // namespace

TEST_CASE("rules: a slope limit cuts at exactly its angle, on both sides") {
	for (const double limit : {30.0, 45.0, 60.0}) {
		CAPTURE(limit);
		Rules up_to;
		up_to.max_slope_degrees = limit;
		Rules from;
		from.min_slope_degrees = limit;
		for (double degrees = 0.5; degrees < 90.0; degrees += 1.0) {
			CAPTURE(degrees);
			CHECK(allowed(prepared(up_to), inclined(degrees)) == (degrees < limit));
			CHECK(allowed(prepared(from), inclined(degrees)) == (degrees > limit));
		}
	}
	Rules flat_only;
	flat_only.max_slope_degrees = 0.0;
	CHECK(allowed(prepared(flat_only), Ground{0.0f, {0.0f, 1.0f, 0.0f}}));
	CHECK_FALSE(allowed(prepared(flat_only), inclined(0.01)));
}

TEST_CASE("rules: missing ground, walls and ceilings never pass") {
	Rules default_rules;
	default_rules.max_slope_degrees = 90.0;
	Rules flat;
	flat.max_slope_degrees = 10.0;
	const float nothing = std::numeric_limits<float>::quiet_NaN();
	const float infinite = std::numeric_limits<float>::infinity();
	for (const Rules &rules : {default_rules, flat}) {
		const PreparedRules prepared_rules = prepared(rules);
		CHECK(allowed(prepared_rules, {0.0f, {0.0f, 1.0f, 0.0f}}));
		for (const Ground &ground : {Ground{}, Ground{nothing, {0.0f, 1.0f, 0.0f}},
					 Ground{infinite, {0.0f, 1.0f, 0.0f}}, Ground{-infinite, {0.0f, 1.0f, 0.0f}},
					 Ground{0.0f, {nothing, 1.0f, 0.0f}}, Ground{0.0f, {0.0f, nothing, 0.0f}},
					 Ground{0.0f, {0.0f, 1.0f, nothing}}, Ground{0.0f, {0.0f, infinite, 0.0f}},
					 Ground{0.0f, {0.0f, 0.0f, 0.0f}}, Ground{0.0f, {1.0f, 0.0f, 0.0f}},
					 Ground{0.0f, {0.0f, -1.0f, 0.0f}}, inclined(91.0), inclined(135.0), inclined(179.0)}) {
			CHECK_FALSE(allowed(prepared_rules, ground));
		}
	}
}

TEST_CASE("rules: defaults permit all ground") {
	const PreparedRules prepared_rules = prepared({});
	for (const float height : {0.0f, -1e-30f, 8848.0f, -11000.0f, 3e38f, -3e38f}) {
		for (const double degrees : {0.0, 45.0, 89.9}) {
			CHECK(allowed(prepared_rules, inclined(degrees, height)));
		}
	}
	CHECK(density_at({}, {5.0, -7.0}) == 1.0);
}

TEST_CASE("rules: height limits are hard and inclusive, also negative ones") {
	Rules rules;
	rules.min_height = -20.5;
	rules.max_height = -3.25;
	for (const double falloff : {0.0, 5.0}) {
		rules.height_falloff = falloff;
		CHECK(density_on(rules, inclined(0.0, -20.6f)) == 0.0);
		CHECK(density_on(rules, inclined(0.0, -3.2f)) == 0.0);
		CHECK(density_on(rules, inclined(0.0, 0.0f)) == 0.0);
		CHECK(density_on(rules, inclined(0.0, -12.0f)) == 1.0);
	}
	rules.height_falloff = 0.0;
	CHECK(density_on(rules, inclined(0.0, -20.5f)) == 1.0);
	CHECK(density_on(rules, inclined(0.0, -3.25f)) == 1.0);
}

TEST_CASE("rules: a falloff thins linearly inside its limit, and falloffs multiply") {
	Rules rules;
	rules.min_height = 100.0;
	rules.height_falloff = 40.0;
	rules.max_slope_degrees = 30.0;
	rules.slope_falloff_degrees = 10.0;
	for (const double fraction : {0.0, 0.1, 0.25, 0.5, 0.75, 0.9, 1.0}) {
		CAPTURE(fraction);
		const auto height = static_cast<float>(100.0 + 40.0 * fraction);
		const double degrees = 30.0 - 10.0 * fraction;
		CHECK(std::abs(density_on(rules, inclined(0.0, height)) - fraction) < 1e-6);
		CHECK(std::abs(density_on(rules, inclined(degrees, 500.0f)) - fraction) < 1e-5);
		CHECK(std::abs(density_on(rules, inclined(degrees, height)) - fraction * fraction) < 1e-5);
	}
	CHECK(density_on(rules, inclined(0.0, 1e6f)) == 1.0);
}

TEST_CASE("rules: where both bands overlap, the smaller density applies, and an open limit has no band") {
	Rules tent;
	tent.min_height = 0.0;
	tent.max_height = 10.0;
	tent.height_falloff = 20.0;
	CHECK(density_on(tent, inclined(0.0, 5.0f)) == 0.25);
	CHECK(density_on(tent, inclined(0.0, 8.0f)) == 0.1);

	Rules open;
	open.slope_falloff_degrees = 90.0;
	open.height_falloff = 1e9;
	CHECK(density_on(open, inclined(1.0, -5000.0f)) == 1.0);
	CHECK(density_on(open, inclined(89.0, 5000.0f)) == 1.0);
}

TEST_CASE("rules: narrowing any limit only removes instances") {
	std::mt19937_64 random(11);
	std::uniform_real_distribution<double> unit(0.0, 1.0);
	for (int round = 0; round < 50; ++round) {
		Rules wide;
		wide.min_slope_degrees = 30.0 * unit(random);
		wide.max_slope_degrees = 50.0 + 40.0 * unit(random);
		wide.slope_falloff_degrees = 15.0 * unit(random);
		wide.min_height = -100.0 * unit(random);
		wide.max_height = 50.0 + 50.0 * unit(random);
		wide.height_falloff = 30.0 * unit(random);
		wide.density = 0.5 + 0.5 * unit(random);
		Rules narrow = wide;
		switch (round % 7) {
			case 0: narrow.min_slope_degrees += 10.0; break;
			case 1: narrow.max_slope_degrees -= 10.0; break;
			case 2: narrow.slope_falloff_degrees += 10.0; break;
			case 3: narrow.min_height += 20.0; break;
			case 4: narrow.max_height -= 20.0; break;
			case 5: narrow.height_falloff += 10.0; break;
			default: narrow.density *= 0.5; break;
		}
		const PreparedRules a = prepared(wide);
		const PreparedRules b = prepared(narrow);
		int lost_count = 0;
		for (int i = 0; i < 2000; ++i) {
			const Ground ground = inclined(90.0 * unit(random), static_cast<float>(250.0 * unit(random) - 125.0));
			const auto rank = static_cast<std::uint32_t>(random());
			const bool passes_wide = is_placed(rank, wide.density * a.ground_density(ground, {}));
			const bool passes_narrow = is_placed(rank, narrow.density * b.ground_density(ground, {}));
			CHECK_FALSE((passes_narrow && !passes_wide));
			lost_count += passes_wide && !passes_narrow ? 1 : 0;
		}
		CHECK(lost_count > 0);
	}
}

TEST_CASE("rules: the product of all densities is a threshold on the rank") {
	CHECK(is_placed(0, 0.25));
	CHECK(is_placed(0x3fffffff, 0.25));
	CHECK_FALSE(is_placed(0x40000000, 0.25));
	CHECK_FALSE(is_placed(0, 0.0));
	CHECK(is_placed(0xffffffff, 1.0));
}

TEST_CASE("rules: thinning by a fraction removes the same instances as a density of that fraction") {
	std::mt19937_64 random(3);
	std::uniform_real_distribution<double> unit(0.0, 1.0);
	for (int i = 0; i < 100000; ++i) {
		const double density = unit(random);
		const double fraction = unit(random);
		const auto rank = static_cast<std::uint32_t>(random());
		if (is_placed(rank, density)) {
			const std::uint32_t thinned = thinning_rank(rank, density);
			CHECK(thinned >= rank);
			if (std::abs(thinned - fraction * 0x1p32) > 2.0) { // Closer ranks depend on rounding.
				CHECK((thinned < fraction * 0x1p32) == is_placed(rank, density * fraction));
			}
		}
	}
	CHECK(thinning_rank(0xffffffff, 1.0) == 0xffffffff);
	CHECK(thinning_rank(0, 1e-300) == 0);
	CHECK(thinning_rank(5, 1e-9) == 0xffffffff);
}

TEST_CASE("rules: the densities of a position multiply, and the densities of a field are clamped to 0 and 1") {
	Rules rules;
	rules.density = 0.5;
	CHECK(density_at(rules, {1.0, 2.0}) == 0.5);
	rules.fields = {constant_field(0.5f)};
	CHECK(density_at(rules, {1.0, 2.0}) == 0.25);
	rules.fields.push_back(std::make_shared<FunctionField>([](glm::dvec2 at) { return at.x < 0.0 ? 0.25f : 1.0f; }));
	CHECK(density_at(rules, {1.0, 2.0}) == 0.25);
	CHECK(density_at(rules, {-1.0, 2.0}) == 0.0625);
	for (const float wild : {7.0f, std::numeric_limits<float>::infinity()}) {
		rules.fields = {constant_field(wild)};
		CHECK(density_at(rules, {0.0, 0.0}) == 0.5);
	}
	for (const float invalid : {-1.0f, std::numeric_limits<float>::quiet_NaN()}) {
		rules.fields = {constant_field(invalid)};
		CHECK(density_at(rules, {0.0, 0.0}) == 0.0);
	}
}

TEST_CASE("rules: painted masks and clumps have the same effect as any density of the position") {
	auto mask = std::make_shared<PaintedMask>();
	REQUIRE(mask->reset(1.0, 1.0).ok());
	Rect changed_rect;
	REQUIRE(mask->paint({Brush::Mode::erase, {10.0, 10.0}, 5.0, 1.0, 1.0}, changed_rect).ok());
	Rules rules;
	rules.mask = mask;
	CHECK(density_at(rules, {10.0, 10.0}) == 0.0);
	CHECK(density_at(rules, {30.0, 10.0}) == 1.0);
	rules.mask = nullptr;
	rules.clumping = {20.0, 0.5, 0.0};
	int open = 0;
	for (int i = 0; i < 1000; ++i) {
		const double density = density_at(rules, {37.0 * i, 0.0});
		CHECK((density == 0.0 || density == 1.0));
		open += density > 0.0 ? 1 : 0;
	}
	CHECK(open > 300);
	CHECK(open < 700);
}

TEST_CASE("rules: curves over height and slope, and the weight of the ground's textures") {
	Rules rules;
	rules.height_curve = analysis::curve_table(0.0, 100.0, {0.0f, 1.0f});
	CHECK(density_on(rules, inclined(0.0, 25.0f)) == 0.25);
	CHECK(density_on(rules, inclined(0.0, -5.0f)) == 0.0);
	CHECK(density_on(rules, inclined(0.0, 1000.0f)) == 1.0);
	rules.slope_curve = analysis::curve_table(0.0, 90.0, {1.0f, 0.0f});
	CHECK(density_on(rules, Ground{25.0f, {1.0f, 1.0f, 0.0f}}) == 0.125); // A slope of 45 degrees.
	Ground half = inclined(0.0, 25.0f);
	half.weight = 0.5f;
	CHECK(density_on(rules, half) == 0.25); // These rules require no textures.
	rules.ground_textures = {1, 4};
	CHECK(density_on(rules, half) == 0.125);
	half.weight = std::numeric_limits<float>::quiet_NaN();
	CHECK(density_on(rules, half) == 0.0);
	half.weight = 3.0f;
	CHECK(density_on(rules, half) == 0.25);
}

TEST_CASE("rules: the error of a field is returned") {
	class Failing final : public DensityField {
	public:
		Status sample(std::span<const glm::dvec2>, std::span<float>) const override {
			return {ErrorCode::missing, "noise", 0.0};
		}
	};
	Rules rules;
	rules.fields = {std::make_shared<Failing>()};
	std::vector<float> scratch;
	const glm::dvec2 position(0.0);
	double density = 0.0;
	check_refused(prepared(rules).position_densities({{&position, 1}}, {&density, 1}, scratch), ErrorCode::missing,
			"noise", 0.0);
}

TEST_CASE("rules: the error for an invalid setting contains its name and value, and the last valid settings stay") {
	Rules good;
	good.max_height = 50.0;
	PreparedRules prepared_rules = prepared(good);
	const auto refuse = [&](double Rules::*member, const char *property, double value, ErrorCode code) {
		Rules bad;
		bad.*member = value;
		check_refused(prepared_rules.set(bad, seed), code, property, value);
		CHECK(prepared_rules.rules() == good);
		CHECK_FALSE(allowed(prepared_rules, inclined(0.0, 51.0f)));
	};
	struct Limits {
		double Rules::*member;
		const char *property;
		double above;
	};
	for (const Limits &each :
			{Limits{&Rules::density, "density", 1.001}, {&Rules::slope_falloff_degrees, "slope_falloff_degrees", 180.5},
					{&Rules::min_slope_degrees, "min_slope_degrees", 181.0},
					{&Rules::max_slope_degrees, "max_slope_degrees", 360.0}}) {
		refuse(each.member, each.property, nan_value, ErrorCode::not_finite);
		refuse(each.member, each.property, infinite_value, ErrorCode::not_finite);
		refuse(each.member, each.property, -0.1, ErrorCode::out_of_range);
		refuse(each.member, each.property, each.above, ErrorCode::out_of_range);
	}
	refuse(&Rules::min_height, "min_height", nan_value, ErrorCode::not_finite);
	refuse(&Rules::max_height, "max_height", -infinite_value, ErrorCode::not_finite);
	refuse(&Rules::height_falloff, "height_falloff", nan_value, ErrorCode::not_finite);
	refuse(&Rules::height_falloff, "height_falloff", -1.0, ErrorCode::out_of_range);
	refuse(&Rules::edge_feather, "edge_feather", nan_value, ErrorCode::not_finite);
	refuse(&Rules::edge_feather, "edge_feather", -1.0, ErrorCode::out_of_range);
	refuse(&Rules::edge_feather, "edge_feather", 1001.0, ErrorCode::out_of_range);
	Rules null_field;
	null_field.fields = {nullptr};
	check_refused(prepared_rules.set(null_field, seed), ErrorCode::missing, "fields", 0.0);
	Rules clumps;
	clumps.clumping.size = -1.0;
	CHECK_FALSE(prepared_rules.set(clumps, seed).ok());

	Rules inverted;
	inverted.min_slope_degrees = 40.0;
	inverted.max_slope_degrees = 30.0;
	check_refused(prepared_rules.set(inverted, seed), ErrorCode::inverted, "max_slope_degrees", 30.0);
	inverted = {};
	inverted.min_height = 10.0;
	inverted.max_height = 9.0;
	check_refused(prepared_rules.set(inverted, seed), ErrorCode::inverted, "max_height", 9.0);
	CHECK(prepared_rules.rules() == good);
}

TEST_CASE("rules: an instance's random words differ by seed, ID and purpose") {
	std::set<std::uint32_t> words;
	for (std::uint64_t s = 0; s < 4; ++s) {
		for (std::uint64_t id = 0; id < 4; ++id) {
			for (const Draw draw : {Draw::placement, Draw::mesh}) {
				for (const std::uint32_t word : instance_random(s << 32, id << 24, draw)) {
					words.insert(word);
				}
			}
		}
	}
	CHECK(words.size() == 4 * 4 * 2 * 4);
	CHECK(unit_interval(0) == 0.0);
	CHECK(unit_interval(0xffffffff) < 1.0);
}
