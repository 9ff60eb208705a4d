#pragma once

#include "core/base/floating_point.hpp"
#include "core/sampling/domain/domain.hpp"

#include <glm/vec2.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <type_traits>

namespace thicket {

/// The type of a coordinate of a square's lower corner, in squares of the finest level.
template <typename Real>
using SquareUnit = std::conditional_t<std::is_same_v<Real, float>, std::uint32_t, std::uint64_t>;

/// An active square, stored as its lower corner (section 3.3 of the paper, see DomainMethod). The
/// list that contains the square determines its level.
template <typename Real>
struct Square {
	SquareUnit<Real> x;
	SquareUnit<Real> y;
};

/// The dimensions of a domain: its base squares (equation 1 of the paper, see DomainMethod) and its
/// coordinate lattice.
///
/// All coordinates are multiples of `quantum`, below 2^bits * quantum, and are stored with `bias`
/// added. Differences are therefore exact, even across the seams of a torus, and no point has the
/// coordinate 0.
template <typename Real>
struct Frame {
	static constexpr int bits = std::numeric_limits<Real>::digits - 1;

	glm::dvec2 period;  ///< The domain's size in meters: `size` rounded down to a multiple of `quantum`.
	double quantum;     ///< Meters; a power of two.
	double bias;        ///< Meters: quantum * 2^bits. Greater than any coordinate, and greater than 8 radii.
	glm::uvec2 squares; ///< Number of base squares on each axis.
	glm::dvec2 base;    ///< Width of a base square in meters, at most radius / sqrt(2).
	/// The finest level of squares. In single precision, its squares are at most a quarter of a
	/// quantum wide. All darts in most of them therefore round to the same position, and such a
	/// square is never split. Each position has several of them, so no open position is lost when
	/// a square between positions is too fine to split.
	int finest;
	glm::dvec2 unit;  ///< Meters per SquareUnit.
	glm::dvec2 reach; ///< Radius in base squares.
	/// If a computed squared distance is at least this, the true distance is at least the radius.
	Real limit;
	bool toroidal;

	static Frame of(const DomainRequest &request) {
		Frame frame;
		const double extent = std::max({request.size.x, request.size.y, 8.0 * request.radius});
		frame.quantum = std::ldexp(1.0, std::ilogb(extent) + 1 - bits);
		frame.bias = std::ldexp(frame.quantum, bits);
		frame.toroidal = request.toroidal;
		for (int axis = 0; axis < 2; ++axis) {
			const double steps = std::floor(request.size[axis] / frame.quantum);
			frame.period[axis] = std::max(steps, 1.0) * frame.quantum;
			const double count = std::ceil(frame.period[axis] * std::numbers::sqrt2 / request.radius);
			frame.squares[axis] = static_cast<std::uint32_t>(std::max(count, 1.0));
			frame.base[axis] = frame.period[axis] / frame.squares[axis];
			frame.reach[axis] = request.radius / frame.base[axis];
		}
		const int index_bits = std::bit_width(std::max(frame.squares.x, frame.squares.y));
		const int by_precision = std::ilogb(std::max(frame.base.x, frame.base.y) / frame.quantum) + 3;
		frame.finest = std::clamp(by_precision, 0, std::min(32, 8 * static_cast<int>(sizeof(Unit)) - index_bits));
		frame.unit = {std::ldexp(frame.base.x, -frame.finest), std::ldexp(frame.base.y, -frame.finest)};
		// The two squares and their sum are each rounded once. The slack ensures that the true
		// squared distance is not below the squared radius.
		const double slack = 8.0 * static_cast<double>(std::numeric_limits<Real>::epsilon());
		frame.limit = static_cast<Real>(request.radius * request.radius * (1.0 + slack));
		return frame;
	}

	/// Returns the biased coordinate nearest to a position in the domain.
	Real coordinate(double meters, int axis) const {
		const double to_quanta = 1.5 * 0x1p52 * quantum; // The last bit of this number is one quantum.
		const double rounded = (meters + to_quanta) - to_quanta;
		return static_cast<Real>(std::min(rounded, period[axis] - quantum) + bias);
	}

	Real to_plain(Real biased) const { return biased - static_cast<Real>(bias); }

	std::uint64_t base_squares() const { return std::uint64_t{squares.x} * squares.y; }

private:
	using Unit = SquareUnit<Real>;
};

} // namespace thicket
