#pragma once

#include "core/base/status.hpp"
#include "core/state/id_codec.hpp"
#include "core/state/instance_state.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

namespace thicket {

/// What a state says of some ids, or of all: the content of its bytes. All lists ascend. Ids are in the order of their codes
/// (code_of), and are codes here.
struct StateRecord {
	using Codes = std::vector<std::uint64_t>;

	/// What is said of one id.
	struct Entry {
		bool removed = false;
		double until = 0.0;                      ///< 0 for ever.
		const AddedInstance *instance = nullptr; ///< Of a hand-placed one that is there.
		std::span<const std::uint8_t> data{};
	};

	bool whole = true; ///< What is not in it is as it was generated. Otherwise it says nothing of what is not in it.
	double time = 0.0;

	Codes removed;                                       ///< Points of the sets.
	std::vector<std::pair<std::uint64_t, double>> until; ///< Indices in `removed`, and times above 0.
	Codes standing; ///< Points of the sets that are not removed; of a whole state, only those with data.
	Codes gone;     ///< Hand-placed ones that are no longer there; none of a whole state.
	Codes added;
	std::vector<AddedInstance> instances; ///< As many as `added`.

	/// Of ids in `removed`, `standing` and `added`; of others there are none.
	Codes with_data;
	std::vector<std::vector<std::uint8_t>> data; ///< As many as `with_data`.

	std::map<std::uint16_t, std::uint64_t> stamps; ///< Of the layers of all these ids, and no others; 0 for none.

	/// The layers of all ids.
	std::map<std::uint16_t, std::uint64_t> layers() const;

	/// Whether anything is said of points of a layer.
	bool holds_points(std::uint16_t layer) const;

	/// Whether anything is said of an id.
	bool names(std::uint64_t id) const;

	/// Calls `use(id, entry)` for all ids.
	template <typename Use>
	void for_each(Use &&use) const {
		auto next_until = until.begin();
		for (std::size_t at = 0; at < removed.size(); ++at) {
			const bool timed = next_until != until.end() && next_until->first == at;
			use(id_of(removed[at]), Entry{true, timed ? next_until->second : 0.0, nullptr, data_of(removed[at])});
			next_until += timed ? 1 : 0;
		}
		for (const std::uint64_t code : standing) {
			use(id_of(code), Entry{false, 0.0, nullptr, data_of(code)});
		}
		for (const std::uint64_t code : gone) {
			use(id_of(code), Entry{});
		}
		for (std::size_t at = 0; at < added.size(); ++at) {
			use(id_of(added[at]), Entry{false, 0.0, &instances[at], data_of(added[at])});
		}
	}

private:
	std::span<const std::uint8_t> data_of(std::uint64_t code) const;
};

/// Refuses what AddedInstance refuses, naming it.
Status validate(const AddedInstance &instance);

/// The same with zeros that have no sign, so that equal instances have the same bits.
AddedInstance without_signed_zeros(AddedInstance instance);

/// Replaces `r_bytes` by the stored form of a record, and by nothing of use once `cancel` was raised.
void write(const StateRecord &record, std::vector<std::uint8_t> &r_bytes, const std::atomic<bool> *cancel = nullptr);

/// Reads a stored form, and nothing else: what is read is written again to the byte. After an error the record is unspecified.
/// Once `cancel` was raised it refuses anything, within some milliseconds.
Status read(std::span<const std::uint8_t> bytes, StateRecord &r_record, const std::atomic<bool> *cancel = nullptr);

} // namespace thicket
