#pragma once

#include "core/surface/surface_triangle.hpp"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace thicket {

/// A set of the columns of a cell along an axis: one bit for each.
struct alignas(32) SurfaceColumns {
	static constexpr std::size_t side = std::size_t{1} << surface_column_depth;

	std::array<std::uint16_t, side> rows{}; ///< One row for each v, one bit for each u.

	bool contains(std::uint32_t column) const { return (rows[column / side] >> (column % side) & 1) != 0; }
	void add(const SurfaceColumns &other) {
		for (std::size_t row = 0; row < side; ++row) {
			rows[row] |= other.rows[row];
		}
	}
	/// Returns 64 columns, from column 64 * `number`, one bit each.
	std::uint64_t word(std::size_t number) const {
		const std::uint16_t *row = &rows[4 * number];
		return std::uint64_t{row[0]} | std::uint64_t{row[1]} << 16 | std::uint64_t{row[2]} << 32 |
				std::uint64_t{row[3]} << 48;
	}
	static SurfaceColumns all() {
		SurfaceColumns columns;
		columns.rows.fill(0xffffu);
		return columns;
	}
	bool is_empty() const {
		std::array<std::uint64_t, side / 4> words{};
		std::memcpy(words.data(), rows.data(), sizeof(rows));
		return (words[0] | words[1] | words[2] | words[3]) == 0;
	}
};

/// Converts units to cell widths.
inline glm::vec3 in_cells(const glm::ivec3 &units) {
	constexpr float width = 1.0f / static_cast<float>(surface_cell_size);
	return glm::vec3(units) * width;
}

/// Approximates a part of a cell's surface as a height field over one of the cell's faces: a plane,
/// and bounds for the surface's distance from the plane. The patch stores which columns are open,
/// that is, may still need darts. A closed column never needs darts, but an open one may not need
/// any either. Lengths are in cell widths, relative to the cell's lower corner.
class SurfacePatch {
public:
	explicit SurfacePatch(int axis) : axis_(static_cast<std::uint8_t>(axis)) {}

	int axis() const { return axis_; }

	/// The part of a triangle in a cell, as a height field over one of the cell's faces.
	struct Facet {
		enum class Kind : std::uint8_t { plane, steep, absent };

		Kind kind = Kind::plane; ///< Steep if a plane is not used; absent if no line in the cell hits the triangle.
		float height = 0.0f;     ///< The plane's height at u = v = 0.
		float slope_u = 0.0f;
		float slope_v = 0.0f;
		float from_u = 0.0f; ///< The triangle's bounds in the cell.
		float to_u = 0.0f;
		float from_v = 0.0f;
		float to_v = 0.0f;
	};

	/// The triangle and `low`, the cell's lower corner, are in units.
	static Facet facet_of(const SurfaceTriangle &triangle, int axis, const glm::dvec3 &low);

	/// Extends the approximation to include a facet along the patch's axis. Returns false, and changes
	/// nothing, if the facet differs from the patch's plane by more than `tolerance`.
	bool add(const Facet &facet, float tolerance);

	/// Opens the columns that the surface may enter.
	void open_entered();

	/// Closes all columns that are not in `columns`.
	void keep(const SurfaceColumns &columns);

	/// Closes the columns of patches that the ball around `point` covers. Returns true if all columns
	/// of the patches are then closed.
	static bool cover(std::span<SurfacePatch> patches, const glm::vec3 &point);

	const SurfaceColumns &open() const { return open_; }

	/// Adds the columns in which lines along an axis may hit a triangle. The triangle and `low`, the
	/// cell's lower corner, are in units.
	static void add_columns_over(
			const SurfaceTriangle &triangle, int axis, const glm::dvec3 &low, SurfaceColumns &r_columns);

	/// The approximating plane.
	struct Plane {
		float height = 0.0f; ///< Height at u = v = 0.
		float slope_u = 0.0f;
		float slope_v = 0.0f;
		float inverse = 1.0f; ///< 1 / (1 + slope_u^2).
		/// Lowest and highest distance of the surface from the plane, along the axis.
		float lowest = 0.0f;
		float highest = 0.0f;
	};

	/// A column that is divided into as many smaller columns as a cell. Lengths are in widths of the
	/// divided column.
	struct Part {
		Plane plane;
		float u; ///< The divided column's lower corner (u, v), in cell widths.
		float v;
		float middle;       ///< The plane's height at the center.
		float square_reach; ///< Balls whose centers are farther from the surface's center are disregarded. Squared.
		SurfaceColumns open;
	};

	/// Divides a column.
	Part part_in(std::uint32_t column) const;

	/// Closes the smaller columns that the ball around `point`, in cell widths, covers.
	void cover_part(const glm::vec3 &point, Part &r_part) const;

	struct Ball {
		float u;
		float v;
		float along;
		float radius;
	};

	/// A half-plane of a cell's face: all (u, v) with u * a + v * b + c >= 0. |a| + |b| = 1.
	struct Side {
		float a;
		float b;
		float c;
	};

	// For the vector code.
	const Plane &plane() const { return plane_; }
	std::uint16_t *rows() { return open_.rows.data(); }
	/// Returns false if the surface is not close to a plane. Balls then close no columns.
	bool is_bounded() const { return plane_.highest < unbounded; }
	/// Returns the ball around a point.
	Ball ball(const glm::vec3 &point) const {
		const auto [side_u, side_v] = axes_across(axis_);
		const float *sides = glm::value_ptr(point);
		return {sides[side_u], sides[side_v], sides[axis_], covering_radius};
	}

private:
	/// Larger than any distance within a cell.
	static constexpr float unbounded = 1e3f;

	/// The radius is 1 cell width, reduced to allow for rounding.
	static constexpr float covering_radius = 1.0f - 2e-5f;

	SurfaceColumns open_;
	Plane plane_;
	std::uint8_t axis_;
	bool is_empty_ = true;
};
static_assert(sizeof(SurfacePatch) == 64);

} // namespace thicket
