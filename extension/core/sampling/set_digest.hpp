#pragma once

#include "core/sampling/point_set.hpp"

#include <glm/vec2.hpp>

#include <cstdint>
#include <span>

namespace thicket {

/// Shows whether two machines generated the same points: equal points have equal digests, FNV-1a over all their bits.
struct SetDigest {
	std::uint64_t places = 0; ///< Digest of the ids, positions and levels.
	std::uint64_t ranks = 0;  ///< Digest of the ranks. Separate, because better rank tables may change them.

	friend bool operator==(const SetDigest &, const SetDigest &) = default;
};

/// Digest of the points of one set, independent of their order. Throws std::bad_alloc. O(points log points).
SetDigest digest(std::span<const SamplePoint> points);

/// Digest of the points of a whole domain, in their given order, as double-precision numbers.
std::uint64_t digest(std::span<const glm::vec2> points);
std::uint64_t digest(std::span<const glm::dvec2> points);

} // namespace thicket
