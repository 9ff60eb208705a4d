// Tests the serialized form of a state: valid bytes load, all others are rejected, and the size is
// small.

#include "core/state/id_codec.hpp"
#include "core/state/id_table.hpp"
#include "core/state/state_format.hpp"
#include "state_fixture.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

using namespace thicket;

namespace {

/// Returns a small state that contains every kind of change.
InstanceState small_state() {
	InstanceState state;
	REQUIRE(state.claim(1, 0x1234567890abcdef).ok());
	std::vector<InstanceChange> changes;
	REQUIRE(state.advance(2.5, changes).ok());
	for (int x = -2; x < 3; ++x) {
		state.remove(point_id(1, x, 4));
	}
	state.remove(point_id(2, 8000000, -8000000), 100.0);
	REQUIRE(state.set_data(point_id(1, 0, 4), StateBytes{1, 2}).ok());
	REQUIRE(state.set_data(point_id(3, 0, 0), StateBytes{3}).ok());
	std::uint64_t id = 0;
	REQUIRE(state.add(instance_at(1.5, -2.5, 4), id).ok());
	REQUIRE(state.set_data(id, StateBytes{4, 5, 6}).ok());
	return state;
}

Status load_into_copy(const InstanceState &state, const StateBytes &bytes, StateBytes &r_after) {
	InstanceState copy = copy_of(state);
	std::vector<InstanceChange> changes;
	const Status status = copy.load(bytes, changes);
	r_after = bytes_of(copy);
	return status;
}

/// Checks that the bytes are rejected as corrupt or as another version, and that the state does
/// not change.
void check_refused_bytes(const StateBytes &bytes) {
	static const InstanceState before = small_state();
	StateBytes after;
	const Status status = load_into_copy(before, bytes, after);
	REQUIRE((status.code == ErrorCode::corrupt || std::string(status.property) == "version"));
	REQUIRE(after == bytes_of(before));
}

/// Checks that the bytes either load, and are then saved identically, or are rejected without
/// changing the state.
void check_any_bytes(const StateBytes &bytes) {
	static const InstanceState before = small_state();
	StateBytes after;
	const bool is_loaded = load_into_copy(before, bytes, after).ok();
	REQUIRE(after == (is_loaded ? bytes : bytes_of(before)));
}

std::size_t bytes_of_removals(const std::vector<std::uint64_t> &ids) {
	InstanceState state;
	for (const std::uint64_t id : ids) {
		state.remove(id);
	}
	const StateBytes bytes = bytes_of(state);
	CHECK(copy_of(state).removed_ids() == state.removed_ids());
	return bytes.size();
}

} // namespace

TEST_CASE("state bytes: a loaded state is equal, and so are its bytes") {
	StateRandom random(11);
	for (int round = 0; round < 300; ++round) {
		InstanceState state;
		REQUIRE(state.claim(0, 5).ok());
		change_at_random(state, random, static_cast<int>(random() % 200));
		InstanceState other;
		change_at_random(other, random, 20);
		other.release_claims();
		std::vector<InstanceChange> changes;
		const StateBytes bytes = bytes_of(state);
		const std::uint64_t revision = other.revision();
		REQUIRE(other.load(bytes, changes).ok());
		REQUIRE(bytes_of(other) == bytes);
		REQUIRE(other.digest() == state.digest());
		REQUIRE(other.time() == state.time());
		REQUIRE(other.revision() > revision);
		REQUIRE(other.removed_ids() == state.removed_ids());
		REQUIRE(other.added_ids() == state.added_ids());
		REQUIRE(other.data_ids() == state.data_ids());
		for (const std::uint64_t id : state.data_ids()) {
			REQUIRE(std::ranges::equal(other.data(id), state.data(id)));
		}
		for (const std::uint64_t id : state.added_ids()) {
			REQUIRE(*other.added(id) == *state.added(id));
		}
	}
}

TEST_CASE("state bytes: equal content has equal bytes, regardless of its history") {
	InstanceState original;
	InstanceState restored;
	for (int i = 0; i < 1000; ++i) {
		original.remove(point_id(2, i, i * i));
		restored.remove(point_id(2, 999 - i, (999 - i) * (999 - i)));
		restored.remove(point_id(3, i, 0));
	}
	CHECK(original.digest() != restored.digest());
	for (int i = 0; i < 1000; ++i) {
		restored.restore(point_id(3, i, 0));
	}
	CHECK(bytes_of(original) == bytes_of(restored));
	CHECK(original.digest() == restored.digest());
}

TEST_CASE("state bytes: the format is unchanged") {
	InstanceState state;
	REQUIRE(state.claim(1, 0x0807060504030201).ok());
	CHECK(bytes_of(state).size() == 4 + 4 + 1 + 8 + 1 + 6 + 8);
	state.remove(point_id(1, -cell_limit, -cell_limit + 1));                             // Code 1 of layer 1.
	state.remove(point_id(1, -cell_limit + 1, -cell_limit), 2.0);                        // Code 2.
	const StateBytes expected{'T', 'S', 'T', 'A', 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, // Header.
			1, 1, 1, 2, 3, 4, 5, 6, 7, 8,                                                // One layer.
			2, 1, 0, 0, 0, 0,                                                            // The sizes of the lists.
			0xee, 11, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, // Two removals: Rice parameter 46, gaps 2^48 + 1 and 0.
			0x40, 0, 0, 0, 0, 0, 0, 0, 0x40,           // The second one regrows at 2 seconds.
			0, 0, 0, 0, 0, 0, 0, 0};
	CHECK(bytes_of(state) == with_checksum(expected));
	CHECK(bytes_of(small_state()).size() < 260);
}

