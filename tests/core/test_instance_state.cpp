// What a state remembers of the world's changes.

#include "state_fixture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>

using namespace thicket;

namespace {

using Changes = std::vector<InstanceChange>;

constexpr double infinite = std::numeric_limits<double>::infinity();

std::uint64_t added_to(InstanceState &r_state, const AddedInstance &instance) {
	std::uint64_t id = 0;
	REQUIRE(r_state.add(instance, id).ok());
	return id;
}

Changes advanced(InstanceState &r_state, double seconds) {
	Changes changes;
	REQUIRE(r_state.advance(seconds, changes).ok());
	return changes;
}

StateBytes data_of(const InstanceState &state, std::uint64_t id) {
	const auto bytes = state.data(id);
	return {bytes.begin(), bytes.end()};
}

} // namespace

TEST_CASE("state: what is removed is removed until it is restored") {
	InstanceState state;
	const std::uint64_t id = point_id(7, -3, 12);
	CHECK_FALSE(state.removed(id));
	CHECK_FALSE(state.restore(id));
	CHECK(state.revision() == 0);
	CHECK(state.remove(id));
	CHECK(state.removed(id));
	CHECK_FALSE(state.remove(id));
	CHECK(state.revision() == 1);
	CHECK_FALSE(state.removed(point_id(7, -3, 13)));
	CHECK_FALSE(state.removed(point_id(8, -3, 12)));
	CHECK(state.any_removed(7));
	CHECK_FALSE(state.any_removed(8));
	CHECK(state.restore(id));
	CHECK_FALSE(state.removed(id));
	CHECK_FALSE(state.any_removed(7));
	CHECK(state.revision() == 2);
	CHECK_FALSE(state.remove(std::uint64_t{1} << 63));
	CHECK(state.removed_count() == 0);
}

TEST_CASE("state: the set of removed ids is what a plain set would be") {
	StateRandom random(1);
	InstanceState state;
	std::set<std::uint64_t> expected;
	for (int round = 0; round < 60000; ++round) {
		// Grows, then shrinks, then starts again.
		const bool grow = round / 20000 % 2 == 0 ? random() % 4 != 0 : random() % 4 == 0;
		const std::uint64_t id = point_id(static_cast<std::uint16_t>(random() % 2), static_cast<int>(random() % 100),
				static_cast<int>(random() % 100));
		REQUIRE(state.removed(id) == expected.contains(id));
		REQUIRE((
				grow ? state.remove(id) == expected.insert(id).second : state.restore(id) == (expected.erase(id) > 0)));
	}
	CHECK(state.removed_count() == expected.size());
	CHECK(state.removed_ids() == std::vector<std::uint64_t>(expected.begin(), expected.end()));
	const auto first_of_1 = expected.lower_bound(std::uint64_t{1} << 48);
	CHECK(state.removed_ids(0) == std::vector<std::uint64_t>(expected.begin(), first_of_1));
	CHECK(state.removed_ids(1) == std::vector<std::uint64_t>(first_of_1, expected.end()));
	CHECK(state.removed_ids(2).empty());
}

TEST_CASE("state: the id of a hand-placed instance is a function of the instance") {
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
	// The same again takes the next free id; once the first is gone, its id is free.
	CHECK(added_to(peer, oak) == id + 1);
	CHECK(peer.remove(id));
	CHECK_FALSE(peer.remove(id));
	CHECK(peer.added(id) == nullptr);
	CHECK(added_to(peer, oak) == id);
	CHECK(peer.added_ids() == std::vector<std::uint64_t>{id, id + 1});
	CHECK(peer.added_ids(2).empty());
	// Peers of all versions and machines agree.
	CHECK(id == 0x8001a05597e0f7bb);
}

