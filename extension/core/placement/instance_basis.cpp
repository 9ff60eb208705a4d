#include "core/placement/instance_basis.hpp"

#include "core/base/instruction_sets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/placement/instance_basis.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/placement/instance_basis-inl.hpp"

#if HWY_ONCE
namespace thicket {

HWY_EXPORT(make_bases);

void BasisBatch::make(const Placement &placement, std::uint64_t seed) {
	if (placement.scale_curve == nullptr) {
		HWY_DYNAMIC_DISPATCH(make_bases)(placement, seed, *this);
		return;
	}
	for (std::size_t i = 0; i < count; ++i) {
		std::array<float, transform_floats> transform{};
		const glm::vec3 normal(normal_x[i], normal_y[i], normal_z[i]);
		scale[i] = write_basis(placement, seed, ids[i], normal, transform);
		for (std::size_t row = 0; row < 3; ++row) {
			for (std::size_t column = 0; column < 3; ++column) {
				basis[3 * row + column][i] = transform[4 * row + column];
			}
		}
	}
}

} // namespace thicket
#endif
