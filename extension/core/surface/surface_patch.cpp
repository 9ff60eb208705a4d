#include "core/surface/surface_patch.hpp"

#include "core/base/instruction_sets.hpp"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/surface/surface_patch.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Returns those of `columns` that a ball leaves open. The result determines only which work can be
// skipped, so its rounding does not affect the points.
std::uint64_t open_columns(const SurfacePatch::Plane &plane, float u, float v, float along, std::uint64_t columns) {
	constexpr std::size_t side = 8;
	const hn::CappedTag<float, side> d;
	constexpr float width = 1.0f / side;
	HWY_ALIGN static constexpr float middles[side] = {
			0.0625f, 0.1875f, 0.3125f, 0.4375f, 0.5625f, 0.6875f, 0.8125f, 0.9375f};
	const auto half = hn::Set(d, width / 2.0f);
	const auto one = hn::Set(d, 1.0f);
	const auto reach = hn::Set(d, plane.reach);
	const auto to = hn::Set(d, along);
	// The squared radius is 1 in squared cell widths, reduced to allow for rounding.
	const auto limit = hn::Set(d, 1.0f - 1e-5f);
	// A column's part of the plane is a parallelogram. The largest squared distance to one of its
	// corners is at most |c|^2 + |a|^2 + |b|^2 + 2 |c a| + 2 |c b| + 2 |a b|. Here c points to its
	// center, a and b are half its sides, and products are dot products.
	const float slope_u = plane.slope_u;
	const float slope_v = plane.slope_v;
	const auto sides = hn::Set(d,
			width * width / 4.0f * (2.0f + slope_u * slope_u + slope_v * slope_v + 2.0f * std::abs(slope_u * slope_v)));
	const float inner = std::max(0.0f, 1.0f - plane.thickness);
	const auto inner_limit = hn::Set(d, inner * inner - 1e-5f);
	std::uint64_t open = 0;
	for (std::size_t first = 0; first < side; first += hn::Lanes(d)) {
		const auto middle_u = hn::Load(d, middles + first);
		const auto to_u = hn::Sub(middle_u, hn::Set(d, u));
		const auto far_u = hn::Add(hn::Abs(to_u), half);
		const auto square_u = hn::Mul(far_u, far_u);
		const auto height_u = hn::Add(hn::Set(d, plane.height), hn::Mul(hn::Set(d, plane.slope_u), middle_u));
		for (std::size_t row = 0; row < side; ++row) {
			if ((columns >> (row * side) & 0xff) == 0) {
				continue;
			}
			const float to_v = middles[row] - v;
			const float far_v = std::abs(to_v) + width / 2.0f;
			const auto height = hn::Add(height_u, hn::Set(d, plane.slope_v * middles[row]));
			const auto low = hn::Max(hn::Sub(height, reach), hn::Zero(d));
			const auto high = hn::Min(hn::Add(height, reach), one);
			const auto far_along = hn::Max(hn::Sub(to, low), hn::Sub(high, to));
			const auto square = hn::Add(hn::Mul(far_along, far_along), hn::Add(square_u, hn::Set(d, far_v * far_v)));
			const auto up = hn::Sub(height, to);
			const auto along_u = hn::Abs(hn::Add(to_u, hn::Mul(up, hn::Set(d, slope_u))));
			const auto along_v = hn::Abs(hn::Add(hn::Set(d, to_v), hn::Mul(up, hn::Set(d, slope_v))));
			const auto square_plane = hn::Add(
					hn::Add(hn::Add(hn::Mul(to_u, to_u), hn::Set(d, to_v * to_v)), hn::Add(hn::Mul(up, up), sides)),
					hn::Mul(hn::Set(d, width), hn::Add(along_u, along_v)));
			const auto is_open = hn::And(hn::Ge(square, limit), hn::Ge(square_plane, inner_limit));
			std::uint8_t bits[8] = {};
			hn::StoreMaskBits(d, hn::And(hn::Le(low, high), is_open), bits);
			open |= std::uint64_t{bits[0]} << (row * side + first);
		}
	}
	return open & columns;
}

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace thicket {

HWY_EXPORT(open_columns);

namespace {

constexpr double cell_width = surface_cell_size;

/// Largest slope for which a plane is used. A steeper plane rises through the whole cell within an
/// eighth of the cell's width, which is one column.
constexpr double steepest = 8.0;

/// Larger than the rounding error of any height, but smaller than the distance from any line to a
/// surface that only touches the cell's edge.
constexpr float rounding = 4e-6f;

/// Larger than any distance within a cell.
constexpr float unbounded = 1e3f;

/// Half the width of the part of a column through which lines pass, in cell widths.
constexpr auto half = static_cast<float>(half_of_lines(cell_width / 8.0) / cell_width);

} // namespace

bool SurfacePatch::add(const SurfaceTriangle &triangle, const glm::dvec3 &low, float tolerance) {
	const auto [side_u, side_v] = axes_across(axis_);
	const double along = at(triangle.normal, axis_);
	if (along == 0.0) {
		return true; // No line along the axis hits the triangle.
	}
	const double u = -at(triangle.normal, side_u) / along;
	const double v = -at(triangle.normal, side_v) / along;
	if (std::abs(u) + std::abs(v) > steepest) {
		if (!is_empty_ && tolerance < unbounded) {
			return false;
		}
		is_empty_ = false;
		plane_.reach = unbounded;
		plane_.thickness = unbounded;
		return true;
	}
	const glm::dvec3 offset = low - triangle.corners[0];
	const double units = u * at(offset, side_u) + v * at(offset, side_v) - at(offset, axis_);
	const auto height = static_cast<float>(std::clamp(units / cell_width, -100.0, 100.0));
	const auto slope_u = static_cast<float>(u);
	const auto slope_v = static_cast<float>(v);
	if (is_empty_) {
		is_empty_ = false;
		plane_ = {height, slope_u, slope_v, (std::abs(slope_u) + std::abs(slope_v)) * half + rounding, rounding};
		return true;
	}
	// The distance between two planes over the face is largest at one of its corners.
	const float at_0 = height - plane_.height;
	const float more_u = slope_u - plane_.slope_u;
	const float more_v = slope_v - plane_.slope_v;
	const float apart = std::max(
			{std::abs(at_0), std::abs(at_0 + more_u), std::abs(at_0 + more_v), std::abs(at_0 + more_u + more_v)});
	if (apart > tolerance) {
		return false;
	}
	plane_.thickness = std::max(plane_.thickness, apart + 2.0f * rounding);
	plane_.reach = std::max(
			plane_.reach, (std::abs(plane_.slope_u) + std::abs(plane_.slope_v)) * half + apart + 2.0f * rounding);
	return true;
}

std::uint64_t SurfacePatch::columns_over(const SurfaceTriangle &triangle, int axis, const glm::dvec3 &low) {
	if (at(triangle.normal, axis) == 0.0) {
		return 0;
	}
	constexpr int side = 1 << surface_patch_depth;
	constexpr double width = cell_width / side;
	const auto [side_u, side_v] = axes_across(axis);
	const SurfaceOutline outline(triangle, axis);
	std::uint64_t columns = 0;
	for (int v = 0; v < side; ++v) {
		for (int u = 0; u < side; ++u) {
			const bool meets = outline.meets(
					at(low, side_u) + (u + 0.5) * width, at(low, side_v) + (v + 0.5) * width, half_of_lines(width));
			columns |= std::uint64_t{meets} << (u + side * v);
		}
	}
	return columns;
}

std::uint64_t SurfacePatch::entered() const {
	// The ball is so far away that it covers nothing.
	return open_beside(glm::vec3(1e3f), ~std::uint64_t{0});
}

std::uint64_t SurfacePatch::open_beside(const glm::vec3 &point, std::uint64_t columns) const {
	const auto [side_u, side_v] = axes_across(axis_);
	const float *sides = glm::value_ptr(point);
	return HWY_DYNAMIC_DISPATCH(open_columns)(plane_, sides[side_u], sides[side_v], sides[axis_], columns);
}

} // namespace thicket
#endif
