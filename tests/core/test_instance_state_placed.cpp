// Tests how a state records hand-placed and moved instances.

#include "state_fixture.hpp"

#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

using namespace thicket;

namespace {

using Changes = std::vector<InstanceChange>;

constexpr double infinite = std::numeric_limits<double>::infinity();

} // namespace

TEST_CASE("state: the ID of a hand-placed instance is a function of the instance") {
	StateRandom random(2);
	InstanceState state;
	std::set<std::uint64_t> ids;
	for (int i = 0; i < 20000; ++i) {
		AddedInstance instance = instance_at(static_cast<double>(random() % 1000), i * 1e-3, 32767);
		instance.mesh = static_cast<std::uint8_t>(i);
		const std::uint64_t id = added_to(state, instance);
		REQUIRE(is_added(id));
		REQUIRE(layer_of(id) == 32767);
		REQUIRE(ids.insert(id).second);
		REQUIRE(*state.added(id) == instance);
	}
	InstanceState peer;
	const AddedInstance oak = instance_at(4.5, -0.0);
	const std::uint64_t id = added_to(state, oak);
	CHECK(added_to(peer, instance_at(4.5, 0.0)) == id);
	CHECK(!std::signbit(peer.added(id)->position.z));
	// An equal instance gets the next free ID. Removing the first one frees its ID.
	CHECK(added_to(peer, oak) == id + 1);
	CHECK(peer.remove(id));
	CHECK_FALSE(peer.remove(id));
	CHECK(peer.added(id) == nullptr);
	CHECK(added_to(peer, oak) == id);
	CHECK(peer.added_ids() == std::vector<std::uint64_t>{id, id + 1});
	CHECK(peer.added_ids(2).empty());
	// The ID must be the same in all versions and on all machines.
	CHECK(id == 0x8001a05597e0f7bb);
}

TEST_CASE("state: many instances are placed as they would be one by one, or none of them") {
	std::vector<AddedInstance> all;
	for (int i = 0; i < 3000; ++i) {
		all.push_back(instance_at(
				// Many instances are equal, so their IDs are successive.
				i % 700, -0.0, static_cast<std::uint16_t>(i % 3)));
	}
	InstanceState one_by_one;
	std::vector<std::uint64_t> expected;
	expected.push_back(added_to(one_by_one, all[0]));
	InstanceState state;
	added_to(state, all[0]);
	for (const AddedInstance &instance : all) {
		expected.push_back(added_to(one_by_one, instance));
	}
	std::vector<std::uint64_t> ids;
	std::vector<InstanceChange> changes;
	REQUIRE(state.add_all(all, ids, changes).ok());
	CHECK(ids == std::vector<std::uint64_t>(expected.begin() + 1, expected.end()));
	CHECK(state.digest() == one_by_one.digest());
	REQUIRE(changes.size() == all.size());
	for (std::size_t i = 0; i < all.size(); ++i) {
		REQUIRE(changes[i].id == ids[i]);
		REQUIRE(changes[i].kind == InstanceChangeKind::added);
		REQUIRE(changes[i].added == all[i]);
	}
	const std::uint64_t before = state.digest();
	const std::uint64_t revision = state.revision();
	all[17].position.y = std::nan("");
	changes.clear();
	const Status status = state.add_all(all, ids, changes);
	CHECK(status.code == ErrorCode::not_finite);
	CHECK(ids.size() == 17);
	CHECK(changes.empty());
	CHECK(state.digest() == before);
	CHECK(state.revision() == revision);
	REQUIRE(state.add_all({}, ids, changes).ok());
	CHECK(ids.empty());
}

