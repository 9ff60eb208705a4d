#pragma once

#include "core/base/instruction_sets.hpp"

#include <hwy/highway.h>

#include <cstdint>
#include <string>
#include <vector>

namespace thicket::bench {

/// An instruction set that Highway's run-time dispatch can be forced to use.
struct SimdTarget {
	std::int64_t mask;
	std::string name;
};

/// All targets that this build was compiled for and this processor supports, best first.
inline std::vector<SimdTarget> simd_targets() {
	hwy::SetSupportedTargetsForTest(0);
	std::vector<SimdTarget> targets;
	for (const std::int64_t mask : hwy::SupportedAndGeneratedTargets()) {
		targets.push_back({mask, hwy::TargetName(mask)});
	}
	return targets;
}

/// While an object of this type lives, every dispatch of this process uses one target. Afterwards, the best one is used
/// again. Not thread safe.
class ForcedTarget {
public:
	explicit ForcedTarget(const SimdTarget &target) { hwy::SetSupportedTargetsForTest(target.mask); }
	~ForcedTarget() { hwy::SetSupportedTargetsForTest(0); }
	ForcedTarget(const ForcedTarget &) = delete;
	ForcedTarget &operator=(const ForcedTarget &) = delete;
};

/// True if `work` runs code that is compiled for each instruction set, that is, in vectors. Not thread safe.
template <class Work>
bool runs_vectors(const Work &work) {
	hwy::GetChosenTarget().DeInit(); // The next dispatch chooses a target again.
	work();
	return hwy::GetChosenTarget().IsInitialized();
}

} // namespace thicket::bench
