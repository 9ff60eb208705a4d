#pragma once

#include "core/sampling/point_set.hpp"

#include <glm/vec2.hpp>

#include <cstdint>
#include <span>

namespace thicket {

/// Digests for checking that two machines generated the same points: FNV-1a over all bits of the
/// points. Equal points have equal digests.
struct SetDigest {
	std::uint64_t points = 0; ///< Digest of the ids, positions and levels.
	/// Digest of the ranks. It is separate, because better rank tables may change the ranks.
	std::uint64_t ranks = 0;

	friend bool operator==(const SetDigest &, const SetDigest &) = default;
};

/// Returns the digest of the points of one set, independent of their order, in O(points log points)
/// time. Throws std::bad_alloc.
SetDigest digest(std::span<const SamplePoint> points);

/// Returns the digest of the points of a whole domain, in the given order. Coordinates are
/// converted to double first.
std::uint64_t digest(std::span<const glm::vec2> points);
std::uint64_t digest(std::span<const glm::dvec2> points);

} // namespace thicket
