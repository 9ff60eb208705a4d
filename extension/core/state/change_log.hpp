#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

namespace thicket {

/// Which ids have changed since when. An id stands in it once or, for a while, some times; 16 bytes each.
class ChangeLog {
public:
	/// An id has changed. Revisions rise. The log keeps at least the last `held` changes, and 65536; where memory does not
	/// suffice for that, it forgets them all.
	void note(std::uint64_t revision, std::uint64_t id, std::size_t held) noexcept;

	/// Forgets all changes up to and with `revision`.
	void start_at(std::uint64_t revision) noexcept;

	/// Whether all changes after `revision` are here.
	bool knows(std::uint64_t revision) const { return revision >= start_; }

	/// What has changed after `revision`, each id once, in any order.
	std::vector<std::uint64_t> since(std::uint64_t revision) const;

	/// Adds what another log has noted after `revision`, each as `raise` later; those are later than all that is here. Costs little for
	/// very many: logs share their memory.
	void append(const ChangeLog &other, std::uint64_t revision, std::uint64_t raise);

	/// Forgets what will be noted again in `later`, and what is too much for a state that will then hold `held` ids: so that `append` and
	/// `note` need not. Takes as long as both are.
	void make_way_for(const ChangeLog &later, std::size_t held);

	std::size_t size() const { return size_; }

private:
	struct Entry {
		std::uint64_t revision;
		std::uint64_t id;
	};
	using Entries = std::vector<Entry>;

	/// Changes that nobody adds to any more.
	struct Block {
		std::shared_ptr<const Entries> entries; ///< One at least.
		std::uint64_t raise;                    ///< Of their revisions.

		std::uint64_t last() const { return entries->back().revision + raise; }
	};

	static constexpr std::size_t block_size = 4096;

	void push(Entry entry);
	void seal();
	static Entries::const_iterator after(const Entries &entries, std::uint64_t revision);

	/// Calls `use(entry)` for all after a revision.
	template <typename Use>
	void for_each_after(std::uint64_t revision, const Use &use) const;

	/// Leaves each id only its last entry, no more than `most` of these, and none of those in `later`.
	void compact(std::size_t most, const ChangeLog *later = nullptr);

	std::deque<Block> blocks_;
	Entries open_; ///< After them; fewer than block_size.
	std::size_t size_ = 0;
	std::size_t compacted_ = 0; ///< How many there were when each id stood in it once.
	std::uint64_t start_ = 0;
};

} // namespace thicket
