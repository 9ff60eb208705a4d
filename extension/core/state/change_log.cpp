#include "core/state/change_log.hpp"

#include "core/base/guard.hpp"
#include "core/state/id_table.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace thicket {

namespace {

constexpr std::size_t always_kept = 65536;

using IdSet = IdTable<bool>;

} // namespace

void ChangeLog::record(std::uint64_t revision, std::uint64_t id, std::size_t min_changes) noexcept {
	const Status status = guarded("changes", static_cast<double>(min_changes), [&] {
		push({revision, id});
		if (size_ > 2 * std::max(compacted_, min_changes) + always_kept) {
			compact(min_changes + always_kept);
		}
	});
	if (!status.ok()) {
		start_at(revision);
	}
}

void ChangeLog::push(Entry entry) {
	open_.push_back(entry);
	++size_;
	if (open_.size() == block_size) {
		seal();
	}
}

void ChangeLog::seal() {
	const auto entries = std::make_shared<Entries>(std::move(open_));
	open_ = {};
	blocks_.push_back({entries, 0});
	open_.reserve(block_size);
}

/// Returns the first entry whose revision is greater than `revision`.
ChangeLog::Entries::const_iterator ChangeLog::after(const Entries &entries, std::uint64_t revision) {
	return std::ranges::upper_bound(entries, revision, {}, &Entry::revision);
}

template <typename Use>
void ChangeLog::for_each_after(std::uint64_t revision, const Use &use) const {
	auto block = blocks_.end();
	while (block != blocks_.begin() && std::prev(block)->last() > revision) {
		--block;
	}
	for (; block != blocks_.end(); ++block) {
		const Entries &entries = *block->entries;
		const auto begin = revision < block->raise ? entries.begin() : after(entries, revision - block->raise);
		for (auto entry = begin; entry != entries.end(); ++entry) {
			use(Entry{entry->revision + block->raise, entry->id});
		}
	}
	for (auto entry = after(open_, revision); entry != open_.end(); ++entry) {
		use(*entry);
	}
}

/// Compaction works from the last entry to the first and frees each old block as soon as its
/// entries are copied.
void ChangeLog::compact(std::size_t max_count, const ChangeLog *later) {
	IdSet seen;
	if (later != nullptr) {
		later->for_each_after(0, [&seen](const Entry &entry) { seen.insert(entry.id); });
	}
	if (!open_.empty()) {
		seal();
	}
	std::deque<Block> retained;
	Entries entries; // The latest entry comes first.
	std::size_t size = 0;
	const auto keep = [&] {
		if (!entries.empty()) {
			std::ranges::reverse(entries);
			retained.push_front({std::make_shared<const Entries>(std::exchange(entries, {})), 0});
		}
	};
	for (; !blocks_.empty() && size < max_count; blocks_.pop_back()) {
		const Block &block = blocks_.back();
		for (auto at = block.entries->rbegin(); at != block.entries->rend(); ++at) {
			if (seen.insert(at->id)) {
				entries.push_back({at->revision + block.raise, at->id});
				++size;
			}
		}
		if (entries.size() >= block_size) {
			keep();
		}
	}
	keep();
	if (!blocks_.empty()) {
		start_ = blocks_.back().last();
	}
	blocks_ = std::move(retained);
	compacted_ = size_ = size;
}

void ChangeLog::append(const ChangeLog &other, std::uint64_t revision, std::uint64_t raise) {
	constexpr std::size_t worth_sharing = block_size / 8;
	auto block = other.blocks_.begin();
	while (block != other.blocks_.end() && block->last() <= revision) {
		// No entry of this block is later than `revision`.
		++block;
	}
	for (; block != other.blocks_.end(); ++block) {
		if (block->entries->size() >= worth_sharing && block->entries->front().revision + block->raise > revision) {
			if (!open_.empty()) {
				seal();
			}
			// All entries of this block are later than `revision`, so its memory is shared.
			blocks_.push_back({block->entries, block->raise + raise});
			size_ += block->entries->size();
			continue;
		}
		for (const Entry &entry : *block->entries) {
			if (entry.revision + block->raise > revision) {
				push({entry.revision + block->raise + raise, entry.id});
			}
		}
	}
	for (const Entry &entry : other.open_) {
		if (entry.revision > revision) {
			push({entry.revision + raise, entry.id});
		}
	}
}

void ChangeLog::compact_before(const ChangeLog &later, std::size_t min_changes) {
	if (size_ + later.size_ > always_kept) {
		if (size_ > 0) {
			compact(min_changes + always_kept, &later);
		}
		compacted_ = size_ + later.size_;
	}
}

void ChangeLog::start_at(std::uint64_t revision) noexcept {
	blocks_.clear();
	open_.clear();
	size_ = compacted_ = 0;
	start_ = revision;
}

std::vector<std::uint64_t> ChangeLog::since(std::uint64_t revision) const {
	std::vector<std::uint64_t> ids;
	for_each_after(revision, [&ids](const Entry &entry) { ids.push_back(entry.id); });
	std::ranges::sort(ids);
	const auto repeated = std::unique(ids.begin(), ids.end());
	ids.erase(repeated, ids.end());
	return ids;
}

} // namespace thicket