TEST_CASE("state: the error for an invalid hand-placed instance names the property") {
	InstanceState state;
	const auto check_rejected = [&state](const AddedInstance &instance, const char *property, ErrorCode code) {
		std::uint64_t id = 5;
		const Status status = state.add(instance, id);
		CHECK(status.code == code);
		CHECK(std::string(status.property) == property);
		CHECK(id == 5);
	};
	check_rejected(instance_at(0.0, 0.0, 32768), "layer", ErrorCode::out_of_range);
	check_rejected(instance_at(std::nan(""), 0.0), "position", ErrorCode::not_finite);
	check_rejected(instance_at(0.0, 1.1e9), "position", ErrorCode::out_of_range);
	AddedInstance invalid_basis;
	invalid_basis.basis[2][1] = std::numeric_limits<float>::infinity();
	check_rejected(invalid_basis, "basis", ErrorCode::not_finite);
	CHECK(state.revision() == 0);
	CHECK(state.added_count() == 0);
}

TEST_CASE("state: hand-placed instances are found at their positions") {
	StateRandom random(3);
	std::uniform_real_distribution<double> coordinate(-500.0, 500.0);
	InstanceState state;
	std::map<std::uint64_t, AddedInstance> expected;
	for (int i = 0; i < 3000; ++i) {
		AddedInstance instance =
				instance_at(std::floor(coordinate(random)), coordinate(random), static_cast<std::uint16_t>(i % 2));
		if (i % 100 == 0) {
			instance.position.x = i % 200 == 0 ? 1e9 : -1e9;
		}
		expected[added_to(state, instance)] = instance;
	}
	for (int i = 0; i < 1500; ++i) {
		const auto removed = std::next(expected.begin(), static_cast<std::ptrdiff_t>(random() % expected.size()));
		REQUIRE(state.remove(removed->first));
		expected.erase(removed);
	}
	std::vector<Rect> rects{{{-infinite, -infinite}, {infinite, infinite}}, {{-1e9, -1e9}, {1e9, 1e9}},
			{{5.0, 5.0}, {5.0, 9.0}}, {{5.0, 5.0}, {1.0, 9.0}}, {{std::nan(""), 5.0}, {1.0, 9.0}},
			{{9e8, -infinite}, {infinite, 0.0}}};
	for (int i = 0; i < 300; ++i) {
		const glm::dvec2 corner(std::floor(coordinate(random)), coordinate(random));
		rects.push_back({corner, corner + glm::dvec2(std::floor(coordinate(random) + 500.0), 100.0)});
	}
	for (const Rect &rect : rects) {
		for (std::uint16_t layer = 0; layer < 3; ++layer) {
			std::vector<std::uint64_t> ids{42};
			REQUIRE(state.added_in(layer, rect, ids).ok());
			std::vector<std::uint64_t> scan{42};
			for (const auto &[id, instance] : expected) {
				if (instance.layer == layer && rect.contains({instance.position.x, instance.position.z})) {
					scan.push_back(id);
				}
			}
			REQUIRE(ids == scan);
		}
	}
}

TEST_CASE("state: the largest scale of the hand-placed instances is known") {
	InstanceState state;
	CHECK(state.max_added_scale(1) == 0.0);
	AddedInstance large = instance_at(0.0, 0.0);
	large.basis[1] = {0.0f, 3.0f, 4.0f};
	const std::uint64_t id = added_to(state, large);
	added_to(state, instance_at(1.0, 0.0, 2));
	CHECK(state.max_added_scale(1) == 5.0);
	CHECK(state.max_added_scale(2) == 1.0);
	CHECK(copy_of(state).max_added_scale(1) == 5.0);
	state.remove(id);
	CHECK(state.max_added_scale(1) == 0.0);
}

