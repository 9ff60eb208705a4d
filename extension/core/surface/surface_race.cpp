#include "core/surface/surface_race.hpp"

#include "core/base/floating_point.hpp"
#include "core/base/progress.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace thicket {

namespace {

/// Number of cells that are decided together.
constexpr std::size_t group_size = 1024;

std::int64_t squared(const glm::ivec3 &offset) {
	return std::int64_t{offset.x} * offset.x + std::int64_t{offset.y} * offset.y + std::int64_t{offset.z} * offset.z;
}

/// Returns, for each axis, the distance from a position to the nearest one in the cell whose lower
/// corner is `low`.
glm::ivec3 gap(const glm::ivec3 &position, const glm::ivec3 &low) {
	const auto gap_along = [](std::int32_t offset) {
		return greater(greater(-offset, offset - (surface_cell_size - 1)), 0);
	};
	const glm::ivec3 offset = position - low;
	return {gap_along(offset.x), gap_along(offset.y), gap_along(offset.z)};
}

} // namespace

void SurfaceRace::start(const SurfaceSource &source, std::uint32_t level, const CellBox &box,
		const OpenFaces &open_faces, std::span<const SurfaceTriangle> triangles,
		std::span<const SurfaceDart> coarser_points) {
	source_ = source;
	level_ = level;
	open_faces_ = open_faces;
	triangles_ = triangles;
	is_undecided_ = false;
	const glm::i64vec3 origin = glm::i64vec3(box.min) << std::int64_t{surface_bits};
	coarser_cells_.clear();
	for (const SurfaceDart &dart : coarser_points) {
		coarser_cells_.emplace_back((dart.position - origin) >> std::int64_t{surface_bits});
	}
	grid_.build(box, triangles, coarser_cells_);
	times_.assign(grid_.count(), surface_time_unthrown);
	cells_.assign(grid_.count(), Cell());
	faces_.clear();
	points_.clear();
	lines_.clear();
	neighbors_.clear();
	near_points_.clear();
	for (std::size_t index = 0; index < coarser_points.size(); ++index) {
		const SurfaceDart &dart = coarser_points[index];
		accept(grid_.number_of(coarser_cells_[index]), glm::ivec3(dart.position - origin), dart.triangle, dart.time,
				dart.level);
	}
}

bool SurfaceRace::decide(
		const CellBox &output_box, const std::atomic<bool> *cancel, const std::function<void(double)> &report) {
	pending_.clear();
	for (std::uint32_t cell_index = 0; cell_index < grid_.count(); ++cell_index) {
		if (times_[cell_index] == surface_time_unthrown &&
				output_box.contains(grid_.cell(cell_index) + grid_.box().min)) {
			pending_.push_back(cell_index);
		}
	}
	// The cells are decided in groups, so that the memory of a group stays in the processor's cache.
	// All cells of a group and of the next one throw their first lines before any dart of the group
	// is decided. Otherwise, a dart would wait for one nearby cell after the other.
	std::span<std::uint32_t> remaining(pending_);
	std::span<std::uint32_t> group;
	do {
		const std::span<std::uint32_t> next = remaining.first(std::min(remaining.size(), group_size));
		remaining = remaining.subspan(next.size());
		for (const std::uint32_t cell_index : next) {
			if (times_[cell_index] == surface_time_unthrown) {
				throw_first(cell_index);
			}
		}
		if (is_cancelled(cancel) || !decide_group(group)) {
			return false;
		}
		if (report && !group.empty()) {
			const std::size_t undecided = remaining.size() + next.size();
			report(1.0 - static_cast<double>(undecided) / static_cast<double>(pending_.size()));
		}
		group = next;
	} while (!group.empty());
	return true;
}

bool SurfaceRace::decide_group(std::span<std::uint32_t> group) {
	// End times of the passes. Early darts are decided first. Their points cover most of the
	// columns of later darts, which are then never visited.
	constexpr std::array passes{0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 12.0, 18.0, 24.0,
			36.0, 48.0, 96.0, 192.0, 384.0, std::numeric_limits<double>::infinity()};
	for (const double pass : passes) {
		const auto end_time = std::bit_cast<SurfaceTime>(pass);
		std::size_t undecided_count = 0;
		for (const std::uint32_t cell_index : group) {
			if (times_[cell_index] <= end_time && !settle(cell_index, end_time)) {
				return false;
			}
			if (times_[cell_index] != surface_time_never) {
				group[undecided_count++] = cell_index;
			}
		}
		group = group.first(undecided_count);
	}
	return true;
}