TEST_CASE("state bytes: every damaged byte, every truncation and every extra byte is rejected") {
	const StateBytes complete = bytes_of(small_state());
	for (std::size_t at = 0; at < complete.size(); ++at) {
		for (int value = 0; value < 256; ++value) {
			if (value != complete[at]) {
				StateBytes bytes = complete;
				bytes[at] = static_cast<std::uint8_t>(value);
				check_refused_bytes(bytes);
			}
		}
		check_refused_bytes(StateBytes(complete.begin(), complete.begin() + static_cast<std::ptrdiff_t>(at)));
	}
	StateBytes longer = complete;
	longer.push_back(0);
	check_refused_bytes(longer);
	InstanceState state = small_state();
	check_refused_bytes(diff_of(state, 3));
	InstanceState other;
	std::vector<InstanceChange> changes;
	StateBytes bytes = complete;
	bytes[4] = 3;
	CHECK(describe(other.load(bytes, changes)).starts_with("version must be between 1 and 2, got 3"));
}

TEST_CASE("state bytes: damaged bytes with a valid checksum are rejected, or loaded and written back") {
	const StateBytes complete = bytes_of(small_state());
	for (std::size_t at = 0; at < complete.size() - 8; ++at) {
		for (int value = 0; value < 256; ++value) {
			StateBytes bytes = complete;
			bytes[at] = static_cast<std::uint8_t>(value);
			check_any_bytes(with_checksum(bytes));
		}
		check_any_bytes(
				with_checksum(StateBytes(complete.begin(), complete.begin() + static_cast<std::ptrdiff_t>(at) + 8)));
	}
	StateRandom random(12);
	InstanceState large;
	change_at_random(large, random, 4000);
	const StateBytes large_bytes = bytes_of(large);
	for (int round = 0; round < 300; ++round) {
		StateBytes bytes = large_bytes;
		for (int i = 0; i < 1 + round % 5; ++i) {
			bytes[random() % (bytes.size() - 8)] = static_cast<std::uint8_t>(random());
		}
		StateBytes after;
		if (load_into_copy(InstanceState(), with_checksum(bytes), after).ok()) {
			REQUIRE(after == with_checksum(bytes));
		}
		bytes.resize(random() % bytes.size());
		check_refused_bytes(bytes);
	}
}

TEST_CASE("state bytes: contradictory content is rejected") {
	constexpr std::uint64_t point = std::uint64_t{1} << 48;
	constexpr std::uint64_t added_id = point | std::uint64_t{1} << 63;
	StateRecord good;
	good.is_complete = false;
	good.removed = {point + 1, point + 2};
	good.until = {{1, 5.0}};
	good.present = {point + 3};
	good.removed_placed = {added_id + 1};
	good.added = {added_id + 2};
	good.instances = {instance_at(1.0, 2.0)};
	good.placed_at = {3.0};
	good.with_data = {point + 1, point + 3, added_id + 2};
	good.data = {{1}, {2}, {3}};
	good.data_at = {0.0, 1.0, 2.0};
	good.stamps[1] = 9;
	const auto is_loadable = [](const StateRecord &record) {
		StateBytes bytes;
		write(record, bytes);
		InstanceState state;
		std::vector<InstanceChange> changes;
		const Status status = state.apply(bytes, changes);
		CHECK((status.ok() || (status.code == ErrorCode::corrupt && state.revision() == 0)));
		return status.ok();
	};
	CHECK(is_loadable(good));
	const auto is_rejected = [&](auto damage) {
		StateRecord bad = good;
		damage(bad);
		return !is_loadable(bad);
	};
	CHECK(is_rejected([](StateRecord &bad) { bad.is_complete = true; }));
	CHECK(is_rejected([](StateRecord &bad) { bad.removed[0] = point + 3; }));
	CHECK(is_rejected([](StateRecord &bad) { bad.removed[1] = added_id + 7; }));
	CHECK(is_rejected([](StateRecord &bad) { bad.present[0] = added_id + 7; }));
	CHECK(is_rejected([](StateRecord &bad) { bad.present[0] = point + 1; }));
	CHECK(is_rejected([](StateRecord &bad) { bad.removed_placed[0] = added_id + 2; }));
	CHECK(is_rejected([](StateRecord &bad) { bad.removed_placed[0] = point + 7; }));
	CHECK(is_rejected([](StateRecord &bad) { bad.added[0] = point + 7; }));
	CHECK(is_rejected([](StateRecord &bad) { bad.added[0] = ~std::uint64_t{0}; }));
	CHECK(is_rejected([](StateRecord &bad) { bad.until[0].first = 2; }));
	CHECK(is_rejected([](StateRecord &bad) { bad.with_data[0] = point; }));
	CHECK(is_rejected([](StateRecord &bad) { bad.with_data[2] = added_id + 1; }));
	CHECK(is_rejected([](StateRecord &bad) { bad.data[0].clear(); }));
	CHECK(is_rejected([](StateRecord &bad) { bad.data[0].resize(max_instance_data + 1); }));
	CHECK(is_rejected([](StateRecord &bad) { bad.stamps.clear(); }));
	CHECK(is_rejected([](StateRecord &bad) { bad.stamps[2] = 9; }));
	CHECK(is_rejected([](StateRecord &bad) { bad.instances[0].position.y = -0.0; }));
	CHECK(is_rejected([](StateRecord &bad) { bad.instances[0].position.y = 2e9; }));
	CHECK(is_rejected([](StateRecord &bad) { bad.instances[0].basis[0][1] = std::nanf(""); }));
	for (const double time : {-0.0, -1.0, 2e12, std::nan("")}) {
		CHECK(is_rejected([time](StateRecord &bad) { bad.time = time; }));
		CHECK(is_rejected([time](StateRecord &bad) { bad.until[0].second = time; }));
		CHECK(is_rejected([time](StateRecord &bad) { bad.placed_at[0] = time; }));
		CHECK(is_rejected([time](StateRecord &bad) { bad.data_at[0] = time; }));
	}
	CHECK(is_rejected([](StateRecord &bad) { bad.until[0].second = 0.0; }));
	CHECK(is_rejected([](StateRecord &bad) { bad.origin = {7, 5, 4}; }));
	StateRecord complete = good;
	complete.is_complete = true;
	complete.removed_placed.clear();
	CHECK(is_loadable(complete));
	complete.with_data.erase(complete.with_data.begin() + 1);
	complete.data.pop_back();
	complete.data_at.pop_back();
	CHECK_FALSE(is_loadable(complete)); // The data would state only that the point is not removed.
}

