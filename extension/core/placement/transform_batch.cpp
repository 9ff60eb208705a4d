#include "core/placement/transform_batch.hpp"

#include "core/base/instruction_sets.hpp"

#include <algorithm>
#include <array>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/placement/transform_batch.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/placement/transform_batch-inl.hpp"

#if HWY_ONCE
namespace thicket {

HWY_EXPORT(make_transforms);

void TransformBatch::make(const Placement &placement, std::uint64_t seed, const UpField &up) {
	if (placement.scale_curve == nullptr) {
		// The vectorized code performs the same operations in the same order.
		HWY_DYNAMIC_DISPATCH(make_transforms)(placement, seed, up, *this);
		return;
	}
	for (std::size_t i = 0; i < count; ++i) {
		std::array<float, transform_floats> transform{};
		write_position(position(i), transform);
		scale[i] = write_basis(placement, seed, ids[i], normal(i), transform, up);
		for (std::size_t row = 0; row < rows.size(); ++row) {
			std::copy_n(transform.data() + row * row_floats, row_floats, rows[row].data() + i * row_floats);
		}
	}
}

} // namespace thicket
#endif
