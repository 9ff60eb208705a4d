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

constexpr std::uint32_t sub_cubes = 4; // Per side of a cell.
constexpr int sub_shift = surface_bits - 2;

/// The least whole number whose square is not below radius^2. Positions that differ by more than this on one axis are
/// farther apart than the radius.
constexpr std::int32_t radius_units = 1816187;
static_assert(std::int64_t{radius_units} * radius_units >= surface_radius_squared &&
		std::int64_t{radius_units - 1} * (radius_units - 1) < surface_radius_squared);

/// The sub-cubes of a cube that is at most two halvings deep, or the sub-cube that contains it.
constexpr std::uint64_t sub_cubes_of(const glm::ivec3 &low, int depth) {
	const glm::ivec3 first = low >> sub_shift;
	const std::uint32_t wide = depth == 0 ? 4 : depth == 1 ? 2 : 1;
	const std::uint64_t row = (std::uint64_t{1} << wide) - 1;
	std::uint64_t result = 0;
	for (std::uint32_t z = 0; z < wide; ++z) {
		for (std::uint32_t y = 0; y < wide; ++y) {
			result |= row << (4 * (static_cast<std::uint32_t>(first.y) + y) +
							  16 * (static_cast<std::uint32_t>(first.z) + z));
		}
	}
	return result << first.x;
}

/// The sub-cubes that the plane of a triangle may enter, in a cell with its lower corner at `low`.
std::uint64_t sub_cubes_near(const SurfaceTriangle &triangle, const glm::dvec3 &low) {
	constexpr double width = surface_cell_size / static_cast<double>(sub_cubes);
	const glm::dvec3 &normal = triangle.normal;
	const glm::dvec3 middle = low + width / 2.0 - triangle.corners[0];
	const double first = normal.x * middle.x + normal.y * middle.y + normal.z * middle.z;
	// A little more than needed, because the distances of the other sub-cubes are rounded several times.
	const double reach = (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z)) * (width / 2.0 + 1.0);
	std::uint64_t result = 0;
	std::uint32_t bit = 0;
	for (int z = 0; z < 4; ++z) {
		for (int y = 0; y < 4; ++y) {
			const double row = first + width * (normal.y * y + normal.z * z);
			for (int x = 0; x < 4; ++x) {
				const bool near = std::abs(row + width * normal.x * x) <= reach;
				result |= std::uint64_t{near} << bit++;
			}
		}
	}
	return result;
}

/// One axis for a cell if all normals in it are near enough to it.
SurfaceSearch search_for(const glm::dvec3 &least) {
	// At least one axis of every plane reaches the last value, because 1 / sqrt(3) is larger. Most ground is not steep,
	// so y comes first.
	for (const float kept : {0.95f, 0.85f, 0.7f, 0.55f}) {
		for (const std::uint8_t axis : {std::uint8_t{1}, std::uint8_t{0}, std::uint8_t{2}}) {
			if (least[axis] >= static_cast<double>(kept)) {
				return {axis, kept};
			}
		}
	}
	return {};
}

std::int64_t squared(const glm::ivec3 &offset) {
	return std::int64_t{offset.x} * offset.x + std::int64_t{offset.y} * offset.y + std::int64_t{offset.z} * offset.z;
}

} // namespace

void SurfaceRace::start(const SurfaceSource &source, std::uint32_t level, const CellBox &box,
		const OpenFaces &open_faces, std::span<const SurfaceTriangle> triangles, std::span<const SurfaceDart> placed) {
	source_ = source;
	level_ = level;
	open_faces_ = open_faces;
	triangles_ = triangles;
	is_undecided_ = false;
	const glm::i64vec3 origin = glm::i64vec3(box.min) << std::int64_t{surface_bits};
	extra_.clear();
	for (const SurfaceDart &dart : placed) {
		extra_.emplace_back((dart.position - origin) >> std::int64_t{surface_bits});
	}
	grid_.build(box, triangles, extra_);
	cells_.assign(grid_.count(), Cell());
	points_.clear();
	lines_.clear();
	neighbors_.clear();
	for (std::size_t index = 0; index < placed.size(); ++index) {
		const SurfaceDart &dart = placed[index];
		accept(grid_.number_of(extra_[index]), glm::ivec3(dart.position - origin), dart.triangle, dart.time,
				dart.level);
	}
}

