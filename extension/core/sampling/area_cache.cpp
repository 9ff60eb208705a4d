#include "core/sampling/area_cache.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <mutex>
#include <utility>

namespace thicket {

namespace {

/// Maximum number of cached areas. A request checks all of them.
constexpr std::size_t most_areas = 4096;

/// Maximum width and height, in parts, of an area that is decided as a whole.
constexpr std::int32_t widest_area = 18;

/// Returns a rectangle of cells, expanded to whole parts.
CellRect whole_parts(const CellRect &cells) {
	constexpr std::int32_t last = SettledArea::part_width - 1;
	return {cells.min & ~last, (cells.max + last) & ~last};
}

bool overlap(const CellRect &a, const CellRect &b) {
	return a.min.x < b.max.x && b.min.x < a.max.x && a.min.y < b.max.y && b.min.y < a.max.y;
}

/// Returns the number of parts of the first of the equal areas into which `parts` are divided.
std::int32_t first_share(std::int32_t parts) {
	const std::int32_t count = (parts + widest_area - 1) / widest_area;
	return (parts + count - 1) / count;
}

} // namespace

SettledArea::SettledArea(const LevelGrid &grid, const CellRect &cells) : cells_(cells) {
	const glm::ivec2 count = cells.size() / part_width;
	parts_.reserve(static_cast<std::size_t>(count.x) * static_cast<std::size_t>(count.y));
	std::size_t points = 0;
	for (std::int32_t y = cells.min.y; y < cells.max.y; y += part_width) {
		for (std::int32_t x = cells.min.x; x < cells.max.x; x += part_width) {
			Part &part = parts_.emplace_back();
			part.begin = static_cast<std::uint32_t>(points);
			for (std::int32_t row = 0; row < part_width; ++row) {
				const LevelGrid::PointOffset *first = grid.point.data() + grid.index_of({x, y + row});
				for (std::int32_t column = 0; column < part_width; ++column) {
					const std::uint64_t bit = first[column] != LevelGrid::no_point ? 1 : 0;
					part.points |= bit << (part_width * row + column);
				}
			}
			points += static_cast<std::size_t>(std::popcount(part.points));
		}
	}
	points_.resize(points);
	const Part *part = parts_.data();
	Point *to = points_.data();
	for (std::int32_t y = cells.min.y; y < cells.max.y; y += part_width) {
		for (std::int32_t x = cells.min.x; x < cells.max.x; x += part_width, ++part) {
			const std::uint32_t corner = grid.index_of({x, y});
			for (std::uint64_t rest = part->points; rest != 0; rest &= rest - 1) {
				const auto cell = static_cast<std::uint32_t>(std::countr_zero(rest));
				const std::uint32_t index = corner + cell / part_width * grid.stride + cell % part_width;
				*to++ = {grid.point[index], grid.dart[index]};
			}
		}
	}
}

void AreaCache::find(
		const PointSet &set, const CellRect &window, std::vector<std::shared_ptr<const SettledArea>> &r_areas) {
	r_areas.clear();
	const std::lock_guard lock(mutex_);
	++clock_;
	for (Entry &entry : entries_) {
		if (entry.set == set && overlap(entry.area->cells(), window)) {
			entry.used = clock_;
			r_areas.push_back(entry.area);
		}
	}
}

void AreaCache::add(const PointSet &set, std::shared_ptr<const SettledArea> area) {
	const std::lock_guard lock(mutex_);
	bytes_ += area->bytes();
	entries_.push_back({set, std::move(area), ++clock_});
	while (bytes_ > limit_ || entries_.size() > most_areas) {
		const auto oldest = std::ranges::min_element(entries_, {}, &Entry::used);
		bytes_ -= oldest->area->bytes();
		entries_.erase(oldest);
	}
}

std::size_t AreaCache::bytes() const {
	const std::lock_guard lock(mutex_);
	return bytes_;
}

AreaWindow::AreaWindow(AreaCache &cache, const PointSet &set, const CellRect &window) :
		cache_(cache), set_(set), cells_(whole_parts(window)), parts_(cells_.size() / SettledArea::part_width) {
	owners_.assign(static_cast<std::size_t>(parts_.x) * static_cast<std::size_t>(parts_.y), missing);
	cache_.find(set, cells_, areas_);
	for (std::size_t i = 0; i < areas_.size(); ++i) {
		own(areas_[i]->cells(), static_cast<std::uint16_t>(i));
	}
}

/// Marks the parts of the window that lie in `cells` as those of an area.
void AreaWindow::own(const CellRect &cells, std::uint16_t owner) {
	const glm::ivec2 first = part_of(glm::max(cells.min, cells_.min));
	const glm::ivec2 end = part_of(glm::min(cells.max, cells_.max));
	for (std::int32_t y = first.y; y < end.y; ++y) {
		std::fill_n(owners_.data() + index_of({first.x, y}), end.x - first.x, owner);
	}
}

/// Returns true if the parts of a row from `first` to the column `end_x` are all missing.
bool AreaWindow::is_missing(glm::ivec2 first, std::int32_t end_x) const {
	const std::uint16_t *row = owners_.data() + index_of(first);
	return std::all_of(row, row + (end_x - first.x), [](std::uint16_t owner) { return owner == missing; });
}

bool AreaWindow::next_missing(CellRect &r_cells) {
	const auto found = std::ranges::find(owners_, missing);
	if (found == owners_.end()) {
		return false;
	}
	const auto index = static_cast<std::int32_t>(found - owners_.begin());
	const glm::ivec2 first(index % parts_.x, index / parts_.x);
	glm::ivec2 end = first + 1;
	while (end.x < parts_.x && is_missing({end.x, first.y}, end.x + 1)) {
		++end.x;
	}
	end.x = first.x + first_share(end.x - first.x);
	while (end.y < parts_.y && is_missing({first.x, end.y}, end.x)) {
		++end.y;
	}
	end.y = first.y + first_share(end.y - first.y);
	next_ = r_cells = {cells_.min + first * SettledArea::part_width, cells_.min + end * SettledArea::part_width};
	return true;
}

void AreaWindow::settle(const LevelGrid &grid) {
	areas_.push_back(std::make_shared<const SettledArea>(grid, next_));
	own(next_, static_cast<std::uint16_t>(areas_.size() - 1));
	cache_.add(set_, areas_.back());
}

} // namespace thicket
