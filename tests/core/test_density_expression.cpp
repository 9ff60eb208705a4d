// Tests the language of density expressions: values, precedence, errors and noise.

#include "core/rules/density_expression.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

using namespace thicket;

namespace {

constexpr ExpressionInputs somewhere{
		.height = 950.0, .slope = 20.0, .water_depth = -3.0, .position = {64.5, 950.0, -12.0}};

std::shared_ptr<const DensityExpression> compiled(std::string_view text) {
	ExpressionError error;
	auto expression = DensityExpression::compile(text, error);
	INFO(text, ": column ", error.column, ": ", error.message);
	REQUIRE(expression != nullptr);
	return expression;
}

double value_of(std::string_view text) { return compiled(text)->at(somewhere, 1, false); }

ExpressionError error_of(std::string_view text) {
	ExpressionError error;
	INFO(text);
	REQUIRE(DensityExpression::compile(text, error) == nullptr);
	return error;
}

} // namespace

TEST_CASE("density expression: numbers, inputs, operators and functions have their values") {
	const std::vector<std::pair<const char *, double>> cases{
			{"0.25", 0.25},
			{" .5 ", 0.5},
			{"1e-3", 0.001},
			{"2.5E2", 250.0},
			{"height", 950.0},
			{"slope", 20.0},
			{"water_depth", -3.0},
			{"x", 64.5},
			{"z", -12.0},
			{"1 + 2 * 3", 7.0},
			{"(1 + 2) * 3", 9.0},
			{"10 - 2 - 3", 5.0},
			{"16 / 4 / 2", 2.0},
			{"-slope + 1", -19.0},
			{"2 * -3", -6.0},
			{"--2", 2.0},
			{"slope < 30", 1.0},
			{"slope<=20", 1.0},
			{"slope > 20", 0.0},
			{"20 >= slope", 1.0},
			{"1 + 1 < 3 - 2", 0.0},
			{"abs(water_depth)", 3.0},
			{"floor(x)", 64.0},
			{"floor(z / 5)", -3.0},
			{"sqrt(x - 0.5)", 8.0},
			{"min(slope, 5)", 5.0},
			{"max(slope, 5)", 20.0},
			{"clamp(slope, 0, 1)", 1.0},
			{"clamp(water_depth, 0, 1)", 0.0},
			{"lerp(10, 20, 0.25)", 12.5},
			{"inverse_lerp(900, 1000, height)", 0.5},
			{"smoothstep(900, 1000, height)", 0.5},
			{"smoothstep(1000, 900, height)", 0.5},
			{"smoothstep(950, 1000, height)", 0.0},
			{"smoothstep(800, 900, height)", 1.0},
			{"smoothstep(950, 950, height)", 1.0},
			{"smoothstep(951, 951, height)", 0.0},
			{"smoothstep(900, 1000, 925)", 0.15625},
			{"(slope < 30) * (height > 900) * 0.5", 0.5},
	};
	for (const std::pair<const char *, double> &each : cases) {
		CAPTURE(each.first);
		CHECK(value_of(each.first) == each.second);
	}
	CHECK(std::isnan(value_of("sqrt(water_depth)")));
	CHECK(std::isinf(value_of("1 / (slope - 20)")));
}