bool SurfaceRace::decide(const CellBox &wanted, const std::atomic<bool> *cancel) {
	// Early darts first: their points cover most cubes of the later ones, which then are never visited.
	constexpr std::array passes{0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 32.0, std::numeric_limits<double>::infinity()};
	for (const double pass : passes) {
		const auto until = std::bit_cast<SurfaceTime>(pass);
		for (std::uint32_t number = 0; number < grid_.count(); ++number) {
			if (cells_[number].time <= until && wanted.contains(grid_.cell(number) + grid_.box().min) &&
					!settle(number, until)) {
				return false;
			}
			if ((number & 1023u) == 0 && is_cancelled(cancel)) {
				return false;
			}
		}
	}
	return true;
}

bool SurfaceRace::settle(std::uint32_t number, SurfaceTime until) {
	wanted_.clear();
	wanted_.push_back({number, until});
	while (!wanted_.empty()) {
		const Wanted top = wanted_.back();
		const SurfaceTime time = cells_[top.cell].time;
		if (time == surface_time_unthrown) {
			throw_first(top.cell);
		} else if (time > top.until) {
			wanted_.pop_back();
		} else if (const std::uint32_t blocker = step(top.cell); is_undecided_) {
			return false;
		} else if (blocker != none) {
			wanted_.push_back({blocker, time});
		}
	}
	return true;
}

void SurfaceRace::throw_first(std::uint32_t number) {
	Cell &cell = cells_[number];
	const glm::dvec3 low = glm::dvec3(grid_.cell(number)) * static_cast<double>(surface_cell_size);
	std::uint64_t entered = 0;
	glm::dvec3 least(1.0);
	for (const std::uint32_t index : grid_.triangles_in(number)) {
		const SurfaceTriangle &triangle = triangles_[index];
		entered |= sub_cubes_near(triangle, low);
		least = glm::min(least, glm::abs(triangle.normal) / triangle.length);
	}
	cell.open &= entered;
	cell.search = search_for(least);
	cell.time = surface_time_never;
	++counts_.cells;
	if (cell.open != 0) {
		lines_.add(cell.lines, source_.first(grid_.cell(number) + grid_.box().min, cell.search));
		show_next(number);
	}
}

std::uint32_t SurfaceRace::step(std::uint32_t number) {
	const SurfaceLine line = lines_.first(cells_[number].lines);
	const SurfaceLine::Course course = line.course(cells_[number].search);
	find_hits(number, line, course);
	const glm::ivec3 low = grid_.cell(number) * surface_cell_size;
	const auto [side_u, side_v] = axes_across(course.axis);
	for (const Hit &hit : hits_) {
		glm::ivec3 position = low;
		position[course.axis] += hit.along;
		position[side_u] += course.u;
		position[side_v] += course.v;
		std::uint32_t blocker = none;
		switch (judge(number, line.time, position, blocker)) {
			case Fate::accepted:
				accept(number, position, triangles_[hit.triangle].index, line.time, level_);
				return none;
			case Fate::waits: return blocker;
			case Fate::unknown:
				is_undecided_ = true;
				undecided_ = (glm::i64vec3(grid_.box().min) << std::int64_t{surface_bits}) + glm::i64vec3(position);
				return none;
			case Fate::rejected: break;
		}
	}
	++counts_.lines;
	counts_.hits += hits_.size();
	replace_line(number, !hits_.empty());
	return none;
}

