#pragma once

#include "core/base/status.hpp"

namespace thicket {

/// How an instance stands on its point. Random parts come from the instance's id and the seed, each from a word of its
/// own, so that changing one setting leaves all others as they were.
struct Placement {
	double min_yaw_degrees = 0.0; ///< Rotation about the instance's own up axis, uniform in [min, max]; -360 to 360.
	double max_yaw_degrees = 360.0;
	double min_scale = 1.0; ///< Uniform in [min, max], the same on all axes; above 0, at most 1e4.
	double max_scale = 1.0;
	double align_to_normal = 0.0; ///< 0 stands upright, 1 along the normal, in between by the normalised mean; 0 to 1.
	double height_offset = 0.0;   ///< Metres along world y, negative sinks into the ground; |offset| <= 1e4.

	friend bool operator==(const Placement &, const Placement &) = default;
};

/// Refuses what is not finite, outside the ranges above, or a minimum above its maximum.
Status validate(const Placement &placement);

} // namespace thicket
