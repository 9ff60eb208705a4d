// Tests that the tables of a state share memory and copy it on write.

#include "core/state/id_table.hpp"

#include <doctest/doctest.h>

#include <map>
#include <memory>
#include <random>

using namespace thicket;

namespace {

using Table = IdTable<double>;
using Expected = std::map<std::uint64_t, double>;

Expected content_of(const Table &table) {
	Expected content;
	table.for_each([&content](std::uint64_t id, double time) { CHECK(content.emplace(id, time).second); });
	CHECK(content.size() == table.size());
	return content;
}

void change(Table &r_table, Expected &r_expected, std::mt19937_64 &random, int times) {
	for (int i = 0; i < times; ++i) {
		const std::uint64_t id = random() % 3000;
		if (random() % 3 == 0) {
			CHECK(r_table.erase(id) == (r_expected.erase(id) > 0));
		} else {
			const double time = random() % 4 == 0 ? static_cast<double>(random() % 100) : 0.0;
			CHECK(r_table.insert(id, time) == !r_expected.contains(id));
			r_expected[id] = time;
		}
		CHECK(r_table.value(id) == (r_expected.contains(id) ? r_expected.at(id) : 0.0));
		CHECK(r_table.contains(id) == r_expected.contains(id));
	}
}

} // namespace

TEST_CASE("id table: tables that share their memory are not affected by each other's changes") {
	std::mt19937_64 random(1);
	Table table;
	Expected expected;
	change(table, expected, random, 5000);
	Table other = table.share();
	Expected expected_other = expected;
	CHECK(content_of(other) == expected);
	change(table, expected, random, 2000);
	CHECK(content_of(other) == expected_other);
	change(other, expected_other, random, 2000);
	Table third = other.share();
	const Expected expected_third = expected_other;
	change(other, expected_other, random, 2000);
	other.shrink();
	CHECK(content_of(table) == expected);
	CHECK(content_of(other) == expected_other);
	CHECK(content_of(third) == expected_third);
	table = Table();
	CHECK(content_of(other) == expected_other);
	std::size_t timed = 0;
	for (const auto &[id, time] : expected_other) {
		timed += time != 0.0 ? 1 : 0;
	}
	CHECK(other.valued() == timed);
}

TEST_CASE("id table: a table frees memory") {
	IdTable<std::shared_ptr<const int>> table;
	const auto value = std::make_shared<const int>(3);
	for (std::uint64_t id = 0; id < 20000; ++id) {
		table.insert(id, value);
	}
	CHECK(value.use_count() == 20001);
	for (std::uint64_t id = 0; id < 19990; ++id) {
		table.erase(id);
		table.shrink();
	}
	CHECK(value.use_count() == 11);
	CHECK(table.size() == 10);
	for (std::uint64_t id = 19990; id < 20000; ++id) {
		CHECK(table.value(id) == value);
	}
}
