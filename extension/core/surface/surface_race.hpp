#pragma once

#include "core/surface/surface_grid.hpp"
#include "core/surface/surface_lines.hpp"
#include "core/surface/surface_patch.hpp"

#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

namespace thicket {

/// An accepted dart.
struct SurfaceDart {
	glm::i64vec3 position{0}; ///< Position in units of the level's lattice, relative to the world's origin.
	SurfaceTime time = 0;
	std::uint32_t level = 0;
	std::uint32_t triangle = 0; ///< Index of the triangle in the caller's list.
};

/// Accumulated statistics of races.
struct SurfaceCounts {
	std::uint64_t cells = 0;    ///< Number of cells with at least one line.
	std::uint64_t lines = 0;    ///< Number of lines that produced no point.
	std::uint64_t hits = 0;     ///< Number of rejected darts.
	std::uint64_t accepted = 0; ///< Number of accepted darts, which are the points.
};

/// The race of one level over a box of cells: it decides the darts in the order of their times. A
/// dart is accepted exactly if no accepted dart with an earlier time lies within the radius. As on
/// the plane (ARCHITECTURE.md, "Why tiles are exact"), a dart waits only for the cells within its
/// reach that have an earlier line. Times decrease along such a chain, so it ends.
class SurfaceRace {
public:
	/// For each axis, true if the surface continues beyond the lower or upper face of the box.
	/// Darts near an open face cannot be decided.
	struct OpenFaces {
		std::array<bool, 3> lower{};
		std::array<bool, 3> upper{};
	};

	/// Prepares a race and reuses memory. `triangles` are in units of this level relative to the
	/// lower corner of `box`, and must outlive the race. `coarser_points` are the points of coarser levels
	/// in `box`, in units of this level.
	void start(const SurfaceSource &source, std::uint32_t level, const CellBox &box, const OpenFaces &open_faces,
			std::span<const SurfaceTriangle> triangles, std::span<const SurfaceDart> coarser_points);

	/// Decides all darts in the cells of `output_box`. Calls `report`, unless it is empty, with the
	/// decided fraction of the cells, which never decreases. Returns false if `cancel` is set, or if
	/// a dart depends on cells outside the box. In the second case, `undecided` is not null.
	bool decide(const CellBox &output_box, const std::atomic<bool> *cancel, const std::function<void(double)> &report);

	/// Appends the points in the cells of `output_box`, ordered by cell (z, then
	/// y, then x) and time, the latest first.
	void append_points(const CellBox &output_box, std::vector<SurfaceDart> &r_points) const;

	/// Returns the position of a dart that depends on cells outside the box, in units relative to
	/// the world's origin, or null if there is none.
	const glm::i64vec3 *undecided() const { return is_undecided_ ? &undecided_ : nullptr; }

	const SurfaceCounts &counts() const { return counts_; }
	std::size_t bytes() const;

private:
	static constexpr std::uint32_t none = SurfaceGrid::none;

	/// A dart that waits for other cells. The fields are valid if `hash` is that of the cell's next line.
	struct WaitingDart {
		std::uint64_t hash = 0;
		std::int32_t offset = 0; ///< Position of the hit along the line.
		std::uint32_t triangle = 0;
		/// The balls of this entry of the list of near points, and of all later ones, do not contain the dart.
		std::uint32_t first_checked = none;
	};
	struct Cell {
		SurfaceLines::List lines = SurfaceLines::empty;
		/// Index in `faces_` of the first face; none before `prepare`. An axis has no face if no line
		/// along it hits the surface.
		std::uint32_t faces = none;
		std::uint32_t face_count = 0;
		std::uint32_t neighbors = none; ///< Index in `neighbors_` of the first neighbor.
		std::uint32_t neighbor_count = 0;
		std::uint32_t point = none;      ///< Index in `points_` of the cell's last point.
		std::uint32_t first_near = none; ///< Index in `near_points_` of the first list entry.
		WaitingDart waiting_dart;
		SurfaceSearch search;
		bool is_refined = false; ///< True after `refine`.
	};
	struct Point {
		glm::ivec3 position; ///< Position in units relative to the box.
		std::uint32_t triangle;
		std::uint32_t level;
		SurfaceTime time;
		std::uint32_t previous; ///< Index of the cell's previous point.
	};
	/// A list entry: a point whose ball reaches the cell.
	struct NearPoint {
		glm::ivec3 position;
		std::uint32_t next;
	};
	struct Hit {
		std::int32_t offset;    ///< Position along the line, from the lower face of the cell.
		std::uint32_t triangle; ///< Index of the triangle in `triangles_`.
	};
	/// A cell whose darts are to be decided up to a time.
	struct Goal {
		std::uint32_t cell;
		SurfaceTime end_time;
	};
	enum class Verdict : std::uint8_t { accepted, rejected, waits, unknown };

