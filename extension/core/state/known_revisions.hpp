#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace thicket {

/// The last known revision of each sender of diffs. Keeps only the 256 most recently set senders,
/// so that unknown senders cannot exhaust memory.
class KnownRevisions {
public:
	static constexpr std::size_t capacity = 256;

	/// Returns the last known revision of a sender, or 0 if it is unknown.
	std::uint64_t of(std::uint64_t origin) const;

	/// Allocates the memory that `set` needs. May throw std::bad_alloc.
	void reserve_entry() { entries_.reserve(capacity); }

	/// Sets the revision of a sender. `reserve_entry` must be called first.
	void set(std::uint64_t origin, std::uint64_t revision) noexcept;

	void clear() noexcept { entries_.clear(); }

private:
	/// Pairs of sender and revision, least recently set first.
	std::vector<std::pair<std::uint64_t, std::uint64_t>> entries_;
};

} // namespace thicket
