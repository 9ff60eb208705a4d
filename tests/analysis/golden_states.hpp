#pragma once

#include "core/base/bytes.hpp"
#include "core/base/instance_id.hpp"
#include "core/base/split_mix.hpp"
#include "core/state/instance_state.hpp"

#include <cstdint>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace thicket::analysis {

/// A random number generator with the same results on every platform. The distributions of the
/// standard library differ between platforms.
class GoldenRandom {
public:
	explicit GoldenRandom(std::uint64_t seed) : state_(seed) {}

	std::uint32_t below(std::uint32_t end) {
		state_ += split_mix_gamma;
		return static_cast<std::uint32_t>(split_mix(state_) >> 33) % end;
	}

	/// Returns a multiple of 1/16 in [low, high). Sums and products of such numbers are not
	/// rounded.
	double between(int low, int high) {
		return low + static_cast<double>(below(16 * static_cast<std::uint32_t>(high - low))) / 16.0;
	}

private:
	std::uint64_t state_;
};

/// Returns a hand-placed instance near `position` with a random, skewed basis.
inline AddedInstance golden_instance(GoldenRandom &random, std::uint16_t layer, glm::dvec3 position) {
	AddedInstance instance;
	instance.layer = layer;
	instance.mesh = static_cast<std::uint8_t>(random.below(3));
	for (int axis = 0; axis < 3; ++axis) {
		instance.position[axis] = position[axis] + random.between(-90, 90) * (axis == 1 ? 0.1 : 1.0);
		for (int row = 0; row < 3; ++row) {
			instance.basis[axis][row] += static_cast<float>(random.between(-1, 1) * 0.3);
		}
	}
	return instance;
}

/// Makes one random call that changes the state. It uses few IDs, so that several calls often
/// change the same instance.
template <typename Require>
void change(InstanceState &r_state, GoldenRandom &random, Require require) {
	std::vector<InstanceChange> changes;
	const auto layer = static_cast<std::uint16_t>(random.below(3) * 16000);
	// Each statement draws one random number, because the order in which arguments are evaluated is
	// unspecified.
	const std::uint32_t cell_index = random.below(1600);
	const glm::ivec2 cell(static_cast<int>(cell_index % 40) - 20, static_cast<int>(cell_index / 40) - 20);
	const std::uint64_t point = pack({layer, cell * (random.below(4) == 0 ? 400'000 : 1)});
	const std::vector<std::uint64_t> added = r_state.added_ids();
	const auto count = static_cast<std::uint32_t>(added.size());
	const std::uint64_t any = count == 0 || random.below(2) == 0 ? point : added[random.below(count)];
	const std::uint32_t kind = random.below(8);
	if (kind < 3) {
		require(r_state.remove(any, random.below(2) == 0 ? 0.0 : r_state.time() + random.between(1, 50)).status);
	} else if (kind == 3) {
		require(r_state.restore(point).status);
	} else if (kind < 6) {
		std::uint64_t id = 0;
		require(r_state.add(golden_instance(random, layer, {-1.0e6, 300.0, 2.0e6}), id));
	} else if (kind == 6) {
		const auto byte = static_cast<std::uint8_t>(random.below(256));
		const std::vector<std::uint8_t> data(random.below(40), byte);
		require(r_state.set_data(any, data));
	} else {
		require(r_state.advance(random.between(0, 2), changes));
	}
}

/// Returns digests of two saved states, of a diff, and of the states after a merge and after the
/// diff.
template <typename Require>
std::vector<std::pair<std::string, std::uint64_t>> state_digests(Require require) {
	GoldenRandom random(19);
	InstanceState first_state;
	InstanceState second_state;
	for (const std::uint16_t layer : std::initializer_list<std::uint16_t>{0, 16000, 32000}) {
		const std::uint64_t stamp = stamp_of({.seed = 20, .radius = 1.7, .levels = 3, .layer = layer});
		require(first_state.claim(layer, stamp));
		require(second_state.claim(layer, stamp));
	}
	std::uint64_t half_way = 0;
	for (int i = 0; i < 1200; ++i) {
		half_way = i == 900 ? first_state.revision() : half_way;
		change(first_state, random, require);
		change(second_state, random, require);
	}
	std::vector<std::uint8_t> saved_bytes;
	std::vector<std::uint8_t> other;
	std::vector<std::uint8_t> diff;
	require(first_state.save(saved_bytes));
	require(second_state.save(other));
	require(first_state.diff_since(half_way, diff));

	std::vector<InstanceChange> changes;
	InstanceState merged_state;
	require(merged_state.load(saved_bytes, changes));
	require(merged_state.merge(second_state, changes));
	std::vector<std::uint8_t> merged_bytes;
	require(merged_state.save(merged_bytes));
	require(second_state.apply(diff, changes));
	std::vector<std::uint8_t> other_after;
	require(second_state.save(other_after));
	return {{"state", checksum(saved_bytes)}, {"state, another", checksum(other)}, {"state, a diff", checksum(diff)},
			{"state, a merge", checksum(merged_bytes)}, {"state, another after the diff", checksum(other_after)}};
}

} // namespace thicket::analysis
