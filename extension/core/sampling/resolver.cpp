#include "core/sampling/resolver.hpp"

#include "core/base/instruction_sets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/sampling/resolver.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/sampling/resolver-inl.hpp"

#if HWY_ONCE
namespace thicket {

HWY_EXPORT(resolve_block);

ResolveResult resolve_block(std::span<LevelGrid> levels, const CellRect &block, const std::atomic<bool> *cancel) {
	return HWY_DYNAMIC_DISPATCH(resolve_block)(levels, block, cancel);
}

} // namespace thicket
#endif
