#pragma once

#include "core/base/floating_point.hpp"
#include "core/base/split_mix.hpp"

#include <glm/vec2.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace thicket {

/// How far an impulse of the clump noise reaches, in cells: never beyond the 4 x 4 cells around a position.
inline constexpr double impulse_reach = 1.5;

/// The knots of clump_table.inc are 1 / clump_knots_per_unit apart in noise values, starting at 0.
inline constexpr double clump_knots_per_unit = 16.0;
inline constexpr std::size_t clump_knots = 54;

/// The clump noise before it is made uniform, at a position in cells, which must be below 2^52 on both axes. Nearly normal, with mean 0.
///
/// Sparse convolution (Lewis, "Algorithms for solid noise synthesis", 1989): each cell has one impulse, at a random position in it, with
/// a random height and a random slope. The impulse fades out smoothly. Nothing is tied to the corners of the cells, so the lattice does
/// not show.
inline double clump_impulses(glm::dvec2 position, std::uint64_t seed) {
	const glm::dvec2 corner(std::floor(position.x - impulse_reach), std::floor(position.y - impulse_reach));
	const glm::dvec2 from_corner = position - corner;
	const auto column = static_cast<std::uint64_t>(static_cast<std::int64_t>(corner.x));
	const auto row = static_cast<std::uint64_t>(static_cast<std::int64_t>(corner.y));
	// Numbers from 16 bits: in (0, 1), and in (-1, 1), symmetric about 0.
	const auto unit = [](std::uint64_t bits) {
		return (static_cast<double>(bits & 0xffff) + 0.5) * 0x1p-16;
	};
	const auto either_side = [](std::uint64_t bits) {
		return (static_cast<double>(bits & 0xffff) - 32767.5) * 0x1p-15;
	};
	double sum = 0.0;
	for (unsigned y = 0; y < 4; ++y) {
		const std::uint64_t row_seed = split_mix(seed + (row + y) * split_mix_gamma);
		for (unsigned x = 0; x < 4; ++x) {
			const std::uint64_t bits = split_mix(row_seed + (column + x) * split_mix_gamma);
			const glm::dvec2 offset(from_corner.x - (x + unit(bits)), from_corner.y - (y + unit(bits >> 16)));
			const double near =
					1.0 - (offset.x * offset.x + offset.y * offset.y) * (1.0 / (impulse_reach * impulse_reach));
			if (near > 0.0) {
				const double slope = offset.x * either_side(bits >> 48) + offset.y * either_side(split_mix(bits));
				sum += near * near * near * (either_side(bits >> 32) + slope);
			}
		}
	}
	return sum;
}

} // namespace thicket