bool SurfaceRace::settle(std::uint32_t cell_index, SurfaceTime end_time) {
	goals_.clear();
	goals_.push_back({cell_index, end_time});
	while (!goals_.empty()) {
		const Goal top = goals_.back();
		const SurfaceTime time = times_[top.cell];
		if (time == surface_time_unthrown) {
			throw_first(top.cell);
		} else if (time > top.end_time) {
			goals_.pop_back();
		} else if (const std::uint32_t blocker = step(top.cell); is_undecided_) {
			return false;
		} else if (blocker != none) {
			goals_.push_back({blocker, time});
		}
	}
	return true;
}

bool SurfaceRace::is_open(const Cell &cell, int axis, std::uint32_t column) {
	const SurfacePatch *face = &faces_[cell.faces];
	if (cell.face_count == 1) {
		return face->open().contains(column);
	}
	for (const SurfacePatch *end = face + cell.face_count; face != end; ++face) {
		if (face->axis() == axis && face->open().contains(column)) {
			return true;
		}
	}
	return false;
}

bool SurfaceRace::has_open_columns(const Cell &cell, int axis) {
	return std::ranges::any_of(faces_of(cell),
			[axis](const SurfacePatch &face) { return face.axis() == axis && !face.open().is_empty(); });
}

void SurfaceRace::throw_first(std::uint32_t cell_index) {
	if (cells_[cell_index].faces == none) {
		prepare(cell_index);
	}
	if (times_[cell_index] == surface_time_never) {
		return;
	}
	++counts_.cells;
	Cell &cell = cells_[cell_index];
	for (int axis = cell.search.first_axis(); axis <= cell.search.last_axis(); ++axis) {
		if (has_open_columns(cell, axis)) {
			lines_.add(cell.lines, source_.first(grid_.cell(cell_index) + grid_.box().min, axis, cell.search));
		}
	}
	show_next(cell_index);
}

std::uint32_t SurfaceRace::step(std::uint32_t cell_index) {
	const SurfaceLine line = lines_.first(cells_[cell_index].lines);
	const SurfaceLine::Course course = line.course();
	WaitingDart &waiting_dart = cells_[cell_index].waiting_dart;
	std::uint32_t first_checked = none;
	bool has_others = false;
	if (waiting_dart.hash == line.hash) {
		hits_.assign(1, {waiting_dart.offset, waiting_dart.triangle});
		first_checked = waiting_dart.first_checked;
	} else {
		has_others = find_hits(cell_index, line, course);
		if (hits_.empty() && !has_others && line.depth > 0) {
			refine(cell_index);
		}
	}
	const auto [side_u, side_v] = axes_across(line.axis);
	bool is_accepted = false;
	for (const Hit &hit : hits_) {
		glm::ivec3 position = grid_.cell(cell_index) * surface_cell_size;
		position[line.axis] += hit.offset;
		position[side_u] += course.u;
		position[side_v] += course.v;
		std::uint32_t blocker = none;
		const Verdict verdict = judge(cell_index, line.time, position, first_checked, blocker);
		if (verdict == Verdict::waits) {
			if (hits_.size() == 1) {
				waiting_dart = {line.hash, hit.offset, hit.triangle, cells_[cell_index].first_near};
			}
			return blocker;
		}
		if (verdict == Verdict::unknown) {
			is_undecided_ = true;
			undecided_ = (glm::i64vec3(grid_.box().min) << std::int64_t{surface_bits}) + glm::i64vec3(position);
			return none;
		}
		if (verdict == Verdict::accepted) {
			accept(cell_index, position, triangles_[hit.triangle].index, line.time, level_);
			is_accepted = true;
			break; // The other hits are within the radius.
		}
		++counts_.hits;
	}
	counts_.lines += is_accepted ? 0 : 1;
	if (times_[cell_index] != surface_time_never) {
		advance(cell_index, !has_others || !hits_.empty());
	}
	return none;
}

