#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace thicket {

/// The last known revision of each sender of diffs. Keeps the 256 senders that were set last, so that unknown senders cannot fill the
/// memory.
class KnownRevisions {
public:
	static constexpr std::size_t most = 256;

	/// 0 for an unknown sender.
	std::uint64_t of(std::uint64_t origin) const;

	/// Allocates the memory that `set` needs. Throws std::bad_alloc.
	void make_room() { entries_.reserve(most); }

	/// Call `make_room` first.
	void set(std::uint64_t origin, std::uint64_t revision) noexcept;

	void clear() noexcept { entries_.clear(); }

private:
	std::vector<std::pair<std::uint64_t, std::uint64_t>> entries_; ///< Least recently set first.
};

} // namespace thicket
