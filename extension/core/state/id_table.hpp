#pragma once

#include "core/base/guard.hpp"
#include "core/base/split_mix.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace thicket {

/// Returns the salt for hashes of IDs. It differs in each run, so that an attacker cannot choose
/// colliding IDs.
std::uint64_t salt_of_this_run();

/// Returns a new table ID, unique within this run.
std::uint64_t new_table_owner();

/// A hash set of IDs, each with an optional value (`Value()` if it has none). The order of IDs
/// differs from run to run.
///
/// A small table has one shard; a large one is split by hash into 256 shards, so that no operation
/// on a single ID takes long. Each shard uses open addressing with linear probing: 8 bytes per
/// slot, plus a value once any ID of the shard has one. At most three of four slots are occupied.
/// Tables can share their shards (`share`); a table copies a shared shard before it changes it.
template <typename Value>
class IdTable {
public:
	/// A value that is not a valid ID.
	static constexpr std::uint64_t none = ~std::uint64_t{0};

	static constexpr std::size_t shard_count = 256;

	/// The number of IDs to be inserted: in total, and per shard.
	struct NewIds {
		std::array<std::uint32_t, shard_count> by_shard{};
		std::uint32_t all = 0;
	};

	IdTable() = default;
	IdTable(IdTable &&) noexcept = default;
	IdTable &operator=(IdTable &&) noexcept = default;

	/// Returns a copy that shares this table's memory. Takes microseconds. Both tables then copy a
	/// shard before they first change it, so different threads may use them.
	IdTable share() {
		IdTable other(*this);
		owner_ = new_table_owner();
		return other;
	}

	bool contains(std::uint64_t id) const {
		if (size_ == 0) {
			// The table is empty. This check is faster than hashing.
			return false;
		}
		const std::uint64_t hash = hash_of(id);
		const View &view = views_[index_of(hash)];
		return view.ids[view.slot_of(id, hash)] == id;
	}

	/// Returns the value of `id`, or `Value()` if it has none or is not in the table.
	const Value &value(std::uint64_t id) const {
		if (valued_ == 0) {
			// No ID of the shard has a value.
			return nothing_;
		}
		const std::uint64_t hash = hash_of(id);
		const Shard *shard = shards_[index_of(hash)].get();
		if (shard == nullptr || shard->valued == 0) {
			return nothing_;
		}
		const std::size_t slot = shard->slot_of(id, hash);
		return shard->ids[slot] == id ? shard->values[slot] : nothing_;
	}

	/// Allocates the memory for changing an ID, and for a value if `valued`, so that the next
	/// `insert` or `erase` of the ID allocates none. `r_new_ids` accumulates the new IDs of a
	/// batch; it is null for a single ID.
	void reserve_for(std::uint64_t id, bool is_new, bool valued, NewIds *r_new_ids) {
		const std::uint64_t hash = hash_of(id);
		std::size_t in_shard = is_new ? 1 : 0;
		std::size_t in_all = in_shard;
		if (r_new_ids != nullptr) {
			in_shard = r_new_ids->by_shard[shard_of(hash)] += is_new ? 1 : 0;
			in_all = r_new_ids->all += is_new ? 1 : 0;
		}
		const bool spreads = mask_ == 0 && size_ + in_all > max_in_one;
		if (!spreads) {
			grow(index_of(hash), mask_ == 0 ? in_all : in_shard, valued);
			return;
		}
		const bool all_valued = valued || (shards_[0] != nullptr && !shards_[0]->values.empty());
		spread(shard_count - 1);
		grow(index_of(hash), in_shard, all_valued);
		for (std::size_t index = 0; r_new_ids != nullptr && index < shard_count; ++index) {
			grow(index, r_new_ids->by_shard[index], all_valued);
		}
	}

	/// Allocates memory for about `more` new IDs, whose hashes are not known yet. In rare cases a
	/// shard must still grow later.
	void expect(std::size_t more) {
		const std::size_t mean = more / shard_count;
		if (mean < max_in_one / shard_count) {
			return;
		}
		if (mask_ == 0) {
			spread(shard_count - 1);
		}
		const auto deviation = static_cast<std::size_t>(std::sqrt(static_cast<double>(mean)));
		for (std::size_t index = 0; index < shard_count; ++index) {
			grow(index, mean + 4 * deviation, false);
		}
	}