bool SurfaceRace::find_hits(std::uint32_t cell_index, const SurfaceLine &line, const SurfaceLine::Course &course) {
	hits_.clear();
	bool has_others = false;
	const glm::ivec3 low = grid_.cell(cell_index) * surface_cell_size;
	const auto [side_u, side_v] = axes_across(line.axis);
	const double u = low[side_u] + course.u;
	const double v = low[side_v] + course.v;
	for (const std::uint32_t index : grid_.triangles_in(cell_index)) {
		const SurfaceTriangle &triangle = triangles_[index];
		if (!triangle.bounds_contain(side_u, side_v, u, v)) {
			continue;
		}
		const std::optional<double> hit = triangle.hit(line.axis, u, v);
		if (!hit) {
			continue;
		}
		const double offset = *hit - low[line.axis];
		if (offset < 0 || offset >= surface_cell_size) {
			continue;
		}
		// The finest columns have only one line, whose hits are always kept, so that no gap
		// remains.
		if (line.depth == surface_depth || line.keeps(triangle.keep_probability(cells_[cell_index].search))) {
			hits_.push_back({static_cast<std::int32_t>(offset), index});
		} else {
			has_others = true;
		}
	}
	if (hits_.size() > 1) {
		const int sign = line.tries_from_above() ? -1 : 1;
		std::ranges::stable_sort(hits_, {}, [sign](const Hit &hit) { return sign * hit.offset; });
	}
	return has_others;
}

SurfaceRace::Verdict SurfaceRace::judge(std::uint32_t cell_index, SurfaceTime time, const glm::ivec3 &position,
		std::uint32_t first_checked, std::uint32_t &r_blocker) {
	for (std::uint32_t entry = cells_[cell_index].first_near; entry != first_checked;
			entry = near_points_[entry].next) {
		if (squared(position - near_points_[entry].position) < surface_radius_squared) {
			return Verdict::rejected;
		}
	}
	SurfaceTime earliest = time;
	for (const std::uint32_t neighbor : neighbors_of(cell_index)) {
		if (times_[neighbor] < earliest &&
				squared(gap(position, grid_.cell(neighbor) * surface_cell_size)) < surface_radius_squared) {
			earliest = times_[neighbor];
			r_blocker = neighbor;
		}
	}
	if (is_near_open_face(position)) {
		return Verdict::unknown;
	}
	return r_blocker == none ? Verdict::accepted : Verdict::waits;
}

bool SurfaceRace::is_near_open_face(const glm::ivec3 &position) const {
	const glm::ivec3 size = grid_.box().size() * surface_cell_size;
	const auto is_near = [&](int axis) {
		const auto side = static_cast<std::size_t>(axis);
		return (open_faces_.lower[side] && position[axis] < surface_cell_size) ||
				(open_faces_.upper[side] && position[axis] >= size[axis] - surface_cell_size);
	};
	return is_near(0) || is_near(1) || is_near(2);
}

void SurfaceRace::accept(std::uint32_t cell_index, const glm::ivec3 &position, std::uint32_t triangle, SurfaceTime time,
		std::uint32_t level) {
	++counts_.accepted;
	points_.push_back({position, triangle, level, time, cells_[cell_index].point});
	cells_[cell_index].point = static_cast<std::uint32_t>(points_.size() - 1);
	for (const std::uint32_t neighbor : neighbors_of(cell_index)) {
		if (times_[neighbor] == surface_time_never) {
			continue;
		}
		const glm::ivec3 low = grid_.cell(neighbor) * surface_cell_size;
		if (squared(gap(position, low)) < surface_radius_squared) {
			cover(neighbor, position, position - low);
			if (neighbor != cell_index) {
				show_next(neighbor);
			}
		}
	}
}

