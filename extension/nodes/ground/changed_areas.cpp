#include "nodes/ground/changed_areas.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <cstddef>

namespace thicket {

namespace {

/// The maximum number of separate areas. Beyond this number, separate areas cost the receiver more
/// than regenerating the tiles between them.
constexpr std::size_t max_areas = 64;

} // namespace

Rect around(const Rect &a, const Rect &b) { return {glm::min(a.min, b.min), glm::max(a.max, b.max)}; }

void add_changed_area(std::vector<Rect> &r_areas, const Rect &area) {
	if (area.empty()) {
		return;
	}
	Rect added = area;
	const auto meets = [&added](const Rect &other) {
		return meet(other, added);
	};
	for (auto met = std::ranges::find_if(r_areas, meets); met != r_areas.end();
			met = std::ranges::find_if(r_areas, meets)) {
		added = around(added, *met);
		r_areas.erase(met);
	}
	r_areas.push_back(added);
	if (r_areas.size() > max_areas) {
		for (const Rect &other : r_areas) {
			added = around(added, other);
		}
		r_areas.assign(1, added);
	}
}

} // namespace thicket
