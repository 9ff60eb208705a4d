#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

namespace thicket {

/// Records which ID changed at each revision. An ID may have several entries until the log is
/// compacted. An entry takes 16 bytes.
class ChangeLog {
public:
	/// Records a change to an ID. Revisions must increase. The log contains at least the last
	/// `min_changes` changes, and never fewer than the last 65536. If memory runs out, the log
	/// discards all changes.
	void record(std::uint64_t revision, std::uint64_t id, std::size_t min_changes) noexcept;

	/// Clears the log, which then starts after `revision`.
	void start_at(std::uint64_t revision) noexcept;

	/// Returns true if the log contains all changes after `revision`.
	bool knows(std::uint64_t revision) const { return revision >= start_; }

	/// Returns the IDs that changed after `revision`, without duplicates, in ascending order.
	std::vector<std::uint64_t> since(std::uint64_t revision) const;

	/// Appends the changes that `other` recorded after `revision` and adds `raise` to their
	/// revisions. The resulting revisions must be later than all changes in this log. The call is
	/// cheap even for millions of changes, because logs share their blocks.
	void append(const ChangeLog &other, std::uint64_t revision, std::uint64_t raise);

	/// Compacts this log before `later` is appended, so that `append` and `note` need not compact
	/// it. Discards changes to IDs that occur in `later`, and the oldest changes beyond the
	/// capacity for a state of `min_changes` IDs. The time is proportional to the size of both
	/// logs.
	void compact_before(const ChangeLog &later, std::size_t min_changes);

	std::size_t size() const { return size_; }

private:
	struct Entry {
		std::uint64_t revision;
		std::uint64_t id;
	};
	using Entries = std::vector<Entry>;

	/// A sealed block of changes, which is never modified.
	struct Block {
		std::shared_ptr<const Entries> entries; ///< Never empty.
		std::uint64_t raise;                    ///< Number to add to the revisions of the entries.

		std::uint64_t last() const { return entries->back().revision + raise; }
	};

	static constexpr std::size_t block_size = 4096;

	void push(Entry entry);
	void seal();
	static Entries::const_iterator after(const Entries &entries, std::uint64_t revision);

	/// Calls `use(entry)` for each entry after `revision`.
	template <typename Use>
	void for_each_after(std::uint64_t revision, const Use &use) const;

	/// Compacts the log to the last entry of each ID, without IDs that occur in `later`. Compaction
	/// stops after the block in which it reaches `max_count` entries.
	void compact(std::size_t max_count, const ChangeLog *later = nullptr);

	std::deque<Block> blocks_;
	Entries open_; ///< The latest entries, fewer than block_size, which are not yet in a block.
	std::size_t size_ = 0;
	std::size_t compacted_ = 0; ///< The size after the last compaction.
	std::uint64_t start_ = 0;
};

} // namespace thicket
