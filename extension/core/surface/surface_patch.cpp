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

// Each lane of a vector is a row of columns. The results determine only which work can be skipped,
// so their rounding does not affect the points.

constexpr std::size_t side = SurfaceColumns::side;
using Rows = hn::CappedTag<float, side>;
using Floats = hn::Vec<Rows>;

HWY_ALIGN static constexpr float edges[side + 1] = {0.0f, 0.0625f, 0.125f, 0.1875f, 0.25f, 0.3125f, 0.375f, 0.4375f,
		0.5f, 0.5625f, 0.625f, 0.6875f, 0.75f, 0.8125f, 0.875f, 0.9375f, 1.0f};

/// A range on the u axis for each row.
struct Ranges {
	Floats low;
	Floats high;
};

/// Returns, for each row, the columns whose lower borders are in a range.
HWY_INLINE auto columns_in(Rows d, const Ranges &range) {
	const hn::RebindToSigned<Rows> whole;
	const auto count = hn::Set(d, static_cast<float>(side));
	const auto zero = hn::Zero(d);
	const auto to_whole = [&](Floats value) HWY_ATTR {
		return hn::ConvertInRangeTo(whole, hn::Min(hn::Max(value, zero), count));
	};
	const auto begin =
			hn::Sub(hn::Set(whole, static_cast<std::int32_t>(side)), to_whole(hn::NegMulAdd(range.low, count, count)));
	const auto end = to_whole(hn::MulAdd(range.high, count, hn::Set(d, 1.0f)));
	const auto one = hn::Set(whole, 1);
	const auto bits = hn::Sub(hn::Shl(one, hn::Max(begin, end)), hn::Shl(one, begin));
	return hn::DemoteTo(hn::Rebind<std::uint16_t, Rows>(), bits);
}

/// A plane and a ball, in all lanes. With x = u - the ball's u, the squared distance of the plane from the
/// ball's center is a x^2 + 2 slope_u rise x + y^2 + rise^2, where a = 1 + slope_u^2.
struct Section {
	Floats u;
	Floats v;
	Floats slope_v;
	Floats shift;   // slope_u / a
	Floats inverse; // 1 / a
	Floats square;
	Floats a;
};

/// Returns, for each row, a range of u in which a plane is in a ball, on the line at `at_v`. The plane is at a height of `up` over the center of the ball.
HWY_INLINE Ranges in_ball(Rows d, const Section &section, Floats at_v, Floats up) {
	const auto y = hn::Sub(at_v, section.v);
	const auto rise = hn::MulAdd(y, section.slope_v, up);
	const auto discriminant = hn::NegMulAdd(rise, rise, hn::Mul(section.a, hn::NegMulAdd(y, y, section.square)));
	const auto middle = hn::NegMulAdd(rise, section.shift, section.u);
	// Where the line misses the ball, the range becomes empty.
	const auto half = hn::MulSub(hn::Sqrt(hn::Max(discriminant, hn::Zero(d))), section.inverse, hn::Set(d, 1e-5f));
	return {hn::Sub(middle, half), hn::Add(middle, half)};
}

HWY_INLINE Ranges common(const Ranges &a, const Ranges &b) { return {hn::Max(a.low, b.low), hn::Min(a.high, b.high)}; }

HWY_INLINE float absolute(float value) { return value < 0.0f ? -value : value; }
HWY_INLINE float lesser(float a, float b) { return a < b ? a : b; }

