#pragma once

#include "core/surface/surface_grid.hpp"
#include "core/surface/surface_lines.hpp"
#include "core/surface/surface_patch.hpp"

#include <atomic>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace thicket {

/// An accepted dart.
struct SurfaceDart {
	glm::i64vec3 position{0}; ///< Units of the level's lattice, from the world's origin.
	SurfaceTime time = 0;
	std::uint32_t level = 0;
	std::uint32_t triangle = 0; ///< Index in the caller's list.
};

/// Statistics of races, added up.
struct SurfaceCounts {
	std::uint64_t cells = 0;    ///< Cells that threw a line.
	std::uint64_t lines = 0;    ///< Lines without a point.
	std::uint64_t hits = 0;     ///< Darts that were rejected.
	std::uint64_t accepted = 0; ///< Points.
};

/// The race of one level over a box of cells. A dart is accepted exactly if no accepted dart with an earlier time lies
/// within the radius. A dart is decided as on the plane (ARCHITECTURE.md, "Why tiles are exact"): a dart waits for the
/// cells within its reach that have an earlier line, and no others. The times along such a chain decrease, so it ends.
class SurfaceRace {
public:
	/// For each face of the box, by axis: true if the surface continues behind it. Darts near these faces are unknown.
	struct OpenFaces {
		std::array<bool, 3> lower{};
		std::array<bool, 3> upper{};
	};

	/// Prepares a race, reusing memory. `triangles` are in units of this level relative to the lower corner of `box`, and must outlive the
	/// race. `placed` are the points of coarser levels in the box, in units of this level; all of them lie in the box.
	void start(const SurfaceSource &source, std::uint32_t level, const CellBox &box, const OpenFaces &open_faces,
			std::span<const SurfaceTriangle> triangles, std::span<const SurfaceDart> placed);

	/// Decides all darts of the cells of `wanted`. Returns false if `cancel` was raised or if a dart depends on cells outside the box; the
	/// latter sets `undecided`.
	bool decide(const CellBox &wanted, const std::atomic<bool> *cancel);

	/// Appends the points in the cells of `wanted`, by z, then y, then x.
	void append_points(const CellBox &wanted, std::vector<SurfaceDart> &r_points) const;

	/// A point whose fate depends on cells outside the box, in units from the world's origin.
	const glm::i64vec3 *undecided() const { return is_undecided_ ? &undecided_ : nullptr; }

	const SurfaceCounts &counts() const { return counts_; }
	std::size_t bytes() const;

private:
	static constexpr std::uint32_t none = SurfaceGrid::none;

	struct Cell {
		/// For each axis, 16 bits of columns that the surface may enter and that are not known to be covered.
		std::uint64_t open = 0;
		SurfaceLines::List lines = SurfaceLines::empty;
		std::uint32_t patches = none;   ///< The first in `patches_`, one for each searched axis; none before `prepare`.
		std::uint32_t neighbors = none; ///< The first run in `neighbors_`.
		std::uint32_t neighbor_count = 0;
		std::uint32_t point = none; ///< Index in `points_`.
		std::uint32_t near = none;  ///< The last one in `near_`.
		SurfaceSearch search;
	};
	struct Point {
		glm::ivec3 position; ///< Units, relative to the box.
		std::uint32_t triangle;
		std::uint32_t level;
		SurfaceTime time;
	};
	/// A point whose ball reaches a cell: a list for each cell.
	struct Near {
		glm::ivec3 position;
		std::uint32_t next;
	};
	struct Hit {
		std::int32_t along;
		std::uint32_t triangle; ///< Number in `triangles_`.
	};
	struct Wanted {
		std::uint32_t cell;
		SurfaceTime until;
	};
	enum class Fate : std::uint8_t { accepted, rejected, waits, unknown };

	bool settle(std::uint32_t number, SurfaceTime until);
	/// Finds out how a cell is searched, and where its surface is.
	void prepare(std::uint32_t number);
	SurfaceSearch search_in(std::uint32_t number) const;
	void throw_first(std::uint32_t number);
	/// Decides the cell's next line and returns `none`. If a different cell must be decided first, up to that line's
	/// time, returns that cell instead.
	std::uint32_t step(std::uint32_t number);
	void find_hits(std::uint32_t number, const SurfaceLine &line, const SurfaceLine::Course &course);
	Fate judge(std::uint32_t number, SurfaceTime time, const glm::ivec3 &position, std::uint32_t &r_blocker);
	void accept(std::uint32_t number, const glm::ivec3 &position, std::uint32_t triangle, SurfaceTime time,
			std::uint32_t level);
	void cover(const glm::ivec3 &position, std::uint32_t number);
	void finish(std::uint32_t number);
	void split(std::uint32_t number);
	/// Which quarters of a line's column, a bit for each, no point's ball is known to cover.
	std::uint32_t open_quarters(std::uint32_t number, const SurfaceLine &line) const;
	/// True if the ball of one point covers the box between two corners.
	bool is_covered(std::uint32_t number, const glm::ivec3 &from, const glm::ivec3 &to) const;
	void show_next(std::uint32_t number);
	std::span<const SurfaceGrid::Run> neighbors_of(std::uint32_t number);
	bool is_near_open_face(const glm::ivec3 &position) const;

	SurfaceSource source_;
	std::uint32_t level_ = 0;
	OpenFaces open_faces_;
	std::span<const SurfaceTriangle> triangles_;
	SurfaceGrid grid_;
	std::vector<glm::ivec3> extra_;
	std::vector<SurfaceTime> times_; ///< Of each cell's next line; never once the cell is decided.
	std::vector<Cell> cells_;
	std::vector<SurfacePatch> patches_;
	std::vector<Point> points_;
	SurfaceLines lines_;
	std::vector<SurfaceGrid::Run> neighbors_;
	std::vector<Near> near_;
	std::vector<Wanted> wanted_;
	std::vector<Hit> hits_;
	glm::i64vec3 undecided_{0};
	bool is_undecided_ = false;
	SurfaceCounts counts_;
};

} // namespace thicket