void SurfaceRace::find_hits(std::uint32_t number, const SurfaceLine &line, const SurfaceLine::Course &course) {
	hits_.clear();
	const glm::ivec3 low = grid_.cell(number) * surface_cell_size;
	const auto [side_u, side_v] = axes_across(course.axis);
	const double u = low[side_u] + course.u;
	const double v = low[side_v] + course.v;
	const std::int32_t first = line.low()[course.axis];
	for (const std::uint32_t index : grid_.triangles_in(number)) {
		const std::optional<double> hit = triangles_[index].hit(course.axis, u, v);
		if (!hit) {
			continue;
		}
		const double along = *hit - low[course.axis];
		if (along < first || along >= first + line.width()) {
			continue;
		}
		const auto place = static_cast<std::int32_t>(along);
		if (line.keeps(triangles_[index].keep_probability(cells_[number].search))) {
			hits_.push_back({place, index});
		}
	}
	if (hits_.size() > 1) {
		const int sign = line.tries_from_above() ? -1 : 1;
		std::ranges::stable_sort(hits_, {}, [sign](const Hit &hit) { return sign * hit.along; });
	}
}

SurfaceRace::Fate SurfaceRace::judge(
		std::uint32_t number, SurfaceTime time, const glm::ivec3 &position, std::uint32_t &r_blocker) {
	const glm::ivec3 within = position - grid_.cell(number) * surface_cell_size;
	if ((cells_[number].open & sub_cubes_of(within, 2)) == 0) {
		return Fate::rejected;
	}
	SurfaceTime earliest = time;
	for (const std::uint32_t near : neighbors_of(number)) {
		const Cell &cell = cells_[near];
		if (cell.point != none && squared(points_[cell.point].position - position) < surface_radius_squared) {
			return Fate::rejected;
		}
		if (cell.time < earliest) {
			const glm::ivec3 low = grid_.cell(near) * surface_cell_size;
			const glm::ivec3 nearest = glm::clamp(position, low, low + (surface_cell_size - 1));
			if (squared(nearest - position) < surface_radius_squared) {
				earliest = cell.time;
				r_blocker = near;
			}
		}
	}
	if (is_near_open_face(position)) {
		return Fate::unknown;
	}
	return r_blocker == none ? Fate::accepted : Fate::waits;
}

bool SurfaceRace::is_near_open_face(const glm::ivec3 &position) const {
	const glm::ivec3 size = grid_.box().size() * surface_cell_size;
	const auto is_near = [&](int axis) {
		const auto side = static_cast<std::size_t>(axis);
		return (open_faces_.lower[side] && position[axis] < radius_units) ||
				(open_faces_.upper[side] && position[axis] >= size[axis] - radius_units);
	};
	return is_near(0) || is_near(1) || is_near(2);
}

void SurfaceRace::accept(std::uint32_t number, const glm::ivec3 &position, std::uint32_t triangle, SurfaceTime time,
		std::uint32_t level) {
	++counts_.accepted;
	Cell &cell = cells_[number];
	lines_.drop(cell.lines);
	cell.time = surface_time_never;
	cell.open = 0;
	cell.point = static_cast<std::uint32_t>(points_.size());
	points_.push_back({position, triangle, level, time});
	for (const std::uint32_t near : neighbors_of(number)) {
		if (cells_[near].open != 0) {
			cover(position, near);
		}
	}
}

void SurfaceRace::cover(const glm::ivec3 &position, std::uint32_t number) {
	// Coarser units, in which squares are floats without rounding. Numbers are rounded away from the point, so that
	// everything that counts as covered is covered.
	constexpr int shift = 10;
	constexpr std::int32_t width = 1 << (sub_shift - shift);
	constexpr float limit = static_cast<float>(surface_radius_squared >> (2 * shift));
	const glm::ivec3 offset = grid_.cell(number) * surface_cell_size - position;
	const auto farthest = [](std::int32_t first) {
		std::array<float, sub_cubes> squares{};
		std::int32_t low = first >> shift;
		for (float &square : squares) {
			const auto distance = static_cast<float>(std::max(-low, low + width + 1));
			square = distance * distance;
			low += width;
		}
		return squares;
	};
	const std::array<float, sub_cubes> far_x = farthest(offset.x);
	const std::array<float, sub_cubes> far_y = farthest(offset.y);
	const std::array<float, sub_cubes> far_z = farthest(offset.z);
	std::uint64_t open = 0;
	std::uint32_t bit = 0;
	for (const float z : far_z) {
		for (const float y : far_y) {
			const float left = limit - y - z;
			for (const float x : far_x) {
				open |= std::uint64_t{x > left} << bit++;
			}
		}
	}
	Cell &cell = cells_[number];
	cell.open &= open;
	if (cell.open == 0) {
		lines_.drop(cell.lines);
		cell.time = surface_time_never;
	}
}