HWY_INLINE void close_covered(const SurfacePatch::Plane &plane, const SurfacePatch::Ball &ball, std::uint16_t *r_open) {
	const Rows d;
	const hn::Rebind<std::uint16_t, Rows> rows;
	const auto width = hn::Set(d, 1.0f / static_cast<float>(side));
	// A surface at a distance of up to `reach` from a plane, along the axis, is in a ball if the plane is in a
	// smaller ball: (q + reach)^2 = q^2 + 2 q reach + reach^2, where q is the plane's distance from the ball's center
	// along the axis.
	const float reach = 0.5f * (plane.highest - plane.lowest);
	const float corner = plane.height + 0.5f * (plane.highest + plane.lowest) - ball.along;
	const float middle = corner + 0.5f * (plane.slope_u + plane.slope_v);
	const float farthest =
			lesser(absolute(middle) + 0.5f * (absolute(plane.slope_u) + absolute(plane.slope_v)), ball.radius);
	const float square = ball.radius * ball.radius - reach * (2.0f * farthest + reach);
	const auto up = hn::Set(d, corner + plane.slope_u * ball.u + plane.slope_v * ball.v);
	const Section section{hn::Set(d, ball.u), hn::Set(d, ball.v), hn::Set(d, plane.slope_v),
			hn::Set(d, plane.slope_u * plane.inverse), hn::Set(d, plane.inverse), hn::Set(d, square),
			hn::Set(d, 1.0f + plane.slope_u * plane.slope_u)};
	// A ball that covers the corners of a part of a plane covers the part.
	for (std::size_t row = 0; row < side; row += hn::Lanes(d)) {
		const auto lower = hn::Load(d, edges + row);
		const auto upper = hn::LoadU(d, edges + row + 1);
		Ranges range = common(in_ball(d, section, lower, up), in_ball(d, section, upper, up));
		range.high = hn::Sub(range.high, width);
		std::uint16_t *open = r_open + row;
		hn::StoreU(hn::AndNot(columns_in(d, range), hn::LoadU(rows, open)), rows, open);
	}
}

/// Closes the columns of patches that the ball around a point covers. Returns true if no column of the patches is open.
bool cover_patches(SurfacePatch *patches, std::size_t count, const glm::vec3 &point) {
	bool is_closed = true;
	for (SurfacePatch *patch = patches; patch != patches + count; ++patch) {
		if (patch->is_bounded()) {
			close_covered(patch->plane(), patch->ball(point), patch->rows());
		}
		is_closed = is_closed && patch->open().is_empty();
	}
	return is_closed;
}

void cover_part(const SurfacePatch::Ball &ball, SurfacePatch::Part &r_part) {
	close_covered(r_part.plane, ball, r_part.open.rows.data());
}

/// Returns the columns whose centers are in a half-plane, in each row.
HWY_INLINE Ranges in_side(Rows d, const SurfacePatch::Side &half_plane, Floats middle_v) {
	const auto half = hn::Set(d, 0.5f / static_cast<float>(side));
	const auto all = hn::Set(d, 2.0f);
	// u * a >= -(v * b + c)
	const auto rest = hn::MulAdd(middle_v, hn::Set(d, half_plane.b), hn::Set(d, half_plane.c));
	const auto limit = hn::Sub(hn::Mul(rest, hn::Set(d, -1.0f / half_plane.a)), half);
	if (half_plane.a > 0.0f) {
		return {limit, all};
	}
	return {hn::Neg(all), limit};
}

