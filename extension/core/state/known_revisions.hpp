#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace thicket {

/// The last revision that is known of each sender of diffs. Keeps the last 256 senders that were set, so that strangers cannot fill the
/// memory.
class KnownRevisions {
public:
	static constexpr std::size_t most = 256;

	/// 0 for a sender that is not known.
	std::uint64_t of(std::uint64_t origin) const;

	/// Takes the memory that `set` needs. Throws std::bad_alloc.
	void make_room() { entries_.reserve(most); }

	/// After `make_room`.
	void set(std::uint64_t origin, std::uint64_t revision) noexcept;

	void clear() noexcept { entries_.clear(); }

private:
	std::vector<std::pair<std::uint64_t, std::uint64_t>> entries_; ///< The one set longest ago first.
};

} // namespace thicket
