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

/// Returns all targets that this build was compiled for and that this CPU supports, best first.
inline std::vector<SimdTarget> simd_targets() {
	hwy::SetSupportedTargetsForTest(0);
	std::vector<SimdTarget> targets;
	for (const std::int64_t mask : hwy::SupportedAndGeneratedTargets()) {
		targets.push_back({mask, hwy::TargetName(mask)});
	}
	return targets;
}

/// During the lifetime of this object, every dispatch of this process uses one target. Afterward,
/// the best target is used again. Use it on one thread only.
class ForcedTarget {
public:
	explicit ForcedTarget(const SimdTarget &target) { hwy::SetSupportedTargetsForTest(target.mask); }
	~ForcedTarget() { hwy::SetSupportedTargetsForTest(0); }
	ForcedTarget(const ForcedTarget &) = delete;
	ForcedTarget &operator=(const ForcedTarget &) = delete;
};

/// Returns true if `work` runs vector code, which is compiled for each instruction set. Use it on
/// one thread only.
template <class Work>
bool runs_vectors(const Work &work) {
	hwy::GetChosenTarget().DeInit(); // Makes the next dispatch choose a target again.
	work();
	return hwy::GetChosenTarget().IsInitialized();
}

} // namespace thicket::bench
