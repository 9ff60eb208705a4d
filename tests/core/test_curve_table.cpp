#include "core/rules/curve_table.hpp"
#include "refusal.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

using namespace thicket;

namespace {

CurveTable table_of(double min, double max, const std::vector<float> &samples) {
	CurveTable table;
	REQUIRE(table.set(min, max, samples).ok());
	return table;
}

constexpr double largest_number = std::numeric_limits<double>::max();

} // namespace

TEST_CASE("curve: samples are evenly spaced, with straight lines between") {
	const CurveTable table = table_of(-20.0, 60.0, {0.0f, 0.25f, 1.0f, 0.5f, 0.5f});
	CHECK(table.at(-20.0) == 0.0);
	CHECK(table.at(0.0) == 0.25);
	CHECK(table.at(20.0) == 1.0);
	CHECK(table.at(40.0) == 0.5);
	CHECK(table.at(60.0) == 0.5);
	CHECK(table.at(-10.0) == 0.125);
	CHECK(table.at(15.0) == 0.8125);
	CHECK(table.at(35.0) == 0.625);
	CHECK(table.at(51.3) == 0.5);
	CHECK(table.largest() == 1.0);
}

TEST_CASE("curve: positions beyond an end have the value at the end, and NAN has the value 0") {
	const CurveTable table = table_of(100.0, 101.0, {0.25f, 0.5f, 0.75f});
	for (const double below : {100.0, 99.999999, -1e300, -largest_number, -infinite_value}) {
		CHECK(table.at(below) == 0.25);
	}
	for (const double above : {101.0, 101.000001, 1e300, largest_number, infinite_value}) {
		CHECK(table.at(above) == 0.75);
	}
	CHECK(table.at(nan_value) == 0.0);
	CHECK(CurveTable().at(nan_value) == 0.0);
}

TEST_CASE("curve: the default is 1 everywhere") {
	const CurveTable table;
	for (const double x : {-infinite_value, -3.0, 0.0, 0.3, 1.0, 1e9}) {
		CHECK(table.at(x) == 1.0);
	}
	CHECK(table.largest() == 1.0);
	CHECK(table_of(0.0, 1.0, {1.0f, 1.0f}) == table);
}

TEST_CASE("curve: only a curve that is 0 everywhere is empty") {
	CHECK(table_of(0.0, 1.0, {0.0f, 0.0f, 0.0f}).largest() == 0.0);
	CHECK(table_of(0.0, 1.0, {0.0f, 1e-30f, 0.0f}).largest() > 0.0);
	CHECK(table_of(0.0, 1.0, {0.125f, 0.75f, 0.5f}).largest() == 0.75);
	CHECK(table_of(0.0, 1.0, {0.125f, 0.5f, 0.75f}).largest() == 0.75);
}

TEST_CASE("curve: a value is between the neighboring samples, and right to the last digits") {
	std::mt19937 random(1);
	std::uniform_real_distribution<float> unit(0.0f, 1.0f);
	for (int round = 0; round < 200; ++round) {
		std::vector<float> samples(2 + random() % 30);
		std::ranges::generate(samples, [&] { return random() % 4 == 0 ? float(random() % 2) : unit(random); });
		const double min = -1e3 * unit(random);
		const double max = 1e-3 + 1e3 * unit(random);
		const CurveTable table = table_of(min, max, samples);
		for (int i = 0; i < 50; ++i) {
			const double x = min + (max - min) * unit(random);
			const double position = (x - min) / (max - min) * static_cast<double>(samples.size() - 1);
			const std::size_t index = std::min(static_cast<std::size_t>(position), samples.size() - 2);
			const double first = samples[index];
			const double second = samples[index + 1];
			const double fraction = position - static_cast<double>(index);
			CHECK(table.at(x) >= std::min(first, second));
			CHECK(table.at(x) <= std::max(first, second));
			CHECK(std::abs(table.at(x) - (first * (1.0 - fraction) + second * fraction)) < 1e-12);
			CHECK(table.at(x) <= table.largest());
		}
	}
}