void SurfaceRace::replace_line(std::uint32_t number, bool had_darts) {
	Cell &cell = cells_[number];
	const SurfaceLine line = lines_.take_first(cell.lines);
	if (!had_darts && line.tried + 1u < SurfaceLine::tries) {
		lines_.add(cell.lines, next_line(line, cell.search));
	} else if (line.depth < surface_depth) {
		split(number, line);
	}
	show_next(number);
}

void SurfaceRace::split(std::uint32_t number, const SurfaceLine &line) {
	const std::int32_t half = (surface_cell_size >> line.depth) / 2;
	for (std::uint32_t child = 0; child < 8; ++child) {
		const glm::ivec3 low = line.low() + glm::ivec3(child & 1u, child >> 1 & 1u, child >> 2) * half;
		if ((cells_[number].open & sub_cubes_of(low, line.depth + 1)) != 0) {
			const SurfaceLine first = child_line(line, child, cells_[number].search);
			if (first.depth <= 2 || is_open(number, first)) {
				lines_.add(cells_[number].lines, first);
			}
		}
	}
}

bool SurfaceRace::is_open(std::uint32_t number, const SurfaceLine &cube) {
	const SurfaceCube bounds = cube_of(number, cube);
	const glm::ivec3 low(bounds.low);
	const std::int32_t width = cube.width();
	for (const std::uint32_t near : neighbors_of(number)) {
		if (cells_[near].point != none) {
			const glm::ivec3 offset = low - points_[cells_[near].point].position;
			if (squared(glm::max(-offset, offset + (width - 1))) < surface_radius_squared) {
				return false;
			}
		}
	}
	const std::span<const std::uint32_t> inside = grid_.triangles_in(number);
	return std::ranges::any_of(
			inside, [this, &bounds](std::uint32_t index) { return triangles_[index].enters(bounds); });
}

void SurfaceRace::show_next(std::uint32_t number) {
	Cell &cell = cells_[number];
	while (cell.lines != SurfaceLines::empty) {
		const SurfaceLine &first = lines_.first(cell.lines);
		if ((cell.open & sub_cubes_of(first.low(), first.depth)) != 0) {
			cell.time = first.time;
			return;
		}
		lines_.take_first(cell.lines);
	}
	cell.time = surface_time_never;
}

std::span<const std::uint32_t> SurfaceRace::neighbors_of(std::uint32_t number) {
	Cell &cell = cells_[number];
	if (cell.neighbors == none) {
		cell.neighbors = static_cast<std::uint32_t>(neighbors_.size());
		grid_.append_neighbors(number, neighbors_);
		cell.neighbor_count = static_cast<std::uint32_t>(neighbors_.size()) - cell.neighbors;
	}
	return std::span(neighbors_).subspan(cell.neighbors, cell.neighbor_count);
}

SurfaceCube SurfaceRace::cube_of(std::uint32_t number, const SurfaceLine &line) const {
	return {glm::dvec3(grid_.cell(number) * surface_cell_size + line.low()), static_cast<double>(line.width())};
}

void SurfaceRace::append_points(const CellBox &wanted, std::vector<SurfaceDart> &r_points) const {
	const glm::i64vec3 origin = glm::i64vec3(grid_.box().min) << std::int64_t{surface_bits};
	for (std::uint32_t number = 0; number < grid_.count(); ++number) {
		if (cells_[number].point != none && wanted.contains(grid_.cell(number) + grid_.box().min)) {
			const Point &point = points_[cells_[number].point];
			r_points.push_back({origin + glm::i64vec3(point.position), point.time, point.level, point.triangle});
		}
	}
}

std::size_t SurfaceRace::bytes() const {
	return grid_.bytes() + cells_.capacity() * sizeof(Cell) + points_.capacity() * sizeof(Point) + lines_.bytes() +
			neighbors_.capacity() * sizeof(std::uint32_t);
}

} // namespace thicket
