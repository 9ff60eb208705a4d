#pragma once

#include "core/sampling/domain/frame.hpp"

#include <glm/vec2.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace thicket {

/// Maximum distance, in base squares along each axis, between the base squares of two points that
/// may be within a radius of each other.
inline constexpr std::uint32_t squares_reached = 2;

/// Calls action(x, y, base square) for the point itself and, on a torus, for its images across
/// nearby seams.
template <typename Real, class Action>
void for_each_image(const Frame<Real> &frame, Real x, Real y, glm::uvec2 square, Action &&action) {
	constexpr int reach = squares_reached;
	const glm::ivec2 count(frame.squares);
	const glm::ivec2 own(square);
	const auto shifts = [&](int axis) -> std::pair<int, int> {
		if (!frame.toroidal) {
			return {0, 0};
		}
		return {own[axis] >= count[axis] - reach ? -1 : 0, own[axis] < reach ? 1 : 0};
	};
	const auto [first_x, last_x] = shifts(0);
	const auto [first_y, last_y] = shifts(1);
	for (int shift_y = first_y; shift_y <= last_y; ++shift_y) {
		for (int shift_x = first_x; shift_x <= last_x; ++shift_x) {
			action(x + static_cast<Real>(shift_x * frame.period.x), y + static_cast<Real>(shift_y * frame.period.y),
					own + glm::ivec2(shift_x, shift_y) * count);
		}
	}
}

/// The cells of the domain that lie within a radius, plus a rounding margin, of an image. A cell is
/// width x width base squares.
struct NearCells {
	static constexpr std::size_t max_across = 2 * squares_reached + 1;

	std::array<glm::uvec2, max_across * max_across> cell;
	std::size_t count = 0;

	/// Finds the cells around an image. (x, y) is the biased position of the image (see Frame), and
	/// `square` its base square. Both may lie outside the domain.
	template <typename Real>
	NearCells(const Frame<Real> &frame, std::uint32_t width, Real x, Real y, glm::ivec2 square) {
		const Across columns(frame, width, 0, static_cast<double>(x) - frame.bias, square.x);
		const Across rows(frame, width, 1, static_cast<double>(y) - frame.bias, square.y);
		const double limit = frame.reach.x * frame.base.x + 4.0 * frame.quantum;
		for (std::size_t row = 0; row < rows.count; ++row) {
			for (std::size_t column = 0; column < columns.count; ++column) {
				cell[count] = {columns.first + column, rows.first + row};
				count += columns.squared[column] + rows.squared[row] < limit * limit ? 1 : 0;
			}
		}
	}

private:
	/// The columns (or rows) of cells that a disk can reach, with their squared distances from the
	/// disk's center along that axis.
	struct Across {
		std::size_t first;
		std::size_t count;
		std::array<double, max_across> squared;

		template <typename Real>
		Across(const Frame<Real> &frame, std::uint32_t width, int axis, double coordinate, int square) {
			constexpr int reach = squares_reached;
			const int wide = static_cast<int>(width);
			const int last_square = static_cast<int>(frame.squares[axis]) - 1;
			const int from = std::max(square - reach, 0) / wide;
			first = static_cast<std::size_t>(from);
			count = static_cast<std::size_t>(std::min(square + reach, last_square) / wide - from + 1);
			for (std::size_t i = 0; i < count; ++i) {
				const double low = static_cast<double>(first + i) * wide * frame.base[axis];
				const double high = low + wide * frame.base[axis];
				const double distance = std::max({low - coordinate, coordinate - high, 0.0});
				squared[i] = distance * distance;
			}
		}
	};
};

} // namespace thicket
