#include "core/state/id_table.hpp"

#include "core/base/guard.hpp"
#include "core/base/split_mix.hpp"

#include <algorithm>
#include <random>
#include <utility>

namespace thicket {

namespace {

constexpr std::size_t least_slots = 16;

std::uint64_t salt_of_this_run() {
	static const std::uint64_t salt = split_mix(std::random_device{}());
	return salt;
}

} // namespace

IdTable::IdTable() : salt_(salt_of_this_run()) {}

std::size_t IdTable::home_of(std::uint64_t id) const {
	return static_cast<std::size_t>(split_mix(id ^ salt_)) & (ids_.size() - 1);
}

std::size_t IdTable::slot_of(std::uint64_t id) const {
	std::size_t slot = home_of(id);
	while (ids_[slot] != id && ids_[slot] != none) {
		slot = (slot + 1) & (ids_.size() - 1);
	}
	return slot;
}

double IdTable::time(std::uint64_t id) const {
	if (timed_ == 0) {
		return 0.0;
	}
	const std::size_t slot = slot_of(id);
	return ids_[slot] == id ? times_[slot] : 0.0;
}

void IdTable::set_time(std::size_t slot, double time) {
	if (times_.empty()) {
		if (time == 0.0) {
			return;
		}
		times_.resize(ids_.size());
	}
	timed_ += (time != 0.0 ? 1U : 0U) - (times_[slot] != 0.0 ? 1U : 0U);
	times_[slot] = time;
}

void IdTable::reserve(std::size_t count, bool timed) {
	std::size_t slots = std::max(ids_.size(), least_slots);
	while (4 * count > 3 * slots) {
		slots *= 2;
	}
	if (slots > ids_.size()) {
		resize(slots, timed || timed_ > 0);
	} else if (timed && times_.empty()) {
		times_.resize(slots);
	}
}

bool IdTable::insert(std::uint64_t id, double time) {
	reserve(size_ + 1, time != 0.0);
	const std::size_t slot = slot_of(id);
	const bool is_new = ids_[slot] == none;
	ids_[slot] = id;
	size_ += is_new ? 1U : 0U;
	set_time(slot, time);
	return is_new;
}

bool IdTable::erase(std::uint64_t id) noexcept {
	if (!contains(id)) {
		return false;
	}
	std::size_t hole = slot_of(id);
	set_time(hole, 0.0);
	--size_;
	// What was pushed on by the one that goes moves up, so that no search ends too early.
	const std::size_t mask = ids_.size() - 1;
	for (std::size_t next = (hole + 1) & mask; ids_[next] != none; next = (next + 1) & mask) {
		const std::size_t home = home_of(ids_[next]);
		if (((next - home) & mask) < ((next - hole) & mask)) {
			continue;
		}
		ids_[hole] = ids_[next];
		if (!times_.empty()) {
			times_[hole] = std::exchange(times_[next], 0.0);
		}
		hole = next;
	}
	ids_[hole] = none;
	return true;
}

void IdTable::shrink() noexcept {
	std::size_t slots = ids_.size();
	while (slots > least_slots && 8 * size_ < slots) {
		slots /= 2;
	}
	if (slots < ids_.size()) {
		static_cast<void>(guarded("ids", static_cast<double>(slots), [&] { resize(slots, timed_ > 0); }));
	}
}

/// All memory is taken before anything changes.
void IdTable::resize(std::size_t slots, bool timed) {
	std::vector<std::uint64_t> ids(slots, none);
	std::vector<double> times(timed ? slots : 0);
	ids.swap(ids_);
	times.swap(times_);
	for (std::size_t slot = 0; slot < ids.size(); ++slot) {
		if (ids[slot] == none) {
			continue;
		}
		const std::size_t to = slot_of(ids[slot]);
		ids_[to] = ids[slot];
		if (timed && !times.empty()) {
			times_[to] = times[slot];
		}
	}
}

} // namespace thicket
