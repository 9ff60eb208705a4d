#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

namespace thicket {

/// Records which ids changed at which revision. An id may occur several times for a while. 16 bytes per entry.
class ChangeLog {
public:
	/// Records the change of an id. Revisions must rise. The log keeps at least the last `held` changes, and at least 65536. If memory
	/// does not suffice for that, it forgets all changes.
	void note(std::uint64_t revision, std::uint64_t id, std::size_t held) noexcept;

	/// Forgets all changes up to and including `revision`.
	void start_at(std::uint64_t revision) noexcept;

	/// Whether the log contains all changes after `revision`.
	bool knows(std::uint64_t revision) const { return revision >= start_; }

	/// The ids that changed after `revision`, each once, in any order.
	std::vector<std::uint64_t> since(std::uint64_t revision) const;

	/// Appends the changes that a different log recorded after `revision`, with `raise` added to their revisions. These
	/// changes must be later than all changes in this log. Cheap even for very many changes, because logs share their
	/// memory.
	void append(const ChangeLog &other, std::uint64_t revision, std::uint64_t raise);

	/// Forgets changes that are repeated in `later`, and changes beyond the capacity for a state of `held` ids, so that
	/// `append` and `note` do not have to do it. Takes time proportional to the size of both logs.
	void make_way_for(const ChangeLog &later, std::size_t held);

	std::size_t size() const { return size_; }

private:
	struct Entry {
		std::uint64_t revision;
		std::uint64_t id;
	};
	using Entries = std::vector<Entry>;

	/// Changes in a block that is no longer appended to.
	struct Block {
		std::shared_ptr<const Entries> entries; ///< At least one.
		std::uint64_t raise;                    ///< Added to their revisions.

		std::uint64_t last() const { return entries->back().revision + raise; }
	};

	static constexpr std::size_t block_size = 4096;

	void push(Entry entry);
	void seal();
	static Entries::const_iterator after(const Entries &entries, std::uint64_t revision);

	/// Calls `use(entry)` for all entries after a revision.
	template <typename Use>
	void for_each_after(std::uint64_t revision, const Use &use) const;

	/// Keeps only the last entry of each id, at most `most` entries, and none whose id occurs in `later`.
	void compact(std::size_t most, const ChangeLog *later = nullptr);

	std::deque<Block> blocks_;
	Entries open_; ///< Entries after those of the blocks; fewer than block_size.
	std::size_t size_ = 0;
	std::size_t compacted_ = 0; ///< The size after the last compaction, when each id occurred once.
	std::uint64_t start_ = 0;
};

} // namespace thicket
