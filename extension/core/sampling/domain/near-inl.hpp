// Tests a dart and its square against the points around it. thrower.cpp compiles this file once for
// each instruction set.
#if defined(THICKET_NEAR_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_NEAR_INL
#undef THICKET_NEAR_INL
#else
#define THICKET_NEAR_INL
#endif

#include "core/base/floating_point.hpp"

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

/// Points that may lie within a radius of a square, as biased coordinates, with x and y in separate
/// arrays. Unused lanes are 0, which is farther than a radius from every position in the domain.
template <typename Real>
struct Near {
	static constexpr std::size_t block = 8; ///< `lanes` is a multiple of this.

	const Real *x;
	const Real *y;
	std::size_t lanes;
};

namespace hn = hwy::HWY_NAMESPACE;

template <typename Real>
using Wide = hn::CappedTag<Real, Near<Real>::block>;

/// Returns |points - center| + half, the distance to the farther edge of a square on one axis.
template <typename Real, class Vector>
HWY_INLINE Vector far_distance(const Real *points, Vector center, Vector half) {
	const Wide<Real> d;
	return hn::Add(hn::Abs(hn::Sub(hn::LoadU(d, points), center)), half);
}

/// Returns true if a point is too close to (x, y). `limit` is compared with squared distances.
template <typename Real>
HWY_INLINE bool any_within(const Near<Real> &near, Real x, Real y, Real limit) {
	const Wide<Real> d;
	for (std::size_t i = 0; i < near.lanes; i += hn::Lanes(d)) {
		const auto dx = hn::Sub(hn::LoadU(d, near.x + i), hn::Set(d, x));
		const auto dy = hn::Sub(hn::LoadU(d, near.y + i), hn::Set(d, y));
		const auto squared = hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy));
		if (!hn::AllFalse(d, hn::Lt(squared, hn::Set(d, limit)))) {
			return true;
		}
	}
	return false;
}

/// A square that contains all positions to which darts in an active square may round. It is stored
/// as its center and half its width on each axis.
template <typename Real>
struct CenteredSquare {
	Real x;
	Real y;
	Real half_x;
	Real half_y;
};

/// Returns true if the disk of a single point covers the square, which is tested by the square's
/// farthest corner (equation 2 of the paper, see DomainMethod).
template <typename Real>
HWY_INLINE bool any_covers(const Near<Real> &near, const CenteredSquare<Real> &square, Real limit) {
	const Wide<Real> d;
	for (std::size_t i = 0; i < near.lanes; i += hn::Lanes(d)) {
		const auto dx = far_distance(near.x + i, hn::Set(d, square.x), hn::Set(d, square.half_x));
		const auto dy = far_distance(near.y + i, hn::Set(d, square.y), hn::Set(d, square.half_y));
		const auto squared = hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy));
		if (!hn::AllFalse(d, hn::Lt(squared, hn::Set(d, limit)))) {
			return true;
		}
	}
	return false;
}

/// Returns one bit for each quarter of a square (x first) that the disk of a single point covers.
/// `first` is the quarter at the lower corner, and `last` is the opposite quarter.
template <typename Real>
HWY_INLINE std::uint32_t covered_quarters(
		const Near<Real> &near, const CenteredSquare<Real> &first, const CenteredSquare<Real> &last, Real limit) {
	const Wide<Real> d;
	std::uint32_t covered = 0;
	for (std::size_t i = 0; i < near.lanes && covered != 15; i += hn::Lanes(d)) {
		const auto left = far_distance(near.x + i, hn::Set(d, first.x), hn::Set(d, first.half_x));
		const auto right = far_distance(near.x + i, hn::Set(d, last.x), hn::Set(d, last.half_x));
		const auto low = far_distance(near.y + i, hn::Set(d, first.y), hn::Set(d, first.half_y));
		const auto high = far_distance(near.y + i, hn::Set(d, last.y), hn::Set(d, last.half_y));
		const auto left_2 = hn::Mul(left, left);
		const auto right_2 = hn::Mul(right, right);
		const auto low_2 = hn::Mul(low, low);
		const auto high_2 = hn::Mul(high, high);
		const auto within = hn::Set(d, limit);
		covered |= hn::AllFalse(d, hn::Lt(hn::Add(left_2, low_2), within)) ? 0u : 1u;
		covered |= hn::AllFalse(d, hn::Lt(hn::Add(right_2, low_2), within)) ? 0u : 2u;
		covered |= hn::AllFalse(d, hn::Lt(hn::Add(left_2, high_2), within)) ? 0u : 4u;
		covered |= hn::AllFalse(d, hn::Lt(hn::Add(right_2, high_2), within)) ? 0u : 8u;
	}
	return covered;
}

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
