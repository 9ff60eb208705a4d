#include "core/surface/surface_sampler.hpp"

#include "core/base/check.hpp"
#include "core/base/guard.hpp"
#include "core/base/instance_id.hpp"
#include "core/sampling/rank.hpp"
#include "core/surface/surface_race.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <utility>

namespace thicket {

namespace {

/// Largest side, in cells, of a block that is decided as a whole. Its margin is small in
/// comparison.
constexpr std::int32_t widest_block = 256;

/// Cells are in [-surface_cell_limit, surface_cell_limit) on each axis, so that doubles represent
/// all positions in units exactly.
constexpr std::int32_t surface_cell_limit = 1 << 30;

constexpr double sqrt_3 = 1.7320508075688772;

/// Returns the width in cells of a margin that is given in cubes of ids, which are radius / sqrt(3)
/// wide. The result is rounded up.
constexpr std::int32_t margin_in_cells(std::int32_t margin) { return (7 * margin + 11) / 12; }

double level_unit(const PointSet &set, std::uint32_t level) {
	return surface_unit(set) * static_cast<double>(1u << level);
}

/// Rounds a position in meters to the lattice. `unit` is the distance of lattice positions.
glm::dvec3 to_lattice(const glm::dvec3 &position, double unit) {
	const glm::dvec3 units = position / unit + 0.5;
	return {floor_of(units.x), floor_of(units.y), floor_of(units.z)};
}

glm::ivec3 cell_of(const glm::dvec3 &units) {
	return glm::ivec3(glm::floor(units / static_cast<double>(surface_cell_size)));
}

/// Returns the cells that contain a box whose corners are rounded to units.
CellBox cells_around(const Box3 &box, double unit) {
	return {cell_of(to_lattice(box.min, unit)), cell_of(to_lattice(box.max, unit)) + 1};
}

/// Returns the box of cells in meters, extended by one unit on each side, so that rounding
/// moves no vertex out of it.
Box3 world_box(const CellBox &cells, double unit) {
	const double width = unit * surface_cell_size;
	return {glm::dvec3(cells.min) * width - unit, glm::dvec3(cells.max) * width + unit};
}

/// Returns the cells of the next coarser level that cover `cells` and a margin of the finer level's radius
/// around them.
CellBox coarse_cells_around(const CellBox &cells) {
	return {(cells.min - surface_reach) >> 1, ((cells.max + surface_reach - 1) >> 1) + 1};
}

std::int32_t longest_side(const glm::ivec3 &size) { return std::max({size.x, size.y, size.z}); }

glm::ivec3 dart_cell(const SurfaceDart &dart) { return glm::ivec3(dart.position >> std::int64_t{surface_bits}); }

/// Returns the cell of a dart's id. These cells are cubes with a side of radius / sqrt(3), so that
/// none contains two points.
glm::ivec3 id_cell(const SurfaceDart &dart) {
	return glm::ivec3(glm::floor(glm::dvec3(dart.position) * (sqrt_3 / surface_cell_size)));
}

std::uint32_t rank_of(const PointSet &set, const SurfaceDart &dart) {
	// The time is converted to that on the plane, where clocks have a rate of 1 for an area of
	// radius^2 / 2 instead of radius^2.
	const double time = std::bit_cast<double>(dart.time) * 0.5;
	return thicket::rank_of(set.levels, dart.level, std::bit_cast<TimeKey>(static_cast<float>(time)));
}

Status validate_window(const Box3 &window) {
	for (int side = 0; side < 3; ++side) {
		for (const double bound : {window.min[side], window.max[side]}) {
			if (!std::isfinite(bound)) {
				return {ErrorCode::not_finite, "window", bound};
			}
		}
		if (window.max[side] < window.min[side]) {
			return {ErrorCode::inverted, "window", window.max[side] - window.min[side], {}, {}, negative_size};
		}
	}
	return {};
}

Status validate_bounds(const PointSet &set, const Surface &surface) {
	const double limit = level_unit(set, 0) * surface_cell_size * surface_cell_limit;
	for (int side = 0; side < 3; ++side) {
		for (const double bound : {surface.bounds().min[side], surface.bounds().max[side]}) {
			if (const Status status = check_range("vertices", bound, -limit, limit); !status.ok()) {
				return status;
			}
		}
	}
	return {};
}

/// Returns an estimated upper bound for the number of points in the window, from the area of the
/// triangles.
double expected_points(
		const PointSet &set, const Surface &surface, const Box3 &window, std::span<const std::uint32_t> triangles) {
	const glm::dvec3 size = window.max - window.min;
	const double section = sqrt_3 * std::max(size.x * size.y, std::max(size.y * size.z, size.z * size.x));
	double area = 0.0;
	for (const std::uint32_t index : triangles) {
		area += std::min(section, surface.triangle_area(index));
	}
	return area * point_density(set);
}

/// Returns true if a triangle is one of the faces in `permitted`. A triangle within 0.06 degrees of
/// vertical counts as vertical, because the difference may be due to rounding.
bool faces(SurfaceFaces permitted, const Surface &surface, std::uint32_t triangle) {
	if (permitted == SurfaceFaces::all) {
		return true;
	}
	constexpr double vertical = 1e-3;
	const glm::dvec3 cross = surface.cross(triangle);
	const double tilt = permitted == SurfaceFaces::up ? cross.y : -cross.y;
	return tilt >= 0.0 || tilt * tilt <= vertical * vertical * glm::dot(cross, cross);
}

} // namespace

std::uint64_t surface_id(std::uint16_t layer, const glm::ivec3 &cell) {
	const auto wrapped = [](std::int32_t side, std::int32_t limit) {
		return ((side + limit) & (2 * limit - 1)) - limit;
	};
	const std::int32_t height = wrapped(cell.y, surface_id_height);
	const auto with_height = [&](std::int32_t side, std::int32_t height_bits) {
		return wrapped(side, surface_id_extent) * surface_id_steps + (height_bits & (surface_id_steps - 1));
	};
	return pack({layer, {with_height(cell.x, height >> surface_id_step_bits), with_height(cell.z, height)}});
}

double surface_unit(const PointSet &set) { return set.radius / surface_cell_size; }

/// Returns the margin in meters: the sum over all levels, because each level requests its darts from
/// the next coarser one. Each margin is extended by the reach of a dart and by the rounding to whole cells.
double sampling_margin(const PointSet &set, std::int32_t widest_margin) {
	constexpr std::int32_t rounding = 1;
	const double levels = static_cast<double>((1U << set.levels) - 1U);
	return levels * level_unit(set, 0) * surface_cell_size *
			(margin_in_cells(widest_margin) + surface_reach + rounding);
}

struct SurfaceSampler::Workspace {
	struct Level {
		SurfaceRace race;
		std::vector<std::uint32_t> nearby_triangles; ///< The triangles near the box.
		std::vector<SurfaceTriangle> triangles;
		std::vector<SurfaceDart> coarser_points; ///< The points of coarser levels.
	};