TEST_CASE("curve: values never fall where the samples rise") {
	std::vector<float> samples(max_curve_samples);
	for (std::size_t i = 0; i < samples.size(); ++i) {
		samples[i] = std::sqrt(static_cast<float>(i) / static_cast<float>(samples.size() - 1));
	}
	const CurveTable table = table_of(-7.7, 1234.5, samples);
	double before = -1.0;
	for (double x = -8.0; x < 1235.0; x += 0.0137) {
		REQUIRE(table.at(x) >= before);
		before = table.at(x);
	}
	CHECK(before == 1.0);
}

TEST_CASE("curve: the widest and the narrowest range work") {
	const CurveTable wide = table_of(-largest_number, largest_number, {0.0f, 0.5f, 1.0f});
	CHECK(wide.at(0.0) == 0.5);
	CHECK(wide.at(largest_number / 2.0) == 0.75);
	CHECK(wide.at(-largest_number) == 0.0);
	CHECK(wide.at(largest_number) == 1.0);

	const double next = std::nextafter(1000.0, 2000.0);
	const CurveTable narrow = table_of(1000.0, next, {0.25f, 0.75f});
	CHECK(narrow.at(1000.0) == 0.25);
	CHECK(narrow.at(next) == 0.75);
	// This position is so near the end that its fraction of the range rounds to 1.
	const CurveTable steep = table_of(-1e10, 1.0, {1.0f, 1e-20f});
	CHECK(steep.at(std::nextafter(1.0, 0.0)) == 1e-20f);
	constexpr double smallest = std::numeric_limits<double>::denorm_min();
	const CurveTable denormal = table_of(0.0, 2.0 * smallest, {0.0f, 1.0f});
	CHECK(denormal.at(smallest) == 0.5);
}

TEST_CASE("curve: errors name the invalid property and leave the curve unchanged") {
	CurveTable table = table_of(1.0, 3.0, {0.25f, 0.75f});
	const CurveTable before = table;
	const std::vector<float> good{0.0f, 1.0f};
	check_refused(table.set(nan_value, 1.0, good), ErrorCode::not_finite, "min", nan_value);
	check_refused(table.set(-infinite_value, 1.0, good), ErrorCode::not_finite, "min", -infinite_value);
	check_refused(table.set(0.0, nan_value, good), ErrorCode::not_finite, "max", nan_value);
	check_refused(table.set(0.0, infinite_value, good), ErrorCode::not_finite, "max", infinite_value);
	check_refused(table.set(2.0, 1.5, good), ErrorCode::inverted, "max", 1.5);
	check_refused(table.set(2.0, 2.0, good), ErrorCode::inverted, "max", 2.0);
	check_refused(table.set(0.0, 1.0, {}), ErrorCode::wrong_size, "samples", 0.0);
	check_refused(table.set(0.0, 1.0, std::array{1.0f}), ErrorCode::wrong_size, "samples", 1.0);
	check_refused(table.set(0.0, 1.0, std::vector<float>(4097)), ErrorCode::wrong_size, "samples", 4097.0);
	check_refused(table.set(0.0, 1.0, std::array{0.0f, -0.5f}), ErrorCode::out_of_range, "samples", -0.5);
	check_refused(table.set(0.0, 1.0, std::array{1.5f, 0.0f}), ErrorCode::out_of_range, "samples", 1.5);
	check_refused(table.set(0.0, 1.0, std::array{0.0f, std::nanf("")}), ErrorCode::not_finite, "samples", nan_value);
	CHECK(table == before);
	CHECK(table.at(2.0) == 0.5);
}

TEST_CASE("curve: curves differ by ends and by samples") {
	const CurveTable table = table_of(0.0, 1.0, {0.0f, 0.5f});
	CHECK(table == table_of(0.0, 1.0, {0.0f, 0.5f}));
	CHECK(table != table_of(0.5, 1.0, {0.0f, 0.5f}));
	CHECK(table != table_of(0.0, 1.5, {0.0f, 0.5f}));
	CHECK(table != table_of(0.0, 1.0, {0.0f, 0.25f}));
	CHECK(table != table_of(0.0, 1.0, {0.0f, 0.5f, 0.5f}));
}
