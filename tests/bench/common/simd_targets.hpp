#pragma once

#include "core/base/instruction_sets.hpp"

#include <hwy/highway.h>

#include <cstdint>
#include <string>
#include <vector>

namespace thicket::bench {

/// An instruction set that Highway's run-time dispatch can be told to use.
struct SimdTarget {
	std::int64_t mask;
	std::string name;
};

/// All targets that this build holds code for and this processor runs, best first.
inline std::vector<SimdTarget> simd_targets() {
	hwy::SetSupportedTargetsForTest(0);
	std::vector<SimdTarget> targets;
	for (const std::int64_t mask : hwy::SupportedAndGeneratedTargets()) {
		targets.push_back({mask, hwy::TargetName(mask)});
	}
	return targets;
}

/// Every dispatch of this process uses one target while an object of this type lives, and the best again afterwards.
/// Not thread safe.
class ForcedTarget {
public:
	explicit ForcedTarget(const SimdTarget &target) { hwy::SetSupportedTargetsForTest(target.mask); }
	~ForcedTarget() { hwy::SetSupportedTargetsForTest(0); }
	ForcedTarget(const ForcedTarget &) = delete;
	ForcedTarget &operator=(const ForcedTarget &) = delete;
};

/// Whether `work` runs code that is compiled for each instruction set: by vectors. Not thread safe.
template <class Work>
bool runs_vectors(const Work &work) {
	hwy::GetChosenTarget().DeInit(); // Whoever dispatches next chooses anew.
	work();
	return hwy::GetChosenTarget().IsInitialized();
}

} // namespace thicket::bench
