#include "nodes/ground/changed_areas.hpp"

#include <algorithm>
#include <cstddef>

namespace thicket {

namespace {

/// The maximum number of separate areas. Beyond this number, separate areas cost the receiver more
/// than regenerating the tiles between them.
constexpr std::size_t max_areas = 64;

} // namespace

void add_changed_area(std::vector<Rect> &r_areas, const Rect &area) {
	if (area.empty()) {
		return;
	}
	Rect merged = area;
	const auto touches_merged = [&merged](const Rect &other) {
		return meet(other, merged);
	};
	for (auto overlap = std::ranges::find_if(r_areas, touches_merged); overlap != r_areas.end();
			overlap = std::ranges::find_if(r_areas, touches_merged)) {
		merged = united(merged, *overlap);
		r_areas.erase(overlap);
	}
	r_areas.push_back(merged);
	if (r_areas.size() > max_areas) {
		for (const Rect &other : r_areas) {
			merged = united(merged, other);
		}
		r_areas.assign(1, merged);
	}
}

} // namespace thicket
