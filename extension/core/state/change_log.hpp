#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

namespace thicket {

/// Which ids have changed since when. An id stands in it once or, for a while, some times; 16 bytes each.
class ChangeLog {
public:
	/// An id has changed. Revisions rise. The log keeps at least the last `held` changes, and 65536.
	void note(std::uint64_t revision, std::uint64_t id, std::size_t held);

	/// Forgets all changes up to and with `revision`.
	void start_at(std::uint64_t revision);

	/// Whether all changes after `revision` are here.
	bool knows(std::uint64_t revision) const { return revision >= start_; }

	/// What has changed after `revision`, each id once, in any order.
	std::vector<std::uint64_t> since(std::uint64_t revision) const;

private:
	struct Entry {
		std::uint64_t revision;
		std::uint64_t id;
	};

	/// Leaves each id only its last entry, and no more than `most` of these.
	void compact(std::size_t most);

	std::deque<Entry> entries_; ///< Not a vector, which would hold twice as much while it grows.
	std::size_t compacted_ = 0; ///< How many there were when each id stood in it once.
	std::uint64_t start_ = 0;
};

} // namespace thicket
