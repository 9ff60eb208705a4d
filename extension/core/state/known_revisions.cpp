#include "core/state/known_revisions.hpp"

#include <algorithm>

namespace thicket {

std::uint64_t KnownRevisions::of(std::uint64_t origin) const {
	const auto found = std::ranges::find(entries_, origin, [](const auto &entry) { return entry.first; });
	return found != entries_.end() ? found->second : 0;
}

void KnownRevisions::set(std::uint64_t origin, std::uint64_t revision) noexcept {
	std::erase_if(entries_, [origin](const auto &entry) { return entry.first == origin; });
	if (entries_.size() == capacity) {
		entries_.erase(entries_.begin());
	}
	entries_.emplace_back(origin, revision);
}

} // namespace thicket