TEST_CASE("state: hand-placed instances belong to any set of points") {
	InstanceState state;
	REQUIRE(state.claim(1, 10).ok());
	const std::uint64_t added_id = added_to(state, instance_at(1.0, 2.0));
	REQUIRE(state.set_data(added_id, StateBytes{1}).ok());
	CHECK_FALSE(state.is_foreign(1, 20));
	CHECK(state.claim(1, 20).ok());
	CHECK(state.stamp(1) == 20);

	// A state of a different point set can be merged if it contains only hand-placed instances. The
	// data of a point make it foreign.
	InstanceState other;
	REQUIRE(other.claim(1, 30).ok());
	const std::uint64_t foreign_id = added_to(other, instance_at(5.0, 6.0));
	Changes changes;
	CHECK(state.merge(other, changes).ok());
	CHECK(state.apply(diff_of(other, 0), changes).ok());
	CHECK(state.added(foreign_id) != nullptr);
	CHECK(state.stamp(1) == 20);
	for (const std::uint64_t point : {point_id(1, 0, 0), point_id(1, 3, 3)}) {
		REQUIRE(other.set_data(point, StateBytes{1}).ok());
		CHECK(other.is_foreign(1, 20));
		CHECK(state.apply(bytes_of(other), changes).code == ErrorCode::foreign);
		CHECK(other.claim(1, 20).code == ErrorCode::foreign);
		REQUIRE(other.set_data(point, {}).ok());
		CHECK(other.claim(1, 30).ok());
	}
}

TEST_CASE("state: a hand-placed instance that moves keeps its ID and its data") {
	InstanceState state;
	const std::uint64_t added_id = added_to(state, instance_at(1.0, 2.0));
	REQUIRE(state.set_data(added_id, StateBytes{7}).ok());
	AddedInstance target = instance_at(700.0, -900.0);
	target.basis[2][0] = -0.3f;
	std::uint64_t id = 0;
	Changes changes;
	REQUIRE(state.move(added_id, target, id, changes).ok());
	CHECK(id == added_id);
	CHECK(*state.added(added_id) == target);
	CHECK(state.data(added_id).size() == 1);
	REQUIRE(changes.size() == 2);
	CHECK(changes[0].kind == InstanceChangeKind::left);
	CHECK(changes[0].added == instance_at(1.0, 2.0));
	CHECK(changes[1].kind == InstanceChangeKind::moved);
	CHECK(changes[1].added == target);
	std::vector<std::uint64_t> ids;
	REQUIRE(state.added_in(1, {{0.0, 0.0}, {10.0, 10.0}}, ids).ok());
	CHECK(ids.empty());
	REQUIRE(state.added_in(1, {{690.0, -910.0}, {710.0, -890.0}}, ids).ok());
	CHECK(ids == std::vector<std::uint64_t>{added_id});
	// An instance placed at the old position gets a different ID. Moving an instance to its current
	// position has no effect.
	CHECK(added_to(state, instance_at(1.0, 2.0)) != added_id);
	const std::uint64_t revision = state.revision();
	changes.clear();
	REQUIRE(state.move(added_id, target, id, changes).ok());
	CHECK(changes.empty());
	CHECK(state.revision() == revision);
}

TEST_CASE("state: a moved point is removed and replaced by a hand-placed instance") {
	InstanceState state;
	const std::uint64_t point = point_id(1, 4, 5);
	REQUIRE(state.set_data(point, StateBytes{7, 8}).ok());
	std::uint64_t id = 0;
	Changes changes;
	REQUIRE(state.move(point, instance_at(9.0, 9.0), id, changes).ok());
	CHECK(is_added(id));
	CHECK(layer_of(id) == 1);
	CHECK(state.removed(point));
	CHECK(state.data(point).empty());
	CHECK(state.data(id).size() == 2);
	CHECK(*state.added(id) == instance_at(9.0, 9.0));

	const StateBytes before = bytes_of(state);
	changes.clear();
	std::uint64_t untouched = 5;
	CHECK(state.move(point, instance_at(1.0, 1.0), untouched, changes).code == ErrorCode::missing);
	CHECK(state.move(id, instance_at(1.0, 1.0, 2), untouched, changes).code == ErrorCode::missing);
	CHECK(state.move(id + 1, instance_at(1.0, 1.0), untouched, changes).code == ErrorCode::missing);
	AddedInstance invalid_position = instance_at(1.0, 1.0);
	invalid_position.position.y = std::numeric_limits<double>::infinity();
	CHECK_FALSE(state.move(id, invalid_position, untouched, changes).ok());
	CHECK(changes.empty());
	CHECK(untouched == 5);
	CHECK(bytes_of(state) == before);
}