	/// Adds `id`, or sets the value of an existing one. Returns true if the ID is new. `id` must
	/// not be `none`.
	bool insert(std::uint64_t id, Value value = Value()) {
		const std::uint64_t hash = hash_of(id);
		Shard *shard = &own(index_of(hash));
		std::size_t slot = shard->slot_of(id, hash);
		const bool is_new = shard->ids[slot] == none;
		if (is_new) {
			if (4 * (shard->size + 1) > 3 * shard->ids.size()) {
				reserve_for(id, true, false, nullptr);
				shard = &own(index_of(hash));
				slot = shard->slot_of(id, hash);
			}
			shard->ids[slot] = id;
			++shard->size;
			++size_;
		}
		set_value(*shard, slot, std::move(value));
		return is_new;
	}

	/// Removes `id`. Returns false if it was not in the table. Memory is not released; see
	/// `shrink`.
	bool erase(std::uint64_t id) {
		if (!contains(id)) {
			return false;
		}
		const std::uint64_t hash = hash_of(id);
		Shard &shard = own(index_of(hash));
		const std::size_t hole = shard.slot_of(id, hash);
		set_value(shard, hole, Value());
		--size_;
		close(shard, hole);
		return true;
	}

	/// Releases memory if less than an eighth of the slots is occupied. If the smaller arrays
	/// cannot be allocated, leaves the table unchanged.
	void shrink() noexcept {
		if (slots_ > min_slots && 8 * size_ < slots_) {
			static_cast<void>(guarded("ids", static_cast<double>(slots_), [this] { shrink_all(); }));
		}
	}

	std::size_t size() const { return size_; }

	/// Returns the number of IDs that have a value.
	std::size_t valued() const { return valued_; }

	/// Calls `use(id, value)` for each ID, in unspecified order.
	template <typename Use>
	void for_each(Use &&use) const {
		for (const std::shared_ptr<Shard> &shard : shards_) {
			for (std::size_t slot = 0; shard != nullptr && slot < shard->ids.size(); ++slot) {
				if (shard->ids[slot] != none) {
					use(shard->ids[slot], shard->values.empty() ? nothing_ : shard->values[slot]);
				}
			}
		}
	}

private:
	static constexpr std::size_t min_slots = 16;
	static constexpr std::size_t max_in_one = 3072;
	static constexpr int shard_shift = 56;
	static inline const Value nothing_{};

	/// The IDs of a shard, for lookup. A default view is empty.
	struct View {
		/// Returns the slot of `id` or, if it is missing, the free slot for inserting it.
		std::size_t slot_of(std::uint64_t id, std::uint64_t hash) const {
			std::size_t slot = static_cast<std::size_t>(hash) & mask;
			while (ids[slot] != id && ids[slot] != none) {
				slot = (slot + 1) & mask;
			}
			return slot;
		}

		const std::uint64_t *ids = &none;
		std::size_t mask = 0;
	};

	struct Shard {
		explicit Shard(std::uint64_t own) : owner(own), ids(min_slots, none) {}

		View view() const { return {ids.data(), ids.size() - 1}; }
		std::size_t slot_of(std::uint64_t id, std::uint64_t hash) const { return view().slot_of(id, hash); }

		std::uint64_t owner; ///< The only table that may change this shard.
		std::size_t size = 0;
		std::size_t valued = 0;
		std::vector<std::uint64_t> ids; ///< The size is a power of two. Free slots are `none`.
		std::vector<Value> values;      ///< By slot. Empty until an ID of the shard has a value.
	};

	IdTable(const IdTable &other) :
			shards_(other.shards_), views_(other.views_), mask_(other.mask_), size_(other.size_),
			valued_(other.valued_), slots_(other.slots_) {}

	std::uint64_t hash_of(std::uint64_t id) const { return split_mix(id ^ salt_); }

	static std::size_t shard_of(std::uint64_t hash) { return static_cast<std::size_t>(hash >> shard_shift); }
	std::size_t index_of(std::uint64_t hash) const { return shard_of(hash) & mask_; }

	/// Returns a shard for writing. It is created if it is missing, and copied if it is shared.
	Shard &own(std::size_t index) {
		std::shared_ptr<Shard> &r_shard = shards_[index];
		if (r_shard == nullptr) {
			r_shard = std::make_shared<Shard>(owner_);
			slots_ += min_slots;
			views_[index] = r_shard->view();
		} else if (r_shard->owner != owner_) {
			const auto copy = std::make_shared<Shard>(*r_shard);
			copy->owner = owner_;
			r_shard = copy;
			views_[index] = r_shard->view();
		}
		return *r_shard;
	}

