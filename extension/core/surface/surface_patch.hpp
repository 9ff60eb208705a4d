#pragma once

#include "core/surface/bit_count.hpp"
#include "core/surface/surface_triangle.hpp"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

namespace thicket {

/// A set of the columns of a cell along an axis: one bit for each.
struct alignas(32) SurfaceColumns {
	static constexpr std::size_t side = std::size_t{1} << surface_column_depth;

	std::array<std::uint16_t, side> rows{}; ///< One row for each v, one bit for each u.

	bool contains(std::uint32_t column) const { return (rows[column / side] >> (column % side) & 1) != 0; }
	/// Returns 64 columns, from column 64 * `number`, one bit each.
	std::uint64_t word(std::size_t number) const {
		const std::uint16_t *row = &rows[4 * number];
		return std::uint64_t{row[0]} | std::uint64_t{row[1]} << 16 | std::uint64_t{row[2]} << 32 |
				std::uint64_t{row[3]} << 48;
	}
	std::uint32_t count() const {
		std::uint32_t sum = 0;
		for (std::size_t number = 0; number < side / 4; ++number) {
			sum += count_bits(word(number));
		}
		return sum;
	}
	void add(const SurfaceColumns &other) {
		for (std::size_t row = 0; row < side; ++row) {
			rows[row] |= other.rows[row];
		}
	}
	bool is_empty() const { return (word(0) | word(1) | word(2) | word(3)) == 0; }
};

/// Approximates a part of a cell's surface as a height field over one of the cell's faces: a plane,
/// and bounds for the surface's distance from the plane. The patch stores which columns are open,
/// that is, may still need darts. A closed column never needs darts, but an open one may not need
/// any either. Lengths are in cell widths, relative to the cell's lower corner.
class SurfacePatch {
public:
	explicit SurfacePatch(int axis) : axis_(static_cast<std::uint8_t>(axis)) {}

	int axis() const { return axis_; }

	/// Extends the approximation to include a triangle. Returns false, and changes nothing, if the
	/// triangle's plane differs from the patch's by more than `tolerance` in the cell. The triangle
	/// and `low`, the cell's lower corner, are in units.
	bool add(const SurfaceTriangle &triangle, const glm::dvec3 &low, float tolerance);

	/// Opens the columns that the surface may enter.
	void open_entered();

	/// Closes all columns that are not in `columns`.
	void keep(const SurfaceColumns &columns);

	/// Closes the columns that the ball around `point` covers.
	void cover(const glm::vec3 &point);

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
		float square; ///< Squared radius.
	};

	/// A half-plane of a cell's face: all (u, v) with u * a + v * b + c >= 0. |a| + |b| = 1.
	struct Side {
		float a;
		float b;
		float c;
	};

private:
	SurfaceColumns open_;
	Plane plane_;
	std::uint8_t axis_;
	bool is_empty_ = true;
};
static_assert(sizeof(SurfacePatch) == 64);

} // namespace thicket
