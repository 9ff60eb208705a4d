#include "core/sampling/resolver.hpp"

// The scalar path has vectors of four emulated lanes, as wide as the narrowest real ones. Highway avoids it with compilers
// that miscompile a 16-bit multiply; nothing here uses that, and tests compare the bits of all paths.
#define HWY_BROKEN_EMU128 0

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
