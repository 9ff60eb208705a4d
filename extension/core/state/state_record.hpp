#pragma once

#include "core/base/status.hpp"
#include "core/state/id_codec.hpp"
#include "core/state/instance_state.hpp"

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

namespace thicket {

/// The state that wrote a record, and the range of its changes in the record.
struct StateOrigin {
	std::uint64_t name =
			0; ///< The name of the state. 0 if it has none: the record can then be applied at any time, in any order.
	std::uint64_t base = 0; ///< The record has the changes after this revision. 0 in a whole record.
	std::uint64_t end = 0;  ///< The revision of the state when it was written.

	friend bool operator==(const StateOrigin &, const StateOrigin &) = default;
};

/// The content of some ids of a state, or of all: the content of its bytes. All lists ascend. Ids are stored as codes and are in the
/// order of their codes (code_of).
struct StateRecord {
	using Codes = std::vector<std::uint64_t>;

	/// The content of one id.
	struct Entry {
		bool removed = false;
		double until = 0.0;                      ///< 0 if permanent.
		const AddedInstance *instance = nullptr; ///< Of an existing hand-placed instance.
		double placed_at = 0.0;                  ///< When it was placed or moved.
		std::span<const std::uint8_t> data{};
		double data_at = 0.0; ///< When they were set.
	};

	bool whole = true; ///< True: ids that are not in it are as generated. False: ids that are not in it are unchanged.
	double time = 0.0;
	StateOrigin origin;

	Codes removed;                                       ///< Points of the sets.
	std::vector<std::pair<std::uint64_t, double>> until; ///< Indices in `removed`, and times above 0.
	Codes standing; ///< Points that are not removed. In a whole state, only those with data.
	Codes gone;     ///< Hand-placed instances that no longer exist. Empty in a whole state.
	Codes added;
	std::vector<AddedInstance> instances; ///< Same size as `added`.
	std::vector<double> placed_at;        ///< Same size.

	/// Ids in `removed`, `standing` and `added`. Other ids have no data.
	Codes with_data;
	std::vector<std::vector<std::uint8_t>> data; ///< Same size as `with_data`.
	std::vector<double> data_at;                 ///< Same size.

	std::map<std::uint16_t, std::uint64_t> stamps; ///< Of exactly the layers of all these ids; 0 if none.

	/// The layers of all ids, each with a stamp of 0.
	std::map<std::uint16_t, std::uint64_t> layers() const;

	/// Whether the record has points of a layer.
	bool holds_points(std::uint16_t layer) const;

	/// Whether the record contains an id.
	bool names(std::uint64_t id) const;

	/// The number of ids.
	std::size_t size() const { return removed.size() + standing.size() + gone.size() + added.size(); }

	/// Calls `use(id, entry)` for each id.
	template <typename Use>
	void for_each(Use &&use) const {
		auto next_until = until.begin();
		for (std::size_t at = 0; at < removed.size(); ++at) {
			const bool timed = next_until != until.end() && next_until->first == at;
			use_entry(removed[at], {.removed = true, .until = timed ? next_until->second : 0.0}, use);
			next_until += timed ? 1 : 0;
		}
		for (const std::uint64_t code : standing) {
			use_entry(code, {}, use);
		}
		for (const std::uint64_t code : gone) {
			use(id_of(code), Entry{});
		}
		for (std::size_t at = 0; at < added.size(); ++at) {
			use_entry(added[at], {.instance = &instances[at], .placed_at = placed_at[at]}, use);
		}
	}

private:
	template <typename Use>
	void use_entry(std::uint64_t code, Entry entry, Use &use) const {
		add_data(code, entry);
		use(id_of(code), entry);
	}

	void add_data(std::uint64_t code, Entry &r_entry) const;
};

/// Whether the record has exactly one statement for each id, no duplicates, and the stamps of its layers.
bool is_consistent(const StateRecord &record);

/// Refuses values outside the ranges of AddedInstance, and reports the field.
Status validate(const AddedInstance &instance);

/// Returns the instance with unsigned zeros, so that equal instances have the same bits.
AddedInstance without_signed_zeros(AddedInstance instance);

/// Whether `right` wins over `left` if both were placed at the same time. Of two different instances, exactly one wins.
bool is_less(const AddedInstance &left, const AddedInstance &right);

} // namespace thicket