void SurfaceRace::cover(std::uint32_t cell_index, const glm::ivec3 &position, const glm::ivec3 &offset) {
	if (cells_[cell_index].faces == none) {
		prepare(cell_index);
	}
	Cell &cell = cells_[cell_index];
	if (SurfacePatch::cover(faces_of(cell), in_cells(offset))) {
		finish(cell_index);
		return;
	}
	near_points_.push_back({position, cell.first_near});
	cell.first_near = static_cast<std::uint32_t>(near_points_.size() - 1);
}

void SurfaceRace::finish(std::uint32_t cell_index) {
	lines_.drop(cells_[cell_index].lines);
	times_[cell_index] = surface_time_never;
}

void SurfaceRace::show_next(std::uint32_t cell_index) {
	Cell &cell = cells_[cell_index];
	if (cell.lines == SurfaceLines::empty) {
		return; // The cell is decided, or has not thrown its first line.
	}
	do {
		const SurfaceLine &next = lines_.first(cell.lines);
		if (is_open(cell, next.axis, next.column)) {
			times_[cell_index] = next.time;
			return;
		}
		skip_next(cell_index);
	} while (cell.lines != SurfaceLines::empty);
	times_[cell_index] = surface_time_never;
}

void SurfaceRace::skip_next(std::uint32_t cell_index) {
	Cell &cell = cells_[cell_index];
	const SurfaceLine &line = lines_.first(cell.lines);
	if (line.depth == 0) {
		skip_whole(cell_index);
	} else if (line.is_first) {
		const SurfaceColumnClocks clocks = SurfaceColumnClocks::of(line);
		show_column(cell_index, clocks, clocks.key(line.column));
	} else {
		lines_.drop_first(cell.lines);
	}
}

void SurfaceRace::advance(std::uint32_t cell_index, bool has_failed) {
	Cell &cell = cells_[cell_index];
	const SurfaceLine line = lines_.first(cell.lines);
	skip_next(cell_index);
	const bool needs_more = line.depth > 0 && is_open(cell, line.axis, line.column) &&
			(!has_failed || line.depth > surface_column_depth || may_have_gaps(cell_index, line.axis, line.column));
	if (needs_more && (!has_failed || line.time < std::bit_cast<SurfaceTime>(surface_split_time))) {
		lines_.add(cell.lines, later_line(line, cell.search));
	} else if (needs_more && line.depth < surface_depth) {
		for (std::uint32_t quarters = open_quarters(cell_index, line); quarters != 0; quarters &= quarters - 1) {
			lines_.add(cell.lines,
					quarter_line(line, static_cast<std::uint32_t>(std::countr_zero(quarters)), cell.search));
		}
	}
	if (cell.lines == SurfaceLines::empty) {
		times_[cell_index] = surface_time_never;
	}
	show_next(cell_index);
}

void SurfaceRace::skip_whole(std::uint32_t cell_index) {
	Cell &cell = cells_[cell_index];
	SurfaceLine line = lines_.first(cell.lines);
	do {
		move_to_next(line, cell.search);
	} while (line.time < std::bit_cast<SurfaceTime>(surface_search_time) && !is_open(cell, line.axis, line.column));
	if (line.time < std::bit_cast<SurfaceTime>(surface_search_time)) {
		lines_.replace_first(cell.lines, line);
	} else {
		show_column(cell_index, {line.hash}, ~SurfaceColumnClocks::Key{0});
	}
}

void SurfaceRace::show_column(
		std::uint32_t cell_index, const SurfaceColumnClocks &clocks, SurfaceColumnClocks::Key before) {
	Cell &cell = cells_[cell_index];
	const SurfaceLine &line = lines_.first(cell.lines);
	SurfaceColumnClocks::Key next = 0;
	for (const SurfacePatch &face : faces_of(cell)) {
		if (face.axis() != line.axis) {
			continue;
		}
		for (std::uint32_t word = 0; word < surface_column_count / 64; ++word) {
			for (std::uint64_t open_bits = face.open().word(word); open_bits != 0; open_bits &= open_bits - 1) {
				const SurfaceColumnClocks::Key key =
						clocks.key(64 * word + static_cast<std::uint32_t>(std::countr_zero(open_bits)));
				next = key < before ? std::max(next, key) : next;
			}
		}
	}
	if (next == 0) {
		lines_.drop_first(cell.lines);
	} else {
		lines_.replace_first(cell.lines,
				clocks.first(SurfaceColumnClocks::column_of(next), line.axis,
						static_cast<std::uint32_t>(line.time & surface_tag_bits), cell.search));
	}
}

