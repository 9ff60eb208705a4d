#include "core/sampling/domain/zeroed_array.hpp"

#include <cstdint>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace thicket {

void prefer_large_pages([[maybe_unused]] void *block, [[maybe_unused]] std::size_t bytes) {
#ifdef __linux__
	constexpr std::uintptr_t page = std::uintptr_t{1} << 21;
	const auto begin = (reinterpret_cast<std::uintptr_t>(block) + page - 1) & ~(page - 1);
	const auto end = (reinterpret_cast<std::uintptr_t>(block) + bytes) & ~(page - 1);
	if (begin < end) {
		// This is only a hint. If the system ignores it, the array uses small pages.
		static_cast<void>(madvise(reinterpret_cast<void *>(begin), end - begin, MADV_HUGEPAGE));
	}
#endif
}

} // namespace thicket
