#include "allocation_counter.hpp"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::uint64_t> count{0};

void *allocate(std::size_t size, std::size_t alignment) {
	count.fetch_add(1, std::memory_order_relaxed);
	const std::size_t asked = size == 0 ? 1 : size;
	void *memory = alignment > __STDCPP_DEFAULT_NEW_ALIGNMENT__
			? std::aligned_alloc(alignment, (asked + alignment - 1) / alignment * alignment)
			: std::malloc(asked);
	if (memory == nullptr) {
		throw std::bad_alloc();
	}
	return memory;
}

} // namespace

std::uint64_t thicket::allocations() { return count.load(std::memory_order_relaxed); }

// The array and nothrow forms of the library call these.
void *operator new(std::size_t size) { return allocate(size, 0); }
void *operator new(std::size_t size, std::align_val_t alignment) {
	return allocate(size, static_cast<std::size_t>(alignment));
}
void operator delete(void *memory) noexcept { std::free(memory); }
void operator delete(void *memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void *memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void *memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
