#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// A set of ids, each with a time or none: open addressing with linear probing, 8 bytes a slot, and 8 more once any id has a time. At
/// most three of four slots are taken. The order of ids differs from run to run, so that nobody can choose ids that collide.
class IdTable {
public:
	/// What no id is.
	static constexpr std::uint64_t none = ~std::uint64_t{0};

	IdTable();

	bool contains(std::uint64_t id) const { return !ids_.empty() && ids_[slot_of(id)] == id; }

	/// The time of an id; 0 for none, and for an id that is not in.
	double time(std::uint64_t id) const;

	/// Takes the memory for `count` ids, and for times if any of them will have one: so long `insert` takes none.
	void reserve(std::size_t count, bool timed);

	/// Adds an id, or gives one that is in another time. False if it was in. `id` is not `none`.
	bool insert(std::uint64_t id, double time = 0.0);

	/// False if it was not in. Takes no memory and gives none back; that is for `shrink`.
	bool erase(std::uint64_t id) noexcept;

	/// Gives memory back where there is far too much of it; keeps it where there is none to move to.
	void shrink() noexcept;

	std::size_t size() const { return size_; }

	/// How many ids have a time.
	std::size_t timed() const { return timed_; }

	/// Calls `use(id, time)` for each, in any order.
	template <typename Use>
	void for_each(Use &&use) const {
		for (std::size_t slot = 0; slot < ids_.size(); ++slot) {
			if (ids_[slot] != none) {
				use(ids_[slot], times_.empty() ? 0.0 : times_[slot]);
			}
		}
	}

private:
	/// The slot of an id or, if it is not in, the free slot where it would be put.
	std::size_t slot_of(std::uint64_t id) const;
	std::size_t home_of(std::uint64_t id) const;
	void set_time(std::size_t slot, double time);
	void resize(std::size_t slots, bool timed);

	std::vector<std::uint64_t> ids_; ///< As many as a power of two; `none` where a slot is free.
	std::vector<double> times_;      ///< Empty while no id has had one.
	std::size_t size_ = 0;
	std::size_t timed_ = 0;
	std::uint64_t salt_;
};

} // namespace thicket
