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

/// The state that wrote a record, and which changes of that state it holds.
struct StateOrigin {
	std::uint64_t name =
			0; ///< The name of the state; 0 for none: then the record can be applied at any time, in any order.
	std::uint64_t base = 0; ///< The record holds what changed after this revision; 0 in a whole one.
	std::uint64_t end = 0;  ///< The revision of the state when it was written.

	friend bool operator==(const StateOrigin &, const StateOrigin &) = default;
};

/// What a state says of some ids, or of all: the content of its bytes. All lists ascend. Ids are in the order of their codes
/// (code_of), and are codes here.
struct StateRecord {
	using Codes = std::vector<std::uint64_t>;

	/// What is said of one id.
	struct Entry {
		bool removed = false;
		double until = 0.0;                      ///< 0 for ever.
		const AddedInstance *instance = nullptr; ///< Of a hand-placed one that is there.
		double placed_at = 0.0;                  ///< When it was placed or moved.
		std::span<const std::uint8_t> data{};
		double data_at = 0.0; ///< When they were set.
	};

	bool whole = true; ///< What is not in it is as it was generated. Otherwise it says nothing of what is not in it.
	double time = 0.0;
	StateOrigin origin;

	Codes removed;                                       ///< Points of the sets.
	std::vector<std::pair<std::uint64_t, double>> until; ///< Indices in `removed`, and times above 0.
	Codes standing; ///< Points of the sets that are not removed; of a whole state, only those with data.
	Codes gone;     ///< Hand-placed ones that are no longer there; none of a whole state.
	Codes added;
	std::vector<AddedInstance> instances; ///< As many as `added`.
	std::vector<double> placed_at;        ///< As many.

	/// Of ids in `removed`, `standing` and `added`; of others there are none.
	Codes with_data;
	std::vector<std::vector<std::uint8_t>> data; ///< As many as `with_data`.
	std::vector<double> data_at;                 ///< As many.

	std::map<std::uint16_t, std::uint64_t> stamps; ///< Of the layers of all these ids, and no others; 0 for none.

	/// The layers of all ids.
	std::map<std::uint16_t, std::uint64_t> layers() const;

	/// Whether anything is said of points of a layer.
	bool holds_points(std::uint16_t layer) const;

	/// Whether anything is said of an id.
	bool names(std::uint64_t id) const;

	/// How many ids it names.
	std::size_t size() const { return removed.size() + standing.size() + gone.size() + added.size(); }

	/// Calls `use(id, entry)` for all ids.
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

/// True if the lists of a record say one thing of each id, nothing twice, and have the stamps of their layers.
bool is_consistent(const StateRecord &record);

/// Refuses what AddedInstance refuses, naming it.
Status validate(const AddedInstance &instance);

/// The same with zeros that have no sign, so that equal instances have the same bits.
AddedInstance without_signed_zeros(AddedInstance instance);

/// True if `right` wins over `left` where both were placed at the same time. Of two different instances, one wins.
bool is_less(const AddedInstance &left, const AddedInstance &right);

} // namespace thicket
