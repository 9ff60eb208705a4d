#include "core/terrain/inner_patches.hpp"

#include "core/base/instruction_sets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/terrain/inner_patches.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/terrain/inner_patches-inl.hpp"

#if HWY_ONCE
namespace thicket {

HWY_EXPORT(compute_patches);

void InnerPatches::compute(const Heights &heights) { HWY_DYNAMIC_DISPATCH(compute_patches)(heights, *this); }

} // namespace thicket
#endif