/// Adds the columns whose centers are in all half-planes.
void add_columns(const SurfacePatch::Side *sides, std::size_t count, SurfaceColumns &r_columns) {
	const Rows d;
	const hn::Rebind<std::uint16_t, Rows> rows;
	for (std::size_t row = 0; row < side; row += hn::Lanes(d)) {
		const auto middle_v = hn::Add(hn::Load(d, edges + row), hn::Set(d, 0.5f / static_cast<float>(side)));
		Ranges range = in_side(d, sides[0], middle_v);
		for (std::size_t each = 1; each < count; ++each) {
			range = common(range, in_side(d, sides[each], middle_v));
		}
		std::uint16_t *to = r_columns.rows.data() + row;
		hn::StoreU(hn::Or(columns_in(d, range), hn::LoadU(rows, to)), rows, to);
	}
}

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace thicket {

HWY_EXPORT(cover_patches);
HWY_EXPORT(cover_part);
HWY_EXPORT(add_columns);

namespace {

constexpr double cell_width = surface_cell_size;

/// Largest slope for which a plane is used. A steeper plane rises through the whole cell within an
/// eighth of the cell's width.
constexpr double steepest = 8.0;

/// Larger than the rounding error of any height, but smaller than the distance from any line to a
/// surface that only touches the cell's edge.
constexpr float rounding = 4e-6f;

/// Half the width of the part of a column through which lines pass, in cell widths.
constexpr auto half =
		static_cast<float>(half_of_lines(cell_width / static_cast<double>(SurfaceColumns::side)) / cell_width);

/// Returns a half-plane whose border is not parallel to the u axis. It may be slightly larger than the given one.
SurfacePatch::Side side_of(float a, float b, float c) {
	constexpr float least = 1e-6f;
	if (std::abs(a) >= least) {
		return {a, b, c};
	}
	return {a < 0.0f ? -least : least, b, c + least};
}

/// Returns the columns in which a plane is between 0 and `top` somewhere.
SurfaceColumns entered(const SurfacePatch::Plane &plane, float top) {
	const float rise = (std::abs(plane.slope_u) + std::abs(plane.slope_v)) * half;
	const float above = plane.height + rise + plane.highest;
	const float below = plane.height - rise + plane.lowest;
	const std::array sides{
			side_of(plane.slope_u, plane.slope_v, above), side_of(-plane.slope_u, -plane.slope_v, top - below)};
	SurfaceColumns columns;
	HWY_DYNAMIC_DISPATCH(add_columns)(sides.data(), sides.size(), columns);
	return columns;
}

} // namespace

SurfacePatch::Facet SurfacePatch::facet_of(const SurfaceTriangle &triangle, int axis, const glm::dvec3 &low) {
	const auto [side_u, side_v] = axes_across(axis);
	const double along = at(triangle.normal, axis);
	Facet facet;
	const glm::dvec3 high = low + cell_width;
	// The triangle's bounds, clamped to the cell.
	const auto from = [&](int side) {
		const double offset = greater(at(triangle.low, side), at(low, side)) - at(low, side);
		return static_cast<float>(offset * (1.0 / cell_width)) - rounding;
	};
	const auto to = [&](int side) {
		const double offset = lesser(at(triangle.high, side), at(high, side)) - at(low, side);
		return static_cast<float>(offset * (1.0 / cell_width)) + rounding;
	};
	facet.from_u = from(side_u);
	facet.from_v = from(side_v);
	facet.to_u = to(side_u);
	facet.to_v = to(side_v);
	const auto is_outside = [&](int side) {
		return static_cast<int>(at(triangle.low, side) >= at(high, side)) |
				static_cast<int>(at(triangle.high, side) < at(low, side));
	};
	// No line along the axis hits a triangle that is parallel to it.
	if ((is_outside(0) | is_outside(1) | is_outside(2) | static_cast<int>(along == 0.0)) != 0) {
		facet.kind = Facet::Kind::absent;
		return facet;
	}
	const double u = -at(triangle.normal, side_u) / along;
	const double v = -at(triangle.normal, side_v) / along;
	if (std::abs(u) + std::abs(v) > steepest) {
		facet.kind = Facet::Kind::steep;
		return facet;
	}
	const glm::dvec3 offset = low - triangle.corners[0];
	const double units = u * at(offset, side_u) + v * at(offset, side_v) - at(offset, axis);
	facet.height = static_cast<float>(lesser(greater(units * (1.0 / cell_width), -100.0), 100.0));
	facet.slope_u = static_cast<float>(u);
	facet.slope_v = static_cast<float>(v);
	return facet;
}

bool SurfacePatch::add(const Facet &facet, float tolerance) {
	if (facet.kind == Facet::Kind::absent) {
		return true;
	}
	if (facet.kind == Facet::Kind::steep) {
		if (!is_empty_ && tolerance < unbounded) {
			return false;
		}
		is_empty_ = false;
		plane_.lowest = -unbounded;
		plane_.highest = unbounded;
		return true;
	}
	if (is_empty_) {
		is_empty_ = false;
		plane_ = {facet.height, facet.slope_u, facet.slope_v, 1.0f / (1.0f + facet.slope_u * facet.slope_u), -rounding,
				rounding};
		return true;
	}
	// The distance between two planes over the triangle's bounds is largest at one of their corners.
	const float more = facet.height - plane_.height;
	const float more_u = facet.slope_u - plane_.slope_u;
	const float more_v = facet.slope_v - plane_.slope_v;
	const float u_from = more_u * facet.from_u;
	const float u_to = more_u * facet.to_u;
	const float v_from = more_v * facet.from_v;
	const float v_to = more_v * facet.to_v;
	const float lowest = more + lesser(u_from, u_to) + lesser(v_from, v_to);
	const float highest = more + greater(u_from, u_to) + greater(v_from, v_to);
	if (greater(-lowest, highest) > tolerance) {
		return false;
	}
	plane_.lowest = lesser(plane_.lowest, lowest - 2.0f * rounding);
	plane_.highest = greater(plane_.highest, highest + 2.0f * rounding);
	return true;
}

void SurfacePatch::open_entered() {
	if (!is_empty_) {
		open_ = entered(plane_, 1.0f);
	}
}

void SurfacePatch::keep(const SurfaceColumns &columns) {
	for (std::size_t row = 0; row < SurfaceColumns::side; ++row) {
		open_.rows[row] &= columns.rows[row];
	}
}

void SurfacePatch::add_columns_over(
		const SurfaceTriangle &triangle, int axis, const glm::dvec3 &low, SurfaceColumns &r_columns) {
	if (at(triangle.normal, axis) == 0.0) {
		return;
	}
	const auto [side_u, side_v] = axes_across(axis);
	const SurfaceOutline outline(triangle, axis);
	std::array<Side, 3> sides{};
	for (std::size_t edge = 0; edge < sides.size(); ++edge) {
		const auto [u, v, distance] = outline.side(edge, at(low, side_u), at(low, side_v));
		const double size = std::abs(u) + std::abs(v);
		if (!(size > 0.0)) {
			sides[edge] = {1e-6f, 0.0f, 1.0f};
			continue;
		}
		const double from = std::clamp(distance / size / cell_width, -100.0, 100.0);
		sides[edge] = side_of(
				static_cast<float>(u / size), static_cast<float>(v / size), static_cast<float>(from) + half + rounding);
	}
	HWY_DYNAMIC_DISPATCH(add_columns)(sides.data(), sides.size(), r_columns);
}

bool SurfacePatch::cover(std::span<SurfacePatch> patches, const glm::vec3 &point) {
	return HWY_DYNAMIC_DISPATCH(cover_patches)(patches.data(), patches.size(), point);
}

SurfacePatch::Part SurfacePatch::part_in(std::uint32_t column) const {
	constexpr auto count = static_cast<float>(SurfaceColumns::side);
	const float u = static_cast<float>(column % SurfaceColumns::side) / count;
	const float v = static_cast<float>(column / SurfaceColumns::side) / count;
	const float height = plane_.height + plane_.slope_u * u + plane_.slope_v * v;
	const Plane plane{height * count, plane_.slope_u, plane_.slope_v, plane_.inverse, plane_.lowest * count,
			plane_.highest * count};
	const float rise = 0.5f * (std::abs(plane.slope_u) + std::abs(plane.slope_v));
	const float middle = plane.height + 0.5f * (plane.slope_u + plane.slope_v);
	const float reach = count + 1.0f + rise + plane.highest - plane.lowest;
	// The surface leaves the cell in few columns.
	const bool is_inside = middle - rise + plane.lowest >= 0.0f && middle + rise + plane.highest <= count;
	return {plane, u, v, middle, reach * reach, is_inside ? SurfaceColumns::all() : entered(plane, count)};
}

void SurfacePatch::cover_part(const glm::vec3 &point, Part &r_part) const {
	if (!is_bounded()) {
		return;
	}
	constexpr auto count = static_cast<float>(SurfaceColumns::side);
	const Ball at_point = ball(point);
	const Ball ball{(at_point.u - r_part.u) * count, (at_point.v - r_part.v) * count, at_point.along * count,
			at_point.radius * count};
	// Most balls that reach the cell do not reach the column.
	const float u = ball.u - 0.5f;
	const float v = ball.v - 0.5f;
	const float along = ball.along - r_part.middle;
	if (u * u + v * v + along * along < r_part.square_reach) {
		HWY_DYNAMIC_DISPATCH(cover_part)(ball, r_part);
	}
}

} // namespace thicket
#endif
