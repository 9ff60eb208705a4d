// The tests of near-inl.hpp for points with rounded coordinates. thrower.cpp compiles this file
// once for each instruction set.
#if defined(THICKET_ROUNDED_NEAR_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_ROUNDED_NEAR_INL
#undef THICKET_ROUNDED_NEAR_INL
#else
#define THICKET_ROUNDED_NEAR_INL
#endif

#include "core/sampling/domain/near-inl.hpp"

#include <glm/vec2.hpp>
#include <hwy/highway.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

/// A cache line of points, rounded to whole steps from a corner; see RoundedScale. Unused lanes are
/// 0, which is farther than a radius from every position that is looked up.
struct alignas(64) RoundedPoints {
	static constexpr std::size_t lanes = 16;

	std::array<std::uint16_t, lanes> x;
	std::array<std::uint16_t, lanes> y;

	/// Returns true if the line is full and may therefore lack points. Lanes are filled in order.
	bool full() const { return x[lanes - 1] != 0; }
};

/// The scale of rounded points, and the bounds of their error. A squared distance between rounded
/// points, in squared steps, is conclusive unless it lies between the two bounds.
struct RoundedScale {
	double steps_per_meter;
	float surely_below;  ///< Below this, the true squared distance is below the limit.
	float perhaps_below; ///< At or above this, the true squared distance is not below the limit.

	/// Sets the scale for points up to `width` meters from the corner on each axis. `limit` is the
	/// squared distance to compare with.
	RoundedScale(double width, double limit) : steps_per_meter(65535.0 / width) {
		// Each coordinate has an error of up to half a step, plus the rounding errors of floats up
		// to 2^16.
		constexpr double wrong = 0.75;
		const double steps = std::sqrt(limit) * steps_per_meter;
		surely_below = static_cast<float>((steps - wrong) * (steps - wrong));
		perhaps_below = static_cast<float>((steps + wrong) * (steps + wrong));
	}
};

/// Tests of rounded points, with the same functions as Near. `cells` supplies the exact points near
/// a part of a base square if a test is inconclusive.
template <class Cells>
struct RoundedNear {
	const RoundedPoints *points;
	RoundedScale scale;
	glm::dvec2 corner;
	Cells *cells;
	glm::uvec2 square;
	CenteredSquare<double> part;

	float x(double coordinate) const { return steps(coordinate - corner.x); }
	float y(double coordinate) const { return steps(coordinate - corner.y); }
	float steps(double meters) const { return static_cast<float>(meters * scale.steps_per_meter); }
	Near<double> exact() const { return cells->exactly_near(square, part); }
};

using Steps = hn::CappedTag<float, RoundedPoints::lanes>;

HWY_INLINE hn::Vec<Steps> load_steps(const std::uint16_t *coordinates) {
	const hn::Rebind<std::uint16_t, Steps> narrow;
	const hn::Rebind<std::int32_t, Steps> whole;
	return hn::ConvertTo(Steps(), hn::PromoteTo(whole, hn::LoadU(narrow, coordinates)));
}

/// Returns true if squared(x, y), in squared steps, is below the limit for any point. If the
/// rounded points are inconclusive, returns the result of exactly().
template <class Cells, class Squared, class Exactly>
HWY_INLINE bool any_below(const RoundedNear<Cells> &near, Squared &&squared, Exactly &&exactly) {
	const Steps d;
	bool unsure = near.points->full();
	for (std::size_t i = 0; i < RoundedPoints::lanes; i += hn::Lanes(d)) {
		const auto distance = squared(load_steps(near.points->x.data() + i), load_steps(near.points->y.data() + i));
		if (!hn::AllFalse(d, hn::Lt(distance, hn::Set(d, near.scale.perhaps_below)))) {
			if (!hn::AllFalse(d, hn::Lt(distance, hn::Set(d, near.scale.surely_below)))) {
				// The result is certain despite rounding.
				return true;
			}
			unsure = true;
		}
	}
	return unsure && exactly();
}

template <class Cells>
HWY_INLINE bool any_within(const RoundedNear<Cells> &near, double x, double y, double limit) {
	const Steps d;
	const auto at_x = hn::Set(d, near.x(x));
	const auto at_y = hn::Set(d, near.y(y));
	const auto squared = [&](auto xs, auto ys) HWY_ATTR {
		const auto dx = hn::Sub(xs, at_x);
		const auto dy = hn::Sub(ys, at_y);
		return hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy));
	};
	return any_below(near, squared, [&] { return any_within(near.exact(), x, y, limit); });
}

template <class Cells>
HWY_INLINE bool any_covers(const RoundedNear<Cells> &near, const CenteredSquare<double> &square, double limit) {
	const Steps d;
	const auto at_x = hn::Set(d, near.x(square.x));
	const auto at_y = hn::Set(d, near.y(square.y));
	const auto half_x = hn::Set(d, near.steps(square.half_x));
	const auto half_y = hn::Set(d, near.steps(square.half_y));
	const auto squared = [&](auto xs, auto ys) HWY_ATTR {
		const auto dx = hn::Add(hn::Abs(hn::Sub(xs, at_x)), half_x);
		const auto dy = hn::Add(hn::Abs(hn::Sub(ys, at_y)), half_y);
		return hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy));
	};
	return any_below(near, squared, [&] { return any_covers(near.exact(), square, limit); });
}

template <class Cells>
HWY_INLINE std::uint32_t covered_quarters(const RoundedNear<Cells> &near, const CenteredSquare<double> &first,
		const CenteredSquare<double> &last, double limit) {
	const Steps d;
	// The halves of the quarters differ only by rounding, far less than the error of rounded points.
	const auto half_x = hn::Set(d, near.steps(first.half_x));
	const auto half_y = hn::Set(d, near.steps(first.half_y));
	const auto left_x = hn::Set(d, near.x(first.x));
	const auto right_x = hn::Set(d, near.x(last.x));
	const auto low_y = hn::Set(d, near.y(first.y));
	const auto high_y = hn::Set(d, near.y(last.y));
	std::uint32_t surely = 0;
	std::uint32_t perhaps = near.points->full() ? 15 : 0;
	for (std::size_t i = 0; i < RoundedPoints::lanes; i += hn::Lanes(d)) {
		const auto xs = load_steps(near.points->x.data() + i);
		const auto ys = load_steps(near.points->y.data() + i);
		const auto left = hn::Add(hn::Abs(hn::Sub(xs, left_x)), half_x);
		const auto right = hn::Add(hn::Abs(hn::Sub(xs, right_x)), half_x);
		const auto low = hn::Add(hn::Abs(hn::Sub(ys, low_y)), half_y);
		const auto high = hn::Add(hn::Abs(hn::Sub(ys, high_y)), half_y);
		const auto check = [&](auto across, auto along, std::uint32_t bit) HWY_ATTR {
			const auto squared = hn::Add(hn::Mul(across, across), hn::Mul(along, along));
			surely |= hn::AllFalse(d, hn::Lt(squared, hn::Set(d, near.scale.surely_below))) ? 0u : bit;
			perhaps |= hn::AllFalse(d, hn::Lt(squared, hn::Set(d, near.scale.perhaps_below))) ? 0u : bit;
		};
		check(left, low, 1);
		check(right, low, 2);
		check(left, high, 4);
		check(right, high, 8);
	}
	return (perhaps & ~surely) == 0 ? surely : covered_quarters(near.exact(), first, last, limit);
}

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