	/// Decides all darts in a group of cells. The function reorders the group.
	bool decide_group(std::span<std::uint32_t> group);
	bool settle(std::uint32_t cell_index, SurfaceTime end_time);
	/// Determines a cell's search axes and the columns that the surface may enter.
	void prepare(std::uint32_t cell_index);
	/// Divides a cell's surface into faces.
	void add_faces(std::uint32_t cell_index, int axis);
	/// Closes the columns of a cell's faces that their triangles do not enter. Called when a line through a column has
	/// no hit, which is frequent only where a border of the surface passes through the cell.
	void refine(std::uint32_t cell_index);
	SurfaceSearch search_in(std::uint32_t cell_index) const;
	void throw_first(std::uint32_t cell_index);
	/// Decides the cell's next line and returns `none`. If a different cell must first be decided
	/// up to that line's time, the function returns that cell instead.
	std::uint32_t step(std::uint32_t cell_index);
	/// Finds the hits of a line that are kept. Returns true if other hits are not kept.
	bool find_hits(std::uint32_t cell_index, const SurfaceLine &line, const SurfaceLine::Course &course);
	/// Decides a dart that is known not to be in the balls from the list entry `first_checked` on.
	Verdict judge(std::uint32_t cell_index, SurfaceTime time, const glm::ivec3 &position, std::uint32_t first_checked,
			std::uint32_t &r_blocker);
	void accept(std::uint32_t cell_index, const glm::ivec3 &position, std::uint32_t triangle, SurfaceTime time,
			std::uint32_t level);
	/// Closes the columns of a cell that the ball around a new point covers. `offset` is the point's
	/// position relative to the cell.
	void cover(std::uint32_t cell_index, const glm::ivec3 &position, const glm::ivec3 &offset);
	std::span<SurfacePatch> faces_of(const Cell &cell) {
		return std::span(faces_).subspan(cell.faces, cell.face_count);
	}
	bool is_open(const Cell &cell, int axis, std::uint32_t column);
	bool has_open_columns(const Cell &cell, int axis);
	void finish(std::uint32_t cell_index);
	/// Replaces the cell's next line, which produced no further dart, by the lines that follow it.
	/// `has_failed` is false if the only reason is that its hits were not kept.
	void advance(std::uint32_t cell_index, bool has_failed);
	/// Drops the cell's next line. A line through the whole cell, or the first line through a
	/// column, is replaced by the next one that passes through an open column.
	void skip_next(std::uint32_t cell_index);
	void skip_whole(std::uint32_t cell_index);
	/// Replaces the cell's next line by the earliest first line through an open column whose key is
	/// less than `before`, or drops it if there is none.
	void show_column(std::uint32_t cell_index, const SurfaceColumnClocks &clocks, SurfaceColumnClocks::Key before);
	/// Returns the quarters of a line's column that the surface may enter and no point's ball is
	/// known to cover, one bit each.
	std::uint32_t open_quarters(std::uint32_t cell_index, const SurfaceLine &line);
	/// Returns false if the surface in a column of depth surface_column_depth is known to be covered.
	bool may_have_gaps(std::uint32_t cell_index, int axis, std::uint32_t column);
	/// Returns true if the ball of a single point covers the box from `from` to `to`.
	bool is_covered(std::uint32_t cell_index, const glm::ivec3 &from, const glm::ivec3 &to) const;
	/// Skips lines in closed columns and shows the time of the next line to other cells.
	void show_next(std::uint32_t cell_index);
	std::span<const std::uint32_t> neighbors_of(std::uint32_t cell_index);
	bool is_near_open_face(const glm::ivec3 &position) const;

	SurfaceSource source_;
	std::uint32_t level_ = 0;
	OpenFaces open_faces_;
	std::span<const SurfaceTriangle> triangles_;
	SurfaceGrid grid_;
	std::vector<glm::ivec3> coarser_cells_;
	/// Time of each cell's next line; surface_time_never once the cell is decided.
	std::vector<SurfaceTime> times_;
	std::vector<std::uint32_t> pending_; ///< Indices of the cells to decide.
	std::vector<Cell> cells_;
	std::vector<SurfacePatch> faces_;
	std::vector<Point> points_;
	SurfaceLines lines_;
	std::vector<std::uint32_t> neighbors_;
	std::vector<NearPoint> near_points_;
	std::vector<Goal> goals_;
	std::vector<Hit> hits_;
	glm::i64vec3 undecided_{0};
	bool is_undecided_ = false;
	SurfaceCounts counts_;
};

} // namespace thicket
