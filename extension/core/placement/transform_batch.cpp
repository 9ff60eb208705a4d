#include "core/placement/transform_batch.hpp"

#include "core/base/floating_point.hpp"
#include "core/base/instruction_sets.hpp"
#include "core/rules/instance_random.hpp"

#include <array>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/placement/transform_batch.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/placement/transform_batch-inl.hpp"

#if HWY_ONCE
namespace thicket {

HWY_EXPORT(make_transforms);

void TransformBatch::make(
		const Placement &placement, std::uint64_t seed, const UpField &up, std::span<const double> scale_numbers) {
	if (placement.scale_curve == nullptr && scale_numbers.empty()) {
		// The vectorized code performs the same operations in the same order.
		HWY_DYNAMIC_DISPATCH(make_transforms)(placement, seed, up, nullptr, *this);
		return;
	}
	alignas(64) std::array<double, capacity> fractions{};
	for (std::size_t i = 0; i < count; ++i) {
		const double number = !scale_numbers.empty() ? scale_numbers[i]
													 : unit_interval(instance_random(seed, ids[i], Draw::placement)[1]);
		fractions[i] = placement.scale_curve != nullptr ? placement.scale_curve->at(number) : number;
	}
	HWY_DYNAMIC_DISPATCH(make_transforms)(placement, seed, up, fractions.data(), *this);
}

} // namespace thicket
#endif
