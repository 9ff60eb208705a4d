#include "allocation_count.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <new>

#ifdef _WIN32
#include <malloc.h>
#endif

namespace {

constexpr std::size_t unlimited = std::numeric_limits<std::size_t>::max();

thread_local std::size_t allocations = 0;
thread_local std::size_t max_allocations = unlimited;
thread_local bool fails_once = false;
thread_local bool has_failed = false;

/// Counts an allocation. Returns false if it must fail.
bool granted() {
	if (allocations < max_allocations) {
		++allocations;
		return true;
	}
	has_failed = true;
	max_allocations = fails_once ? unlimited : max_allocations;
	return false;
}

void *plain_memory(std::size_t size) { return std::malloc(size == 0 ? 1 : size); }

#ifdef _WIN32 // Windows' C library cannot free aligned memory with free().
void *aligned_memory(std::size_t size, std::size_t alignment) { return _aligned_malloc(size, alignment); }
void free_aligned(void *memory) { _aligned_free(memory); }
#else
void *aligned_memory(std::size_t size, std::size_t alignment) {
	// aligned_alloc requires a multiple of the alignment.
	return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}
void free_aligned(void *memory) { std::free(memory); }
#endif

/// Returns the memory that `take` allocates. Throws std::bad_alloc if the allocation fails or must
/// fail.
template <typename Take>
void *allocate(const Take &take) {
	void *memory = granted() ? take() : nullptr;
	if (memory == nullptr) {
		throw std::bad_alloc();
	}
	return memory;
}

} // namespace

std::size_t allocation_count() { return allocations; }

AllocationLimit::AllocationLimit(std::size_t allowed, Fails fails) {
	max_allocations = allowed < unlimited - allocations ? allocations + allowed : unlimited;
	fails_once = fails == Fails::one;
	has_failed = false;
}

AllocationLimit::~AllocationLimit() { max_allocations = unlimited; }

bool AllocationLimit::reached() const { return has_failed; }

// The standard library's array forms call these operators. Its nothrow forms also do so, but sanitizers
// replace those.
void *operator new(std::size_t size) {
	return allocate([size] { return plain_memory(size); });
}

void *operator new(std::size_t size, std::align_val_t alignment) {
	return allocate(
			[=] { return aligned_memory(size, std::max(static_cast<std::size_t>(alignment), sizeof(void *))); });
}

void *operator new(std::size_t size, const std::nothrow_t &) noexcept {
	return granted() ? plain_memory(size) : nullptr;
}

void operator delete(void *memory) noexcept { std::free(memory); }

void operator delete(void *memory, std::size_t) noexcept { std::free(memory); }

void operator delete(void *memory, std::align_val_t) noexcept { free_aligned(memory); }

void operator delete(void *memory, std::size_t, std::align_val_t) noexcept { free_aligned(memory); }