	/// Allocates memory for `more` new IDs in a shard.
	void grow(std::size_t index, std::size_t more, bool valued) {
		Shard &r_shard = own(index);
		std::size_t slots = r_shard.ids.size();
		while (4 * (r_shard.size + more) > 3 * slots) {
			slots *= 2;
		}
		if (slots > r_shard.ids.size()) {
			resize(index, slots, valued || !r_shard.values.empty());
		} else if (valued && r_shard.values.empty()) {
			r_shard.values.resize(slots);
		}
	}

	/// Redistributes all IDs over `mask` + 1 shards.
	void spread(std::size_t mask) {
		IdTable other;
		other.mask_ = mask;
		for_each([&other](std::uint64_t id, const Value &value) { other.insert(id, value); });
		*this = std::move(other);
	}

	void set_value(Shard &r_shard, std::size_t slot, Value value) {
		const bool is_value = !(value == Value());
		if (r_shard.values.empty()) {
			if (!is_value) {
				// No ID of the shard has a value, so none is stored.
				return;
			}
			r_shard.values.resize(r_shard.ids.size());
		}
		const bool was_value = !(r_shard.values[slot] == Value());
		const std::size_t more = std::size_t{is_value} - std::size_t{was_value};
		r_shard.valued += more;
		valued_ += more;
		r_shard.values[slot] = std::move(value);
	}

	/// Frees a slot. Displaced IDs are moved back into the gap, so that linear probing still finds
	/// them.
	void close(Shard &r_shard, std::size_t hole) {
		std::vector<std::uint64_t> &ids = r_shard.ids;
		--r_shard.size;
		const std::size_t mask = ids.size() - 1;
		for (std::size_t next = (hole + 1) & mask; ids[next] != none; next = (next + 1) & mask) {
			const std::size_t home = static_cast<std::size_t>(hash_of(ids[next])) & mask;
			if (((next - home) & mask) < ((next - hole) & mask)) {
				continue;
			}
			ids[hole] = ids[next];
			if (!r_shard.values.empty()) {
				r_shard.values[hole] = std::exchange(r_shard.values[next], Value());
			}
			hole = next;
		}
		ids[hole] = none;
	}

	/// Resizes a shard to `slots` slots. All memory is allocated before anything changes.
	void resize(std::size_t index, std::size_t slots, bool with_values) {
		Shard &r_shard = *shards_[index];
		std::vector<std::uint64_t> ids(slots, none);
		std::vector<Value> values(with_values ? slots : 0);
		ids.swap(r_shard.ids);
		values.swap(r_shard.values);
		slots_ += slots - ids.size();
		views_[index] = r_shard.view();
		for (std::size_t slot = 0; slot < ids.size(); ++slot) {
			if (ids[slot] == none) {
				continue;
			}
			const std::size_t to = r_shard.slot_of(ids[slot], hash_of(ids[slot]));
			r_shard.ids[to] = ids[slot];
			if (with_values && !values.empty()) {
				r_shard.values[to] = std::move(values[slot]);
			}
		}
	}

	void shrink_all() {
		if (mask_ != 0 && size_ < shard_count * min_slots / 8) {
			spread(0);
			return;
		}
		for (std::size_t index = 0; index < shard_count; ++index) {
			if (shards_[index] == nullptr) {
				continue;
			}
			std::size_t slots = shards_[index]->ids.size();
			while (slots > min_slots && 8 * shards_[index]->size < slots) {
				slots /= 2;
			}
			if (slots < shards_[index]->ids.size()) {
				const Shard &shard = own(index);
				resize(index, slots, shard.valued > 0);
			}
		}
	}

	std::array<std::shared_ptr<Shard>, shard_count> shards_;
	std::array<View, shard_count> views_; ///< Views of the shards.
	std::size_t mask_ = 0;                ///< Mask for shard indices; 0 while there is only one shard.
	std::uint64_t salt_ = salt_of_this_run();
	std::uint64_t owner_ = new_table_owner();
	std::size_t size_ = 0;
	std::size_t valued_ = 0;
	std::size_t slots_ = 0; ///< Total number of slots in all shards.
};

} // namespace thicket
