#include "core/model/lod_shadow.hpp"

#include <algorithm>

namespace thicket {

bool casts_shadow(const LodCaster &lod) {
	const glm::dvec3 size = lod.size;
	const double longest = std::max({size.x, size.y, size.z});
	const double middle = std::max(std::min(size.x, size.y), std::min(std::max(size.x, size.y), size.z));
	const bool hidden = lod.per_square_meter >= dense_layer && longest < small_plant && longest >= 0.0 &&
			lod.distance >= near_in_sizes * longest;
	const bool too_thin = middle >= 0.0 && lod.distance > shadow_sight * middle;
	return !hidden && !too_thin;
}

} // namespace thicket
