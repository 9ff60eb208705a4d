#pragma once

#include "core/sampling/point_set.hpp"

#include <glm/vec2.hpp>

#include <cstdint>
#include <span>

namespace thicket {

/// Tells whether two machines made the same points: equal points have equal digests, FNV-1a over all their bits.
struct SetDigest {
	std::uint64_t places = 0; ///< Of the ids, positions and levels.
	std::uint64_t ranks = 0;  ///< Of the ranks apart, which better tables of the same sets may change.

	friend bool operator==(const SetDigest &, const SetDigest &) = default;
};

/// Of points of one set, whatever their order. Throws std::bad_alloc. O(points log points).
SetDigest digest(std::span<const SamplePoint> points);

/// Of the points of a whole domain in the order in which they stand, as numbers of double precision.
std::uint64_t digest(std::span<const glm::vec2> points);
std::uint64_t digest(std::span<const glm::dvec2> points);

} // namespace thicket
