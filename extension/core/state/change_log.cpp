#include "core/state/change_log.hpp"

#include "core/base/guard.hpp"
#include "core/state/id_table.hpp"

#include <algorithm>
#include <utility>

namespace thicket {

namespace {

constexpr std::size_t always_kept = 65536;

} // namespace

void ChangeLog::note(std::uint64_t revision, std::uint64_t id, std::size_t held) noexcept {
	const Status status = guarded("changes", static_cast<double>(held), [&] {
		entries_.push_back({revision, id});
		if (entries_.size() > 2 * compacted_ + always_kept) {
			compact(held + always_kept);
		}
	});
	if (!status.ok()) {
		start_at(revision);
	}
}

void ChangeLog::compact(std::size_t most) {
	IdTable seen;
	std::deque<Entry> kept;
	for (; !entries_.empty() && kept.size() < most; entries_.pop_back()) { // Memory goes from one to the other.
		if (seen.insert(entries_.back().id)) {
			kept.push_front(entries_.back());
		}
	}
	if (!entries_.empty()) {
		start_ = entries_.back().revision;
	}
	entries_ = std::move(kept);
	compacted_ = entries_.size();
}

void ChangeLog::start_at(std::uint64_t revision) noexcept {
	entries_.clear();
	compacted_ = 0;
	start_ = revision;
}

std::vector<std::uint64_t> ChangeLog::since(std::uint64_t revision) const {
	const auto first = std::ranges::upper_bound(entries_, revision, {}, &Entry::revision);
	std::vector<std::uint64_t> ids;
	for (auto entry = first; entry != entries_.end(); ++entry) {
		ids.push_back(entry->id);
	}
	std::ranges::sort(ids);
	const auto repeated = std::unique(ids.begin(), ids.end());
	ids.erase(repeated, ids.end());
	return ids;
}

} // namespace thicket
