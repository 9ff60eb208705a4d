#pragma once

#include "core/sampling/level_grid.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace thicket {

/// Finds the order of PointSet::even_order within each level except the coarsest.
///
/// The clearance of a point is its distance to the nearest point of a coarser level. The spacing of a
/// point is the smaller of its clearance and its distance to the nearest point of its own level that has
/// a greater clearance. Points with a greater spacing come first. Any two points whose spacing is at least
/// d are then at least d apart: if both belong to one level, the one with the smaller clearance has a
/// spacing of at most their distance.
///
/// A point's spacing depends only on the points within four radii of its level, so it is the same in every
/// window.
class EvenOrder {
public:
	/// Spacing is only valid if the finest level was resolved for this many more cells on each side.
	static constexpr std::int32_t margin = 3;

	/// Called with the cell of a point in the finest level, its level, and its squared spacing in lattice
	/// units of its level: from radius_squared to 4 * radius_squared.
	using Visit = std::function<void(glm::ivec2 cell, std::uint32_t level, std::uint32_t squared)>;

	/// Visits each point of `block` that does not belong to the coarsest level. The grids must have been
	/// resolved for block.grown(margin).
	void visit(std::span<const LevelGrid> levels, const CellRect &block, const Visit &visitor);

private:
	/// The points of one level, or of all levels from one on, in an area of cells. Coordinates are in lattice
	/// units of the finer level of a pair, relative to the minimum corner of the area of that level.
	struct Area {
		CellRect cells;
		std::vector<glm::ivec2> points;
		std::vector<std::int32_t> point_at; ///< Index in `points` for each cell in row order, or none.

		static constexpr std::int32_t none = -1;

		void reset(const CellRect &p_cells);
		std::size_t index_of(glm::ivec2 cell) const;
	};

	Area own_;
	Area coarser_;
	std::vector<std::uint32_t> clearance_; ///< Squared, for each point of `own_`.

	void collect(std::span<const LevelGrid> levels, std::uint32_t level, const CellRect &block);
	std::uint32_t clearance_of(glm::ivec2 cell, glm::ivec2 point) const;
	std::uint32_t spacing_of(glm::ivec2 cell, std::int32_t number) const;
};

} // namespace thicket
