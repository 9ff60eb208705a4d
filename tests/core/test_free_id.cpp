// Tests the IDs of hand-placed instances, and how many IDs are checked to find a free one.

#include "core/state/free_id.hpp"
#include "state_fixture.hpp"

#include <algorithm>
#include <set>

using namespace thicket;

namespace {

constexpr std::uint64_t prefix = std::uint64_t{0x8001} << 48;

/// The IDs in use, and the number of IDs that were checked.
struct Ids {
	std::set<std::uint64_t> used_ids;
	std::size_t checks = 0;

	std::uint64_t take(std::uint64_t first) {
		const std::uint64_t id = free_id(prefix, first, [this](std::uint64_t any) {
			++checks;
			return used_ids.contains(any);
		});
		CHECK(used_ids.insert(id).second);
		return id;
	}
};

} // namespace

TEST_CASE("free id: equal instances get successive IDs, at a nearly constant cost") {
	Ids ids;
	constexpr std::uint64_t first = 0xfffffffffff0; // The numbers wrap around to 0.
	std::size_t before = 0;
	for (std::uint64_t count = 0; count < 40000; ++count) {
		ids.checks = 0;
		REQUIRE(ids.take(first) == (prefix | ((first + count) & 0xffffffffffff)));
		REQUIRE(ids.checks <= 2 + 2 * 17);
		before = std::max(before, ids.checks);
	}
	CHECK(before > 20); // The search does check more than the next ID.
}

TEST_CASE("free id: gaps are used or skipped, and no ID is returned twice") {
	StateRandom random(51);
	Ids ids;
	for (int i = 0; i < 20000; ++i) {
		ids.checks = 0;
		ids.take(random() % 8);
		REQUIRE(ids.checks < 100);
		if (random() % 3 == 0) {
			const auto any = ids.used_ids.lower_bound(prefix | random() % 7000);
			if (any != ids.used_ids.end()) {
				ids.used_ids.erase(any);
			}
		}
	}
}

TEST_CASE("free id: IDs in use at all doubled distances restart the search elsewhere") {
	Ids ids;
	ids.used_ids.insert(prefix | 5);
	for (std::uint64_t step = 1; step < std::uint64_t{1} << 48; step *= 2) {
		ids.used_ids.insert(prefix | ((5 + step) & 0xffffffffffff));
	}
	ids.take(5);
	CHECK(ids.checks < 100);
	// The ID with all bits set is never used.
	Ids last;
	const std::uint64_t id = free_id(std::uint64_t{0xffff} << 48, 0xffffffffffff, [](std::uint64_t) { return false; });
	CHECK(id == std::uint64_t{0xffff} << 48);
}

TEST_CASE("free id: many equal instances get the same IDs together as one by one") {
	InstanceState one_by_one;
	InstanceState joined_state;
	std::vector<AddedInstance> equal(3000, instance_at(5.0, 7.0));
	for (std::size_t at = 0; at < equal.size(); at += 7) {
		equal[at] = instance_at(static_cast<double>(at), 0.0);
	}
	std::vector<std::uint64_t> expected;
	for (const AddedInstance &instance : equal) {
		expected.push_back(added_to(one_by_one, instance));
	}
	std::vector<std::uint64_t> ids;
	std::vector<InstanceChange> changes;
	REQUIRE(joined_state.add_all(equal, ids, changes).ok());
	CHECK(ids == expected);
	CHECK(std::set<std::uint64_t>(ids.begin(), ids.end()).size() == ids.size());
	// As for every instance without equals, the first ID is the same as in release 0.2.0.
	AddedInstance oak = instance_at(1.5, -2.5, 4);
	oak.mesh = 2;
	oak.basis[0][1] = 0.25f;
	CHECK(added_to(joined_state, oak) == 0x8004cd76691298f4);
	CHECK(added_to(joined_state, oak) == 0x8004cd76691298f5);
}
