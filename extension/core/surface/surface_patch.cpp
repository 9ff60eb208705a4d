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

// Returns the columns that a ball leaves open. The result determines only which work can be
// skipped, so its rounding does not affect the points.
std::uint32_t open_columns(const SurfacePatch::Plane &plane, float u, float v, float along) {
	constexpr std::size_t count = 16;
	const hn::CappedTag<float, count> d;
	HWY_ALIGN static constexpr float middles_u[count] = {0.125f, 0.375f, 0.625f, 0.875f, 0.125f, 0.375f, 0.625f, 0.875f,
			0.125f, 0.375f, 0.625f, 0.875f, 0.125f, 0.375f, 0.625f, 0.875f};
	HWY_ALIGN static constexpr float middles_v[count] = {0.125f, 0.125f, 0.125f, 0.125f, 0.375f, 0.375f, 0.375f, 0.375f,
			0.625f, 0.625f, 0.625f, 0.625f, 0.875f, 0.875f, 0.875f, 0.875f};
	const auto half = hn::Set(d, 0.125f);
	const auto reach = hn::Set(d, plane.reach);
	// The squared radius is 3 in squared cell widths, reduced to allow for rounding.
	const auto limit = hn::Set(d, 3.0f - 2e-5f);
	std::uint32_t open = 0;
	for (std::size_t first = 0; first < count; first += hn::Lanes(d)) {
		const auto middle_u = hn::Load(d, middles_u + first);
		const auto middle_v = hn::Load(d, middles_v + first);
		const auto height = hn::Add(hn::Add(hn::Set(d, plane.height), hn::Mul(hn::Set(d, plane.slope_v), middle_v)),
				hn::Mul(hn::Set(d, plane.slope_u), middle_u));
		const auto low = hn::Max(hn::Sub(height, reach), hn::Zero(d));
		const auto high = hn::Min(hn::Add(height, reach), hn::Set(d, 1.0f));
		const auto far_along = hn::Max(hn::Sub(hn::Set(d, along), low), hn::Sub(high, hn::Set(d, along)));
		const auto far_u = hn::Add(hn::Abs(hn::Sub(middle_u, hn::Set(d, u))), half);
		const auto far_v = hn::Add(hn::Abs(hn::Sub(middle_v, hn::Set(d, v))), half);
		const auto square =
				hn::Add(hn::Add(hn::Mul(far_along, far_along), hn::Mul(far_u, far_u)), hn::Mul(far_v, far_v));
		std::uint8_t bits[8] = {};
		hn::StoreMaskBits(d, hn::And(hn::Le(low, high), hn::Ge(square, limit)), bits);
		open |= (bits[0] | std::uint32_t{bits[1]} << 8) << first;
	}
	return open;
}

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace thicket {

HWY_EXPORT(open_columns);

namespace {

constexpr double cell_width = surface_cell_size;

/// Largest slope for which a plane is used. A steeper one crosses the cell within an eighth of its
/// width.
constexpr double steepest = 8.0;

/// This is more than the rounding error of all heights, but less than the distance from any line to
/// a surface that only touches the cell's edge.
constexpr float rounding = 4e-6f;

/// Half the width of the part of a column through which lines pass, in cell widths.
constexpr auto half = static_cast<float>(half_of_lines(cell_width / 4.0) / cell_width);

} // namespace

void SurfacePatch::add(const SurfaceTriangle &triangle, const glm::dvec3 &low) {
	const auto [side_u, side_v] = axes_across(axis_);
	const double along = at(triangle.normal, axis_);
	if (along == 0.0) {
		return; // No line along the axis hits the triangle.
	}
	const double u = -at(triangle.normal, side_u) / along;
	const double v = -at(triangle.normal, side_v) / along;
	if (std::abs(u) + std::abs(v) > steepest) {
		is_empty_ = false;
		plane_.reach = 1e3f;
		return;
	}
	const glm::dvec3 offset = low - triangle.corners[0];
	const double units = u * at(offset, side_u) + v * at(offset, side_v) - at(offset, axis_);
	const auto height = static_cast<float>(std::clamp(units / cell_width, -100.0, 100.0));
	const auto slope_u = static_cast<float>(u);
	const auto slope_v = static_cast<float>(v);
	if (is_empty_) {
		is_empty_ = false;
		plane_ = {height, slope_u, slope_v, (std::abs(slope_u) + std::abs(slope_v)) * half + rounding};
		return;
	}
	// The distance between two planes over the face is largest at one of its corners.
	const float at_0 = height - plane_.height;
	const float more_u = slope_u - plane_.slope_u;
	const float more_v = slope_v - plane_.slope_v;
	const float apart = std::max(
			{std::abs(at_0), std::abs(at_0 + more_u), std::abs(at_0 + more_v), std::abs(at_0 + more_u + more_v)});
	plane_.reach = std::max(
			plane_.reach, (std::abs(plane_.slope_u) + std::abs(plane_.slope_v)) * half + apart + 2.0f * rounding);
}

std::uint32_t SurfacePatch::entered() const {
	// The ball is so far away that it covers nothing.
	return open_beside(glm::vec3(1e3f));
}

std::uint32_t SurfacePatch::open_beside(const glm::vec3 &point) const {
	const auto [side_u, side_v] = axes_across(axis_);
	const float *sides = glm::value_ptr(point);
	return HWY_DYNAMIC_DISPATCH(open_columns)(plane_, sides[side_u], sides[side_v], sides[axis_]);
}

} // namespace thicket
#endif
