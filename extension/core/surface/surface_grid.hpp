#pragma once

#include "core/surface/bit_count.hpp"
#include "core/surface/surface_triangle.hpp"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// A half-open box of cells.
struct CellBox {
	glm::ivec3 min{0};
	glm::ivec3 max{0};

	bool contains(const glm::ivec3 &cell) const {
		return min.x <= cell.x && cell.x < max.x && min.y <= cell.y && cell.y < max.y && min.z <= cell.z &&
				cell.z < max.z;
	}
	bool is_empty() const { return max.x <= min.x || max.y <= min.y || max.z <= min.z; }
	CellBox grown(std::int32_t margin) const { return {min - margin, max + margin}; }
	CellBox common(const CellBox &other) const;
	glm::ivec3 size() const { return max - min; }
	friend bool operator==(const CellBox &, const CellBox &) = default;
};

/// The cells of a box that a surface may enter, and the triangles that may enter each cell. A
/// cell's list may include a few triangles that only pass close to it. Cells are numbered by x,
/// then y, then z.
class SurfaceGrid {
public:
	/// Rebuilds the grid and reuses its memory. `triangles` are in units relative to the lower
	/// corner of `box`. `extra` are cells, relative to `box`, that are included even if no triangle
	/// enters them. `box` must have at most `max_volume` cells.
	void build(const CellBox &box, std::span<const SurfaceTriangle> triangles, std::span<const glm::ivec3> extra);

	static constexpr std::int64_t max_volume = std::int64_t{1} << 30;
	static constexpr std::uint32_t none = ~std::uint32_t{0};

	const CellBox &box() const { return box_; }
	std::uint32_t count() const { return static_cast<std::uint32_t>(cells_.size()); }

	/// Returns the cell with this number, relative to the box.
	const glm::ivec3 &cell(std::uint32_t index) const { return cells_[index]; }

	/// Returns the number of a cell, or `none`. `cell` is relative to the box, and may be up to
	/// surface_reach cells outside it.
	std::uint32_t number_of(const glm::ivec3 &cell) const {
		const std::size_t word = word_of(cell);
		const std::uint64_t bit = std::uint64_t{1} << ((cell.x + surface_reach) & 63);
		return (bits_[word] & bit) != 0 ? rank(word, bit) : none;
	}

	std::span<const std::uint32_t> triangles_in(std::uint32_t cell_index) const {
		return std::span(triangles_).subspan(starts_[cell_index], starts_[cell_index + 1] - starts_[cell_index]);
	}

	/// Appends the numbers of the cells that a ball around a point in this cell can reach,
	/// including this cell, in ascending order.
	void append_neighbors(std::uint32_t cell_index, std::vector<std::uint32_t> &r_cells) const;

	std::size_t bytes() const;

private:
	struct Entry {
		std::uint32_t cell; ///< Index of the cell's bit; later the cell's number.
		std::uint32_t triangle;
	};

	std::size_t word_of(const glm::ivec3 &cell) const {
		const auto row = static_cast<std::size_t>(cell.z + surface_reach) * static_cast<std::size_t>(rows_) +
				static_cast<std::size_t>(cell.y + surface_reach);
		return row * words_ + (static_cast<std::size_t>(cell.x + surface_reach) >> 6);
	}
	std::uint32_t rank(std::size_t word, std::uint64_t bit) const {
		return ranks_[word] + count_bits(bits_[word] & (bit - 1));
	}
	void enter(const SurfaceTriangle &triangle, std::uint32_t triangle_index);
	void number_cells();

	CellBox box_;
	glm::ivec3 size_{0};
	std::int32_t rows_ = 0;
	std::size_t words_ = 0;
	/// One bit for each cell of the box and of a border of surface_reach cells, in rows along x.
	std::vector<std::uint64_t> bits_;
	std::vector<std::uint32_t> ranks_; ///< For each word, the number of cells before it.
	std::vector<glm::ivec3> cells_;
	std::vector<Entry> entries_;
	std::vector<std::uint32_t> starts_;
	std::vector<std::uint32_t> triangles_;
};

} // namespace thicket