	/// The arguments of a call.
	struct Call {
		const PointSet &set;
		const Surface &surface;
		const Box3 *window; ///< Null for the whole surface.
		const Progress &progress;
		std::vector<SurfacePoint> &points;
	};

	SampleMargins margins;
	std::array<Level, max_levels> levels;
	std::vector<SurfaceDart> decided_darts;
	std::function<void(double)> report; ///< Called with the decided fraction of the current block; may be empty.
	double reported = 0.0;              ///< The last fraction that was passed to the caller.
	SurfaceStats stats;

	Status run(const Call &call);
	Status divide(const Call &call, const CellBox &cells, std::span<const Box3> triangles, double begin, double end);
	Status decide(
			const Call &call, std::uint32_t level_index, const CellBox &output_box, std::vector<SurfaceDart> &r_points);
	bool race(const Call &call, std::uint32_t level_index, const CellBox &output_box, const CellBox &box,
			const CellBox &bounds);
	void collect(const Call &call);
};

Status SurfaceSampler::Workspace::run(const Call &call) {
	stats = {};
	reported = 0.0;
	if (const Status status = validate(call.set); !status.ok()) {
		return status;
	}
	if (const Status status = call.window != nullptr ? validate_window(*call.window) : Status(); !status.ok()) {
		return status;
	}
	if (is_empty(call.surface.bounds())) {
		call.points.clear();
		return {};
	}
	if (const Status status = validate_bounds(call.set, call.surface); !status.ok()) {
		return status;
	}
	const Box3 &bounds = call.surface.bounds();
	const Box3 search_box = call.window == nullptr
			? bounds
			: Box3{glm::max(bounds.min, call.window->min), glm::min(bounds.max, call.window->max)};
	std::vector<std::uint32_t> triangles;
	call.surface.find(search_box, triangles);
	const double expected = expected_points(call.set, call.surface, search_box, triangles);
	if (expected > max_points_per_call) {
		return Status::too_many_points("window", expected, max_points_per_call);
	}
	call.points.clear();
	if (triangles.empty()) {
		return {};
	}
	const double unit = level_unit(call.set, 0);
	const CellBox cells = cells_around({search_box.min - unit, search_box.max + unit}, unit);
	std::vector<Box3> boxes;
	if (longest_side(cells.size()) > widest_block) { // The windows of most tiles are not divided.
		boxes.reserve(triangles.size());
		std::ranges::transform(triangles, std::back_inserter(boxes),
				[&](std::uint32_t index) { return call.surface.triangle_bounds(index); });
	}
	return divide(call, cells, boxes, 0.0, 1.0);
}

/// Recursively halves a box of cells until it is small enough to be decided as a whole. Parts
/// without triangles are skipped; `triangles` are the bounds of those in the box, and may be omitted
/// for a box that is not halved.
Status SurfaceSampler::Workspace::divide(
		const Call &call, const CellBox &cells, std::span<const Box3> triangles, double begin, double end) {
	if (call.progress.cancelled()) {
		return {ErrorCode::cancelled, "window"};
	}
	const glm::ivec3 size = cells.size();
	if (longest_side(size) <= widest_block) {
		decided_darts.clear();
		if (call.progress.report) {
			// A block that is decided again with a wider margin starts over, but the caller's fraction never decreases.
			report = [this, &call, begin, end](double fraction) {
				reported = std::max(reported, begin + (end - begin) * fraction);
				call.progress.report(reported, call.points.size());
			};
		}
		const Status status = decide(call, 0, cells, decided_darts);
		report = nullptr;
		if (!status.ok()) {
			return status;
		}
		collect(call);
		if (call.progress.report) {
			call.progress.report(end, call.points.size());
		}
		return {};
	}
	int longest = size.y > size.x ? 1 : 0;
	longest = size.z > size[longest] ? 2 : longest;
	std::array<CellBox, 2> halves{cells, cells};
	halves[0].max[longest] = halves[1].min[longest] = cells.min[longest] + size[longest] / 2;
	double half_begin = begin;
	std::vector<Box3> half_triangles;
	for (const CellBox &half : halves) {
		const Box3 box = world_box(half, level_unit(call.set, 0));
		half_triangles.clear();
		std::ranges::copy_if(triangles, std::back_inserter(half_triangles), [&](const Box3 &bounds) {
			return bounds.min[longest] <= box.max[longest] && bounds.max[longest] >= box.min[longest];
		});
		const double fraction = half.min == cells.min ? 0.5 : 1.0;
		const double half_end = begin + (end - begin) * fraction;
		if (!half_triangles.empty()) {
			if (const Status status = divide(call, half, half_triangles, half_begin, half_end); !status.ok()) {
				return status;
			}
		}
		half_begin = half_end;
	}
	return {};
}

/// Appends the points in the requested cells of one level and of all coarser levels.
Status SurfaceSampler::Workspace::decide(
		const Call &call, std::uint32_t level_index, const CellBox &output_box, std::vector<SurfaceDart> &r_points) {
	const CellBox bounds = cells_around(call.surface.bounds(), level_unit(call.set, level_index));
	Level &level = levels[level_index];
	const std::int32_t widest = margin_in_cells(margins.widest);
	for (std::int32_t margin = margin_in_cells(margins.first);; margin = std::min(2 * margin, widest)) {
		const CellBox box = output_box.grown(margin).common(bounds);
		if (box.is_empty()) {
			return {};
		}
		level.coarser_points.clear();
		if (level_index + 1 < call.set.levels) {
			if (const Status status = decide(call, level_index + 1, coarse_cells_around(box), level.coarser_points);
					!status.ok()) {
				return status;
			}
			for (SurfaceDart &dart : level.coarser_points) {
				dart.position *= std::int64_t{2};
			}
			std::erase_if(
					level.coarser_points, [&box](const SurfaceDart &dart) { return !box.contains(dart_cell(dart)); });
		}
		const SurfaceCounts before = level.race.counts();
		const bool is_decided = race(call, level_index, output_box, box, bounds);
		const SurfaceCounts &after = level.race.counts();
		stats.computed += after.accepted - before.accepted;
		stats.lines += after.lines - before.lines;
		stats.darts += after.hits - before.hits;
		stats.cells += after.cells - before.cells;
		if (is_decided) {
			level.race.append_points(output_box, r_points);
			return {};
		}
		const glm::i64vec3 *undecided = level.race.undecided();
		if (undecided == nullptr) {
			return {ErrorCode::cancelled, "window"};
		}
		if (margin == widest) {
			const glm::dvec3 position = glm::dvec3(*undecided) * level_unit(call.set, level_index);
			return {ErrorCode::margin_too_wide, "window", static_cast<double>(margin),
					{call.set.seed, call.set.radius, {position.x, position.z}}};
		}
		++stats.retries;
	}
}

bool SurfaceSampler::Workspace::race(const Call &call, std::uint32_t level_index, const CellBox &output_box,
		const CellBox &box, const CellBox &bounds) {
	Level &level = levels[level_index];
	const double unit = level_unit(call.set, level_index);
	const glm::dvec3 origin = glm::dvec3(box.min) * static_cast<double>(surface_cell_size);
	call.surface.find(world_box(box, unit), level.nearby_triangles);
	level.triangles.clear();
	for (const std::uint32_t index : level.nearby_triangles) {
		if (!faces(call.set.faces, call.surface, index)) {
			continue;
		}
		std::array<glm::dvec3, 3> corners = call.surface.triangle(index);
		for (glm::dvec3 &corner : corners) {
			corner = to_lattice(corner, unit) - origin;
		}
		if (const auto triangle = SurfaceTriangle::of(corners, index)) {
			level.triangles.push_back(*triangle);
		}
	}
	SurfaceRace::OpenFaces open_faces;
	for (int axis = 0; axis < 3; ++axis) {
		const auto side = static_cast<std::size_t>(axis);
		open_faces.lower[side] = box.min[axis] > bounds.min[axis];
		open_faces.upper[side] = box.max[axis] < bounds.max[axis];
	}
	level.race.start(SurfaceSource::of(call.set, level_index), level_index, box, open_faces, level.triangles,
			level.coarser_points);
	return level.race.decide(output_box, call.progress.cancel, level_index == 0 ? report : nullptr);
}

void SurfaceSampler::Workspace::collect(const Call &call) {
	const double unit = level_unit(call.set, 0);
	for (const SurfaceDart &dart : decided_darts) {
		const glm::dvec3 position = glm::dvec3(dart.position) * unit;
		if (call.window != nullptr &&
				(glm::any(glm::lessThan(position, call.window->min)) ||
						glm::any(glm::greaterThanEqual(position, call.window->max)))) {
			continue;
		}
		call.points.push_back({position, glm::normalize(call.surface.cross(dart.triangle)),
				surface_id(call.set.layer, id_cell(dart)), rank_of(call.set, dart), dart.level, dart.triangle});
	}
	stats.kept = call.points.size();
}

SurfaceSampler::SurfaceSampler(const SampleMargins &margins) : workspace_(std::make_unique<Workspace>()) {
	workspace_->margins = margins;
}
SurfaceSampler::~SurfaceSampler() = default;
SurfaceSampler::SurfaceSampler(SurfaceSampler &&) noexcept = default;
SurfaceSampler &SurfaceSampler::operator=(SurfaceSampler &&) noexcept = default;

Status SurfaceSampler::sample(const PointSet &set, const Surface &surface, const Box3 &window,
		std::vector<SurfacePoint> &r_points, const Progress &progress) {
	return sample_in(set, surface, &window, r_points, progress);
}

Status SurfaceSampler::sample_all(
		const PointSet &set, const Surface &surface, std::vector<SurfacePoint> &r_points, const Progress &progress) {
	return sample_in(set, surface, nullptr, r_points, progress);
}

Status SurfaceSampler::sample_in(const PointSet &set, const Surface &surface, const Box3 *window,
		std::vector<SurfacePoint> &r_points, const Progress &progress) {
	Status status = guarded("triangles", static_cast<double>(surface.triangle_count()),
			[&] { return workspace_->run({set, surface, window, progress, r_points}); });
	const bool is_incomplete = status.code == ErrorCode::margin_too_wide || status.code == ErrorCode::cancelled ||
			status.code == ErrorCode::out_of_memory;
	if (is_incomplete) {
		r_points.clear();
	}
	workspace_->stats.workspace_bytes = 0;
	for (const Workspace::Level &level : workspace_->levels) {
		workspace_->stats.workspace_bytes += level.race.bytes();
	}
	return status;
}

const SurfaceStats &SurfaceSampler::stats() const { return workspace_->stats; }

} // namespace thicket
