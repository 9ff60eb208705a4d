#pragma once

#include "core/base/floating_point.hpp"
#include "core/base/split_mix.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace thicket {

/// Radius of an impulse (see clump_impulses) in cells. Only impulses in the 4 x 4 cells (in space,
/// 4 x 4 x 4 cells) around a position can reach it.
inline constexpr double impulse_reach = 1.5;

/// Number of knots of the clump tables per unit of the noise value. The first knot is at 0.
inline constexpr double clump_knots_per_unit = 16.0;
inline constexpr std::size_t clump_knots = 54;

/// These functions convert the lowest 16 bits: clump_unit to (0, 1), and clump_either_side to (-1,
/// 1), symmetric about 0.
inline double clump_unit(std::uint64_t bits) { return (static_cast<double>(bits & 0xffff) + 0.5) * 0x1p-16; }
inline double clump_either_side(std::uint64_t bits) { return (static_cast<double>(bits & 0xffff) - 32767.5) * 0x1p-15; }

/// Returns the clump noise before its values are transformed to a uniform distribution. `position`
/// is in cells, below 2^52 on both axes. The values are nearly normally distributed, with mean 0.
///
/// The method is sparse convolution (Lewis, "Algorithms for solid noise synthesis", 1989): each
/// cell has one impulse with a random position, height and slope. An impulse fades out smoothly.
/// Nothing depends on the corners of the cells, so the lattice is not visible.
inline double clump_impulses(glm::dvec2 position, std::uint64_t seed) {
	const glm::dvec2 corner(std::floor(position.x - impulse_reach), std::floor(position.y - impulse_reach));
	const glm::dvec2 from_corner = position - corner;
	const auto column = static_cast<std::uint64_t>(static_cast<std::int64_t>(corner.x));
	const auto row = static_cast<std::uint64_t>(static_cast<std::int64_t>(corner.y));
	double sum = 0.0;
	for (unsigned y = 0; y < 4; ++y) {
		const std::uint64_t row_seed = split_mix(seed + (row + y) * split_mix_gamma);
		for (unsigned x = 0; x < 4; ++x) {
			const std::uint64_t bits = split_mix(row_seed + (column + x) * split_mix_gamma);
			const glm::dvec2 offset(
					from_corner.x - (x + clump_unit(bits)), from_corner.y - (y + clump_unit(bits >> 16)));
			const double nearness =
					1.0 - (offset.x * offset.x + offset.y * offset.y) * (1.0 / (impulse_reach * impulse_reach));
			if (nearness > 0.0) {
				const double slope =
						offset.x * clump_either_side(bits >> 48) + offset.y * clump_either_side(split_mix(bits));
				sum += nearness * nearness * nearness * (clump_either_side(bits >> 32) + slope);
			}
		}
	}
	return sum;
}

/// Returns noise in space, by the same method. The values on a plane through the space have nearly
/// the same statistics for every orientation of the plane.
inline double clump_impulses(const glm::dvec3 &position, std::uint64_t seed) {
	const glm::dvec3 corner(std::floor(position.x - impulse_reach), std::floor(position.y - impulse_reach),
			std::floor(position.z - impulse_reach));
	const glm::dvec3 from_corner = position - corner;
	const auto cell = [](double along, unsigned step) {
		return static_cast<std::uint64_t>(static_cast<std::int64_t>(along)) + step;
	};
	double sum = 0.0;
	for (unsigned z = 0; z < 4; ++z) {
		const std::uint64_t layer_seed = split_mix(seed + cell(corner.z, z) * split_mix_gamma);
		for (unsigned y = 0; y < 4; ++y) {
			const std::uint64_t row_seed = split_mix(layer_seed + cell(corner.y, y) * split_mix_gamma);
			for (unsigned x = 0; x < 4; ++x) {
				const std::uint64_t bits = split_mix(row_seed + cell(corner.x, x) * split_mix_gamma);
				const glm::dvec3 offset = from_corner -
						glm::dvec3(x + clump_unit(bits), y + clump_unit(bits >> 16), z + clump_unit(bits >> 32));
				const double squared = offset.x * offset.x + offset.y * offset.y + offset.z * offset.z;
				const double nearness = 1.0 - squared * (1.0 / (impulse_reach * impulse_reach));
				if (nearness > 0.0) {
					const std::uint64_t extra_bits = split_mix(bits);
					const double slope = offset.x * clump_either_side(extra_bits) +
							offset.y * clump_either_side(extra_bits >> 16) +
							offset.z * clump_either_side(extra_bits >> 32);
					sum += nearness * nearness * nearness * (clump_either_side(bits >> 48) + slope);
				}
			}
		}
	}
	return sum;
}

} // namespace thicket