std::uint32_t SurfaceRace::open_quarters(std::uint32_t cell_index, const SurfaceLine &line) {
	const int axis = line.axis;
	const glm::ivec3 low = grid_.cell(cell_index) * surface_cell_size;
	const auto [side_u, side_v] = axes_across(axis);
	const std::int32_t width = line.width() / 2;
	std::uint32_t open_bits = 0;
	for (const std::uint32_t index : grid_.triangles_in(cell_index)) {
		const SurfaceTriangle &triangle = triangles_[index];
		if (!triangle.is_over(axis, low[side_u] + line.low_u(), low[side_v] + line.low_v(), line.width())) {
			continue;
		}
		const SurfaceOutline outline(triangle, axis);
		for (std::uint32_t quarter = 0; quarter < 4; ++quarter) {
			if ((open_bits >> quarter & 1) != 0) {
				continue;
			}
			glm::ivec3 from = low;
			from[side_u] += line.low_u() + static_cast<std::int32_t>(quarter & 1) * width;
			from[side_v] += line.low_v() + static_cast<std::int32_t>(quarter >> 1) * width;
			const SurfaceRange range = outline.range_in(from[side_u], from[side_v], width);
			const double first = std::max(range.low, static_cast<double>(low[axis]));
			const double last = std::min(range.high, static_cast<double>(low[axis] + surface_cell_size - 1));
			if (first > last) {
				continue;
			}
			glm::ivec3 to = from + (width - 1);
			from[axis] = static_cast<std::int32_t>(first);
			to[axis] = static_cast<std::int32_t>(last);
			open_bits |= std::uint32_t{!is_covered(cell_index, from, to)} << quarter;
		}
	}
	return open_bits;
}

bool SurfaceRace::is_covered(std::uint32_t cell_index, const glm::ivec3 &from, const glm::ivec3 &to) const {
	for (std::uint32_t entry = cells_[cell_index].first_near; entry != none; entry = near_points_[entry].next) {
		const glm::ivec3 &point = near_points_[entry].position;
		if (squared(glm::max(point - from, to - point)) < surface_radius_squared) {
			return true;
		}
	}
	return false;
}

std::span<const std::uint32_t> SurfaceRace::neighbors_of(std::uint32_t cell_index) {
	Cell &cell = cells_[cell_index];
	if (cell.neighbors == none) {
		cell.neighbors = static_cast<std::uint32_t>(neighbors_.size());
		grid_.append_neighbors(cell_index, neighbors_);
		cell.neighbor_count = static_cast<std::uint32_t>(neighbors_.size()) - cell.neighbors;
	}
	return std::span(neighbors_).subspan(cell.neighbors, cell.neighbor_count);
}

void SurfaceRace::append_points(const CellBox &output_box, std::vector<SurfaceDart> &r_points) const {
	const glm::i64vec3 origin = glm::i64vec3(grid_.box().min) << std::int64_t{surface_bits};
	for (std::uint32_t cell_index = 0; cell_index < grid_.count(); ++cell_index) {
		if (cells_[cell_index].point == none || !output_box.contains(grid_.cell(cell_index) + grid_.box().min)) {
			continue;
		}
		for (std::uint32_t index = cells_[cell_index].point; index != none; index = points_[index].previous) {
			const Point &point = points_[index];
			r_points.push_back({origin + glm::i64vec3(point.position), point.time, point.level, point.triangle});
		}
	}
}

std::size_t SurfaceRace::bytes() const {
	return grid_.bytes() + faces_.capacity() * sizeof(SurfacePatch) + near_points_.capacity() * sizeof(NearPoint) +
			pending_.capacity() * sizeof(std::uint32_t) + cells_.capacity() * sizeof(Cell) +
			points_.capacity() * sizeof(Point) + lines_.bytes() + times_.capacity() * sizeof(SurfaceTime) +
			neighbors_.capacity() * sizeof(std::uint32_t);
}

} // namespace thicket
