#pragma once

#include "core/base/bytes.hpp"
#include "core/base/instance_id.hpp"
#include "core/state/instance_state.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

namespace thicket {

using StateBytes = std::vector<std::uint8_t>;
using StateRandom = std::mt19937_64;

inline std::uint64_t point_id(std::uint16_t layer, int x, int y) { return pack({layer, {x, y}}); }

/// Returns the ID of a random point among all cells of a layer.
inline std::uint64_t any_point(StateRandom &random, std::uint16_t layer) {
	return std::uint64_t{layer} << 48 | random() >> 16;
}

inline AddedInstance instance_at(double x, double z, std::uint16_t layer = 1) {
	AddedInstance instance;
	instance.layer = layer;
	instance.position = {x, 3.0, z};
	return instance;
}

inline std::uint64_t added_to(InstanceState &r_state, const AddedInstance &instance) {
	std::uint64_t id = 0;
	REQUIRE(r_state.add(instance, id).ok());
	return id;
}

inline StateBytes bytes_of(const InstanceState &state) {
	StateBytes bytes;
	REQUIRE(state.save(bytes).ok());
	return bytes;
}

inline InstanceState copy_of(const InstanceState &state) {
	InstanceState copy;
	std::vector<InstanceChange> changes;
	REQUIRE(copy.load(bytes_of(state), changes).ok());
	return copy;
}

inline StateBytes diff_of(const InstanceState &state, std::uint64_t revision) {
	StateBytes bytes;
	REQUIRE(state.diff_since(revision, bytes).ok());
	return bytes;
}

/// Replaces the checksum at the end of bytes that a test has changed.
inline StateBytes with_checksum(StateBytes bytes) {
	// A call to resize() would cause a warning of g++ under the sanitizers.
	bytes.erase(bytes.end() - 8, bytes.end());
	append(bytes, checksum(bytes));
	return bytes;
}

/// Makes one random call that changes the state. It uses few IDs, so that several calls often
/// change the same instance.
inline void change_at_random(InstanceState &r_state, StateRandom &random) {
	const auto near_coordinate = [&random] {
		return static_cast<int>(random() % 12) - 6;
	};
	const auto layer = static_cast<std::uint16_t>(random() % 3 * 16000);
	const std::uint64_t point = point_id(layer, near_coordinate(), near_coordinate());
	const std::vector<std::uint64_t> added = r_state.added_ids();
	const std::uint64_t added_id = added.empty() ? point : added[random() % added.size()];
	const std::uint64_t any = random() % 2 != 0 ? point : added_id;
	switch (random() % 9) {
		case 0:
		case 1:
			r_state.remove(any, random() % 2 != 0 ? r_state.time() + static_cast<double>(random() % 50) : 0.0);
			break;
		case 2: r_state.remove(any_point(random, layer)); break;
		case 3: r_state.restore(any); break;
		case 4: {
			AddedInstance instance = instance_at(near_coordinate() * 20.0, near_coordinate() * 20.0, layer);
			instance.mesh = static_cast<std::uint8_t>(random() % 2);
			std::uint64_t id = 0;
			REQUIRE(r_state.add(instance, id).ok());
			break;
		}
		case 5:
		case 6:
			REQUIRE(r_state.set_data(any, StateBytes(random() % 4, static_cast<std::uint8_t>(random()))).ok());
			break;
		case 7: {
			std::vector<InstanceChange> changes;
			std::uint64_t id = 0;
			const AddedInstance target = instance_at(near_coordinate() * 20.0, near_coordinate() * 20.0, layer_of(any));
			const bool existed = is_added(any) || !r_state.removed(any);
			REQUIRE(r_state.move(any, target, id, changes).ok() == existed);
			break;
		}
		default: {
			std::vector<InstanceChange> changes;
			REQUIRE(r_state.advance(static_cast<double>(random() % 5), changes).ok());
		}
	}
}

inline void change_at_random(InstanceState &r_state, StateRandom &random, int times) {
	for (int i = 0; i < times; ++i) {
		change_at_random(r_state, random);
	}
}

} // namespace thicket