TEST_CASE("state: many instances are placed as they would be one by one, or not at all") {
	std::vector<AddedInstance> all;
	for (int i = 0; i < 3000; ++i) {
		all.push_back(instance_at(
				i % 700, -0.0, static_cast<std::uint16_t>(i % 3))); // Many alike: their ids follow one another.
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
	const Status refused = state.add_all(all, ids, changes);
	CHECK(refused.code == ErrorCode::not_finite);
	CHECK(ids.size() == 17);
	CHECK(changes.empty());
	CHECK(state.digest() == before);
	CHECK(state.revision() == revision);
	REQUIRE(state.add_all({}, ids, changes).ok());
	CHECK(ids.empty());
}

TEST_CASE("state: a hand-placed instance that cannot be is refused by its property") {
	InstanceState state;
	const auto refused = [&state](const AddedInstance &instance, const char *property, ErrorCode code) {
		std::uint64_t id = 5;
		const Status status = state.add(instance, id);
		CHECK(status.code == code);
		CHECK(std::string(status.property) == property);
		CHECK(id == 5);
	};
	refused(instance_at(0.0, 0.0, 32768), "layer", ErrorCode::out_of_range);
	refused(instance_at(std::nan(""), 0.0), "position", ErrorCode::not_finite);
	refused(instance_at(0.0, 1.1e9), "position", ErrorCode::out_of_range);
	AddedInstance bent;
	bent.basis[2][1] = std::numeric_limits<float>::infinity();
	refused(bent, "basis", ErrorCode::not_finite);
	CHECK(state.revision() == 0);
	CHECK(state.added_count() == 0);
}

TEST_CASE("state: hand-placed instances are found where they stand") {
	StateRandom random(3);
	std::uniform_real_distribution<double> place(-500.0, 500.0);
	InstanceState state;
	std::map<std::uint64_t, AddedInstance> expected;
	for (int i = 0; i < 3000; ++i) {
		AddedInstance instance =
				instance_at(std::floor(place(random)), place(random), static_cast<std::uint16_t>(i % 2));
		if (i % 100 == 0) {
			instance.position.x = i % 200 == 0 ? 1e9 : -1e9;
		}
		expected[added_to(state, instance)] = instance;
	}
	for (int i = 0; i < 1500; ++i) {
		const auto gone = std::next(expected.begin(), static_cast<std::ptrdiff_t>(random() % expected.size()));
		REQUIRE(state.remove(gone->first));
		expected.erase(gone);
	}
	std::vector<Rect> rects{{{-infinite, -infinite}, {infinite, infinite}}, {{-1e9, -1e9}, {1e9, 1e9}},
			{{5.0, 5.0}, {5.0, 9.0}}, {{5.0, 5.0}, {1.0, 9.0}}, {{std::nan(""), 5.0}, {1.0, 9.0}},
			{{9e8, -infinite}, {infinite, 0.0}}};
	for (int i = 0; i < 300; ++i) {
		const glm::dvec2 corner(std::floor(place(random)), place(random));
		rects.push_back({corner, corner + glm::dvec2(std::floor(place(random) + 500.0), 100.0)});
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

TEST_CASE("state: the largest scale of what stands is known") {
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

TEST_CASE("state: data belong to an instance, removed or not, and go with a hand-placed one") {
	InstanceState state;
	const std::uint64_t point = point_id(1, 5, 5);
	const std::uint64_t placed = added_to(state, instance_at(1.0, 1.0));
	const StateBytes apples{3, 1, 4};
	REQUIRE(state.set_data(point, apples).ok());
	REQUIRE(state.set_data(placed, apples).ok());
	CHECK(data_of(state, point) == apples);
	CHECK(state.data_ids() == std::vector<std::uint64_t>{point, placed});
	Changes changes;
	REQUIRE(InstanceState().load(bytes_of(state), changes).ok());
	REQUIRE(changes.size() == 3);
	for (const InstanceChange &change : changes) { // Where it stands is told of a hand-placed one.
		CHECK(change.added == (change.id == placed ? *state.added(placed) : AddedInstance()));
	}
	const std::uint64_t revision = state.revision();
	REQUIRE(state.set_data(point, apples).ok());
	CHECK(state.revision() == revision);
	state.remove(point);
	state.remove(placed);
	CHECK(data_of(state, point) == apples);
	CHECK(state.data(placed).empty());
	CHECK(state.data_count() == 1);
	CHECK(state.set_data(placed, apples).code == ErrorCode::missing);
	CHECK(state.set_data(point, StateBytes(max_instance_data + 1)).code == ErrorCode::wrong_size);
	CHECK(data_of(state, point) == apples);
	REQUIRE(state.set_data(point, StateBytes(max_instance_data)).ok());
	REQUIRE(state.set_data(point, {}).ok());
	CHECK(state.data_count() == 0);
}

TEST_CASE("state: what is removed for a time stands again when its time has come") {
	InstanceState state;
	const std::uint64_t oak = point_id(1, 0, 0);
	const std::uint64_t fern = point_id(2, 0, 0);
	const std::uint64_t rock = point_id(3, 0, 0);
	state.remove(oak, 10.0);
	state.remove(fern, 5.0);
	state.remove(rock);
	REQUIRE(state.set_data(fern, StateBytes{1}).ok());
	CHECK(advanced(state, 4.5).empty());
	for (const double nothing : {0.0, -3.0, std::nan("")}) {
		CHECK(advanced(state, nothing).empty());
	}
	CHECK(state.time() == 4.5);
	// What is cut again grows later.
	const std::uint64_t revision = state.revision();
	CHECK_FALSE(state.remove(oak, 20.0));
	CHECK(state.revision() > revision);
	const Changes first = advanced(state, 10.5);
	REQUIRE(first.size() == 1);
	CHECK(first[0].id == fern);
	CHECK(first[0].kind == InstanceChangeKind::restored);
	CHECK(state.data(fern).size() == 1);
	CHECK(state.removed(oak));
	InstanceState loaded = copy_of(state);
	CHECK(loaded.time() == 15.0);
	for (InstanceState *one : {&state, &loaded}) {
		CHECK(advanced(*one, 5.0).size() == 1);
		CHECK_FALSE(one->removed(oak));
		CHECK(one->removed(rock));
		CHECK(advanced(*one, infinite).empty());
		CHECK(one->time() == max_state_time);
	}
}

TEST_CASE("state: a wood that is cut again and again grows in the order of its times") {
	StateRandom random(4);
	InstanceState state;
	std::map<std::uint64_t, double> until;
	for (int round = 0; round < 400; ++round) {
		for (int i = 0; i < 50; ++i) {
			const std::uint64_t id = point_id(1, static_cast<int>(random() % 40), 0);
			const double time = random() % 5 == 0 ? 0.0 : state.time() + 1.0 + static_cast<double>(random() % 30);
			if (random() % 4 == 0) {
				state.restore(id);
				until.erase(id);
			} else {
				state.remove(id, time);
				until[id] = time;
			}
		}
		std::set<std::uint64_t> due;
		for (const auto &[id, time] : until) {
			if (time > 0.0 && time <= state.time() + 1.0) {
				due.insert(id);
			}
		}
		const Changes changes = advanced(state, 1.0);
		REQUIRE(changes.size() == due.size());
		for (const InstanceChange &change : changes) {
			REQUIRE(due.contains(change.id));
			until.erase(change.id);
		}
		REQUIRE(state.removed_count() == until.size());
	}
}

TEST_CASE("state: clearing tells of everything, and what it was is not remembered") {
	InstanceState state;
	REQUIRE(state.claim(1, 77).ok());
	state.remove(point_id(1, 2, 3));
	const std::uint64_t placed = added_to(state, instance_at(1.0, 2.0));
	REQUIRE(state.set_data(point_id(2, 0, 0), StateBytes{1}).ok());
	REQUIRE(state.set_data(placed, StateBytes{2}).ok());
	const std::uint64_t revision = state.revision();
	Changes changes = advanced(state, 3.0);
	REQUIRE(state.clear(changes).ok());
	REQUIRE(changes.size() == 3);
	CHECK(changes[0].kind == InstanceChangeKind::restored);
	CHECK(changes[1].kind == InstanceChangeKind::data);
	CHECK(changes[2].kind == InstanceChangeKind::removed);
	CHECK(changes[2].added == instance_at(1.0, 2.0));
	CHECK(state.digest() == InstanceState().digest());
	CHECK(bytes_of(state) == bytes_of(InstanceState()));
	CHECK(state.revision() > revision);
	CHECK(state.stamp(1) == 77);
	CHECK(diff_of(state, revision) == bytes_of(state));
}

TEST_CASE("state: layers keep to their point sets") {
	const PointSet oaks{.seed = 5, .radius = 4.0, .levels = 2, .layer = 1};
	CHECK(stamp_of(oaks) == stamp_of({.seed = 5, .radius = 4.0, .levels = 2, .layer = 9}));
	CHECK(stamp_of(oaks) != stamp_of({.seed = 6, .radius = 4.0, .levels = 2}));
	CHECK(stamp_of(oaks) != stamp_of({.seed = 5, .radius = 4.5, .levels = 2}));
	CHECK(stamp_of(oaks) != stamp_of({.seed = 5, .radius = 4.0, .levels = 3}));

	InstanceState state;
	REQUIRE(state.claim(1, 10).ok());
	REQUIRE(state.claim(1, 20).ok()); // Nothing was held yet.
	state.remove(point_id(1, 0, 0));
	CHECK(state.claim(1, 20).ok());
	const Status status = state.claim(1, 30);
	CHECK(status.code == ErrorCode::foreign);
	CHECK(describe(status).starts_with("layer was made for another"));
	CHECK(state.claim(32768, 1).code == ErrorCode::out_of_range);
	CHECK(state.stamp(1) == 20);
	CHECK(copy_of(state).stamp(1) == 20);

	InstanceState foreign;
	REQUIRE(foreign.claim(1, 30).ok());
	foreign.remove(point_id(1, 4, 4));
	Changes changes;
	const StateBytes before = bytes_of(state);
	CHECK(state.load(bytes_of(foreign), changes).code == ErrorCode::foreign);
	CHECK(state.apply(diff_of(foreign, 0), changes).code == ErrorCode::foreign);
	CHECK(state.merge(foreign, changes).code == ErrorCode::foreign);
	CHECK(changes.empty());
	CHECK(bytes_of(state) == before);
	// Without a world, a state takes in any other, but mixes no two.
	state.release_claims();
	CHECK(state.merge(foreign, changes).code == ErrorCode::foreign);
	CHECK(state.load(bytes_of(foreign), changes).ok());
	CHECK(state.stamp(1) == 30);
	CHECK(state.removed_ids() == foreign.removed_ids());
	// One that knows of no points leaves none.
	InstanceState unknown;
	unknown.remove(point_id(1, 0, 0));
	CHECK(state.load(bytes_of(unknown), changes).ok());
	CHECK(bytes_of(state) == bytes_of(unknown));
}

TEST_CASE("state: what is placed by hand stands in any set of points") {
	InstanceState state;
	REQUIRE(state.claim(1, 10).ok());
	const std::uint64_t placed = added_to(state, instance_at(1.0, 2.0));
	REQUIRE(state.set_data(placed, StateBytes{1}).ok());
	CHECK_FALSE(state.is_foreign(1, 20));
	CHECK(state.claim(1, 20).ok());
	CHECK(state.stamp(1) == 20);

	// Points of another set bring hand-placed ones of theirs along, and what is placed alone goes anywhere.
	InstanceState other;
	REQUIRE(other.claim(1, 30).ok());
	const std::uint64_t elsewhere = added_to(other, instance_at(5.0, 6.0));
	Changes changes;
	CHECK(state.merge(other, changes).ok());
	CHECK(state.apply(diff_of(other, 0), changes).ok());
	CHECK(state.added(elsewhere) != nullptr);
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

TEST_CASE("state: a hand-placed instance that moves keeps its id and its data") {
	InstanceState state;
	const std::uint64_t placed = added_to(state, instance_at(1.0, 2.0));
	REQUIRE(state.set_data(placed, StateBytes{7}).ok());
	AddedInstance to = instance_at(700.0, -900.0);
	to.basis[2][0] = -0.3f;
	std::uint64_t id = 0;
	Changes changes;
	REQUIRE(state.move(placed, to, id, changes).ok());
	CHECK(id == placed);
	CHECK(*state.added(placed) == to);
	CHECK(state.data(placed).size() == 1);
	REQUIRE(changes.size() == 2);
	CHECK(changes[0].kind == InstanceChangeKind::left);
	CHECK(changes[0].added == instance_at(1.0, 2.0));
	CHECK(changes[1].kind == InstanceChangeKind::moved);
	CHECK(changes[1].added == to);
	std::vector<std::uint64_t> found;
	REQUIRE(state.added_in(1, {{0.0, 0.0}, {10.0, 10.0}}, found).ok());
	CHECK(found.empty());
	REQUIRE(state.added_in(1, {{690.0, -910.0}, {710.0, -890.0}}, found).ok());
	CHECK(found == std::vector<std::uint64_t>{placed});
	// One that is placed where it stood gets another id, and moving to where it stands changes nothing.
	CHECK(added_to(state, instance_at(1.0, 2.0)) != placed);
	const std::uint64_t revision = state.revision();
	changes.clear();
	REQUIRE(state.move(placed, to, id, changes).ok());
	CHECK(changes.empty());
	CHECK(state.revision() == revision);
}

TEST_CASE("state: a point that moves is removed, and a hand-placed one is there for it") {
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
	AddedInstance nowhere = instance_at(1.0, 1.0);
	nowhere.position.y = std::numeric_limits<double>::infinity();
	CHECK_FALSE(state.move(id, nowhere, untouched, changes).ok());
	CHECK(changes.empty());
	CHECK(untouched == 5);
	CHECK(bytes_of(state) == before);
}

TEST_CASE("state: a diff of ids takes back whatever was done to them, to the bit") {
	StateRandom random(11);
	for (int trial = 0; trial < 300; ++trial) {
		InstanceState state;
		disturb(state, random, 20);
		REQUIRE(state.claim(1, 7).ok());
		const StateBytes before = bytes_of(state);
		std::vector<std::uint64_t> ids = state.added_ids();
		const std::vector<std::uint64_t> removed = state.removed_ids();
		ids.insert(ids.end(), removed.begin(), removed.end());
		ids.insert(ids.end(), 2, point_id(1, 50, 50));
		ids.push_back(~std::uint64_t{0});
		StateBytes diff;
		REQUIRE(state.diff_of(ids, diff).ok());
		Changes changes;
		std::uint64_t id = 0;
		REQUIRE(state.set_data(point_id(1, 50, 50), StateBytes{3}).ok());
		for (const std::uint64_t one : ids) {
			if (random() % 2 != 0) {
				state.remove(one);
				state.restore(one);
			} else if (is_added(one)) {
				static_cast<void>(state.move(one, instance_at(1e4, 1e4, layer_of(one)), id, changes));
			}
		}
		REQUIRE(state.apply(diff, changes).ok());
		REQUIRE(bytes_of(state) == before);
	}
}
