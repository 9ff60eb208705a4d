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

/// The state that wrote a record, and the range of revisions that the record covers.
struct StateOrigin {
	std::uint64_t name = 0; ///< The name of the state. 0 if it has none; the record can then be applied in any order.
	std::uint64_t base = 0; ///< The record contains the changes after this revision. 0 in a whole record.
	std::uint64_t end = 0;  ///< The revision of the state when it was written.

	friend bool operator==(const StateOrigin &, const StateOrigin &) = default;
};

/// The decoded content of a serialized state or diff: the content of all IDs or of some. IDs are
/// stored as codes (see code_of), and all lists are in ascending order of the codes.
struct StateRecord {
	using Codes = std::vector<std::uint64_t>;

	/// The content of one ID.
	struct Entry {
		bool removed = false;
		double until = 0.0;                      ///< Clock time when the point grows again; 0 for never.
		const AddedInstance *instance = nullptr; ///< Null if there is no hand-placed instance.
		double placed_at = 0.0;                  ///< Clock time when the instance was placed or last moved.
		std::span<const std::uint8_t> data{};
		double data_at = 0.0; ///< Clock time when the data was set.
	};

	/// True for a complete state: applying it resets all IDs that are not listed to their generated
	/// state. False for a diff: those IDs are unchanged.
	bool is_complete = true;
	double time = 0.0;
	StateOrigin origin;

	Codes removed; ///< Removed points of the sets.
	/// Indices in `removed`, and the clock times, above 0, at which these points grow again.
	std::vector<std::pair<std::uint64_t, double>> until;
	Codes present;        ///< Points that are not removed. In a complete state, only those with data.
	Codes removed_placed; ///< Hand-placed instances that no longer exist. Empty in a complete state.
	Codes added;
	std::vector<AddedInstance> instances; ///< One entry for each ID in `added`.
	std::vector<double> placed_at;        ///< Clock times, one for each ID in `added`.

	/// IDs in `removed`, `present` and `added` that have data.
	Codes with_data;
	std::vector<std::vector<std::uint8_t>> data; ///< One entry for each ID in `with_data`.
	std::vector<double> data_at;                 ///< Clock times, one for each ID in `with_data`.

	/// The stamp of each layer that has IDs in the record; 0 if the layer has no stamp.
	std::map<std::uint16_t, std::uint64_t> stamps;

	/// Returns the layers of all IDs, with stamps of 0.
	std::map<std::uint16_t, std::uint64_t> layers() const;

	/// Returns true if the record contains points of a layer.
	bool has_points(std::uint16_t layer) const;

	/// Returns true if the record contains an ID.
	bool contains(std::uint64_t id) const;

	/// Returns the number of IDs in the record.
	std::size_t size() const { return removed.size() + present.size() + removed_placed.size() + added.size(); }

	/// Calls `use(id, entry)` for each ID.
	template <typename Use>
	void for_each(Use &&use) const {
		auto next_until = until.begin();
		for (std::size_t at = 0; at < removed.size(); ++at) {
			const bool timed = next_until != until.end() && next_until->first == at;
			use_entry(removed[at], {.removed = true, .until = timed ? next_until->second : 0.0}, use);
			next_until += timed ? 1 : 0;
		}
		for (const std::uint64_t code : present) {
			use_entry(code, {}, use);
		}
		for (const std::uint64_t code : removed_placed) {
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

/// Returns true if the record is consistent: each ID is in exactly one of the lists for its kind,
/// only listed IDs have data, and exactly their layers have stamps.
bool is_consistent(const StateRecord &record);

/// Returns an error for a value outside the ranges of AddedInstance. The error names the field.
Status validate(const AddedInstance &instance);

/// Returns the instance with each -0 replaced by 0, so that equal instances have the same bits.
AddedInstance without_signed_zeros(AddedInstance instance);

/// Returns true if `left` comes before `right` in a strict total order of the instances of a layer.
/// When two versions of an instance have the same time, a merge keeps the greater one.
bool is_less(const AddedInstance &left, const AddedInstance &right);

} // namespace thicket
