#include "core/sampling/level_grid.hpp"

namespace thicket {

namespace {

/// Vector loads may read this many cells past the end of a row.
constexpr std::uint32_t overread = 16;

template <typename T>
std::size_t bytes_of(const std::vector<T> &buffer) {
	return buffer.capacity() * sizeof(T);
}

} // namespace

void LevelGrid::reset(const CellRect &p_cells) {
	cells = p_cells;
	const glm::ivec2 size = cells.size() + 2 * border;
	stride = static_cast<std::uint32_t>(size.x);
	const std::size_t count = std::size_t{stride} * static_cast<std::size_t>(size.y) + overread;
	// Checks the array that is resized last, because a failed allocation may leave the earlier ones
	// larger.
	if (open.size() < count) {
		time.resize(count);
		dart.resize(count);
		point.resize(count);
		waiting.resize(count);
		requester.resize(count);
		open.resize(count);
	}
	sentinel = static_cast<std::uint32_t>(count) - 1;
	time[sentinel] = time_never;
	dart[sentinel] = 0;
	waiting[sentinel] = 0;
	open[sentinel] = 0;
	if (coarser != nullptr) {
		ready.assign(count, 0);
	}
	waiting_squares.clear();
	undecided = nowhere;
	accepted = darts = squares = 0;
}

std::size_t LevelGrid::bytes() const {
	return bytes_of(time) + bytes_of(dart) + bytes_of(point) + bytes_of(waiting) + bytes_of(open) + bytes_of(ready) +
			waiting_squares.bytes() + bytes_of(requester) + bytes_of(wanted) + bytes_of(round) + bytes_of(listed) +
			bytes_of(due);
}

} // namespace thicket
