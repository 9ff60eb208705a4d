// Tests that rules skip computations that cannot change the result.

#include "core/rules/rules.hpp"
#include "rounding.hpp"
#include "rules_fixture.hpp"

#include <doctest/doctest.h>

#include <memory>
#include <utility>
#include <vector>

using namespace thicket;
using namespace thicket::test;

TEST_CASE("rules: values that cannot change a density are not computed") {
	// The slope is 37 degrees. Computing its angle rounds, but squaring the components of the
	// normal does not.
	const Ground ground{8.0f, {0.75f, 1.0f, 0.0f}};
	const auto density_and_work = [](const PreparedRules &rules, const Ground &sampled_ground) {
		double density = 0.0;
		const bool computed = rounds([&] { density = rules.ground_density(sampled_ground, {3.0, 5.0}); });
		return std::pair(density, computed);
	};
	Rules slopes;
	slopes.min_slope_degrees = 30.0;
	const PreparedRules steep = prepared(slopes);
	CHECK(density_and_work(steep, ground) == std::pair(1.0, false));
	CHECK(density_and_work(steep, {8.0f, {0.25f, 1.0f, 0.0f}}) == std::pair(0.0, false));
	bool is_allowed = false;
	CHECK_FALSE(rounds([&] { is_allowed = steep.allow(ground, {}); }));
	CHECK(is_allowed);
	slopes.slope_falloff_degrees = 20.0; // The falloff requires the angle.
	CHECK(density_and_work(prepared(slopes), ground).second);
	slopes.min_height = 9.0;
	CHECK(density_and_work(prepared(slopes), ground) == std::pair(0.0, false));
	// Finding the biome of a position, which determines the water level, evaluates noise.
	BiomeMap map;
	REQUIRE(map.set({2, 1}, std::vector<std::uint8_t>{0, 1}, {{-99.0, -99.0}, {99.0, 99.0}}, BiomeEdge::clamp,
					   {.width = 5.0, .noise = 9.0, .noise_size = 30.0})
					.ok());
	Rules wet;
	wet.max_water_depth = 3.0;
	PerBiome<double> levels{};
	levels.fill(5.0);
	levels[1] = 6.0;
	wet.water = std::make_shared<WaterLevels>(std::make_shared<const BiomeMap>(map), levels);
	CHECK(density_and_work(prepared(wet), ground).second);
	wet.min_height = 9.0;
	CHECK(density_and_work(prepared(wet), ground) == std::pair(0.0, false));
	wet.min_height = 7.0;
	CHECK(density_and_work(prepared(wet), ground).second);
	wet.max_water_depth = unlimited_height; // The rules allow any depth.
	CHECK(density_and_work(prepared(wet), ground) == std::pair(1.0, false));
}

TEST_CASE("rules: clumps are evaluated only where the other rules permit instances") {
	Rules rules;
	rules.clumping = {.size = 10.0};
	std::vector<float> scratch(1);
	const auto rounds_density = [&] {
		const PreparedRules prepared_rules = prepared(rules);
		const glm::dvec2 position(3.0, 5.0);
		double density = -1.0;
		return rounds(
				[&] { REQUIRE(prepared_rules.position_densities({{&position, 1}}, {&density, 1}, scratch).ok()); });
	};
	CHECK(rounds_density());
	rules.density = 0.0;
	CHECK_FALSE(rounds_density());
}