TEST_CASE("density expression: numbers become the nearest doubles") {
	std::mt19937_64 random(7);
	for (int i = 0; i < 20000; ++i) {
		std::array<char, 40> text{};
		const auto digits = static_cast<unsigned long long>(random() % 1'000'000'000'000'000ull);
		std::snprintf(text.data(), text.size(), "%llue%d", digits, static_cast<int>(random() % 45) - 22);
		CAPTURE(text.data());
		REQUIRE(value_of(text.data()) == std::strtod(text.data(), nullptr));
	}
	CHECK(value_of("0.1") == 0.1);
	CHECK(value_of("123456.789012345") == 123456.789012345);
}

TEST_CASE("density expression: it uses the inputs in its text") {
	const auto expression = compiled("smoothstep(0, 10, slope) * (height > 3)");
	CHECK(expression->uses(ExpressionInput::slope));
	CHECK(expression->uses(ExpressionInput::height));
	CHECK_FALSE(expression->uses(ExpressionInput::water_depth));
	CHECK_FALSE(expression->uses(ExpressionInput::x));
	CHECK(expression->text() == "smoothstep(0, 10, slope) * (height > 3)");
}

TEST_CASE("density expression: an error names its column and how to fix it") {
	struct Case {
		std::string text;
		std::size_t column;
		const char *message_part;
	};
	const std::vector<Case> cases{
			{"", 1, "ends too early"},
			{"1 +", 4, "ends too early"},
			{"heigth > 3", 1, "the inputs are height, slope"},
			{"1 + smothstep(0, 1, x)", 5, "the functions are abs"},
			{"smoothstep(0, 1)", 1, "must have 3 arguments, got 2"},
			{"abs()", 1, "must have 1 argument, got 0"},
			{"abs", 1, "expected \"(\" after abs"},
			{"(1 + 2", 7, "expected \")\""},
			{"1 + 2)", 6, "expected an operator"},
			{"1 2", 3, "expected an operator"},
			{"1 ^ 2", 3, "use + - * /"},
			{"* 2", 1, "expected a number"},
			{"noise(x)", 1, "constant size"},
			{"noise(0.01)", 1, "between 0.1 and 100000"},
			{"noise(-3)", 1, "between 0.1 and 100000"},
			{"1 < 2 < 3", 7, "expected an operator"},
			{".", 1, "not a number"},
			{"1e", 1, "not a number"},
			{"1e30", 1, "exponent of at most 22"},
			{"1234567890123456", 1, "at most 15 digits"},
			{std::string(1001, ' '), 1, "at most 1000 characters, got 1001"},
			{std::string(60, '(') + "1" + std::string(60, ')'), 51, "at most 50 parentheses"},
	};
	for (const Case &each : cases) {
		const ExpressionError error = error_of(each.text);
		CAPTURE(each.text);
		CAPTURE(error.message);
		CHECK(error.column == each.column);
		CHECK(error.message.find(each.message_part) != std::string::npos);
	}
	std::string deep = "x";
	for (int i = 0; i < 20; ++i) {
		deep = "x + (" + deep + " * z)"; // Each level leaves one value on the stack.
	}
	CHECK(error_of(deep).message.find("too deeply nested") != std::string::npos);
}

TEST_CASE("density expression: any sequence of tokens is compiled or rejected") {
	const std::vector<const char *> tokens{"(", ")", ",", "+", "-", "*", "/", "<", ">=", "height", "x", "noise",
			"noise(5)", "clamp(", "min(", "sqrt(", "1", "0.5", "1e9", ".", " ", "\xc3\xa9", "smoothstep(0,1,"};
	std::mt19937 random(3);
	int valid = 0;
	for (int i = 0; i < 200000; ++i) {
		std::string text;
		for (auto length = random() % 12; length > 0; --length) {
			text += tokens[random() % tokens.size()];
		}
		ExpressionError error;
		const auto expression = DensityExpression::compile(text, error);
		CAPTURE(text);
		if (expression == nullptr) {
			REQUIRE(error.column >= 1);
			REQUIRE(error.column <= text.size() + 1);
			REQUIRE_FALSE(error.message.empty());
		} else {
			++valid;
			(void)expression->at(somewhere, 1, true);
		}
	}
	CHECK(valid > 1000);
}

TEST_CASE("density expression: noise is uniform, and depends on seed and size only") {
	const auto noise = compiled("noise(20)");
	const auto equivalent = compiled("0 + 1 * noise(2 * 10)");
	const auto larger = compiled("noise(21)");
	for (const bool in_space : {false, true}) {
		CAPTURE(in_space);
		int below = 0;
		int same_for_other_seed = 0;
		constexpr int count = 20000;
		std::mt19937 random(11);
		std::uniform_real_distribution<double> anywhere(-5000.0, 5000.0);
		for (int i = 0; i < count; ++i) {
			ExpressionInputs inputs;
			inputs.position = {anywhere(random), anywhere(random), anywhere(random)};
			const double value = noise->at(inputs, 1, in_space);
			REQUIRE(value >= 0.0);
			REQUIRE(value <= 1.0);
			REQUIRE(equivalent->at(inputs, 1, in_space) == value);
			below += value < 0.3 ? 1 : 0;
			same_for_other_seed += noise->at(inputs, 2, in_space) == value ? 1 : 0;
			same_for_other_seed += larger->at(inputs, 1, in_space) == value ? 1 : 0;
			inputs.position.y += 500.0;
			REQUIRE((noise->at(inputs, 1, in_space) == value) == !in_space);
		}
		CHECK(below / static_cast<double>(count) == doctest::Approx(0.3).epsilon(0.07));
		CHECK(same_for_other_seed < count / 100);
	}
	ExpressionInputs far_inputs;
	far_inputs.position = {1e20, 0.0, 0.0};
	CHECK(std::isnan(noise->at(far_inputs, 1, false)));
}