TEST_CASE("state bytes: a million removals take less than 4 MB, wherever they are") {
	StateRandom random(13);
	std::vector<std::uint64_t> ids(1000000);
	std::ranges::generate(ids, [&random] { return any_point(random, 300); });
	CHECK(bytes_of_removals(ids) < 3760000);
	// The worst case: the gaps between IDs are as large as possible and slightly irregular.
	for (std::size_t at = 0; at < ids.size(); ++at) {
		ids[at] = at * 281474976 + at % 20;
	}
	StateBytes bytes;
	append_ascending(ids, bytes);
	CHECK(bytes.size() < 3860000);
}

TEST_CASE("state bytes: removals close to each other take far less") {
	StateRandom random(14);
	std::vector<std::uint64_t> wood;
	for (int i = 0; i < 200000; ++i) { // 200,000 of the two million cells of a forest.
		wood.push_back(point_id(1, static_cast<int>(random() % 1414) - 700, static_cast<int>(random() % 1414) + 90000));
	}
	const std::set<std::uint64_t> distinct(wood.begin(), wood.end());
	CHECK(8.0 * static_cast<double>(bytes_of_removals(wood)) < 5.2 * static_cast<double>(distinct.size()));
	std::vector<std::uint64_t> clearing;
	for (int x = -150; x < 150; ++x) {
		for (int y = -150; y < 150; ++y) {
			if (x * x + y * y < 150 * 150 && random() % 100 < 35) {
				clearing.push_back(point_id(1, x, y));
			}
		}
	}
	CHECK(8.0 * static_cast<double>(bytes_of_removals(clearing)) < 3.0 * static_cast<double>(clearing.size()));
}

TEST_CASE("id codec: any ascending list is restored") {
	StateRandom random(15);
	for (int round = 0; round < 400; ++round) {
		std::set<std::uint64_t> numbers;
		const std::size_t count = random() % 700;
		const int width = static_cast<int>(random() % 64);
		for (std::size_t i = 0; i < count; ++i) {
			numbers.insert(std::min(random() >> (random() % 10 == 0 ? 0 : width), IdTable<double>::none - 1));
		}
		const std::vector<std::uint64_t> list(numbers.begin(), numbers.end());
		StateBytes bytes{9};
		append_ascending(list, bytes);
		bytes.push_back(7);
		ByteReader reader(bytes);
		CHECK(reader.take<std::uint8_t>() == 9);
		std::vector<std::uint64_t> read;
		REQUIRE(take_ascending(reader, list.size(), read));
		REQUIRE(read == list);
		CHECK(reader.take<std::uint8_t>() == 7);
		CHECK(reader.at_end());
	}
	for (const std::uint64_t id : {std::uint64_t{0}, ~std::uint64_t{0}, std::uint64_t{0x8001a05597e0f7bb}}) {
		CHECK(id_of(code_of(id)) == id);
	}
	CHECK(code_of(pack({0x1234, {3 - cell_limit, 5 - cell_limit}})) == 0x1234000000000000 + 0b011011);
}
