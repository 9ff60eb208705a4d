#include "allocation_count.hpp"

#include <cstdlib>
#include <limits>
#include <new>

namespace {

constexpr std::size_t unlimited = std::numeric_limits<std::size_t>::max();

thread_local std::size_t allocations = 0;
thread_local std::size_t most_allocations = unlimited;
thread_local bool fails_once = false;
thread_local bool failed = false;

/// Counts a request; false for one that has to fail.
bool granted() {
	if (allocations < most_allocations) {
		++allocations;
		return true;
	}
	failed = true;
	most_allocations = fails_once ? unlimited : most_allocations;
	return false;
}

void *allocate(std::size_t size, std::size_t alignment) {
	if (!granted()) {
		throw std::bad_alloc();
	}
	// aligned_alloc wants a multiple of the alignment.
	const std::size_t rounded = (size + alignment - 1) / alignment * alignment;
	void *memory = alignment <= __STDCPP_DEFAULT_NEW_ALIGNMENT__ ? std::malloc(size == 0 ? 1 : size)
																 : std::aligned_alloc(alignment, rounded);
	if (memory == nullptr) {
		throw std::bad_alloc();
	}
	return memory;
}

} // namespace

std::size_t allocation_count() { return allocations; }

AllocationLimit::AllocationLimit(std::size_t allowed, Fails fails) {
	most_allocations = allowed < unlimited - allocations ? allocations + allowed : unlimited;
	fails_once = fails == Fails::one;
	failed = false;
}

AllocationLimit::~AllocationLimit() { most_allocations = unlimited; }

bool AllocationLimit::reached() const { return failed; }

// The array forms of the library come back to these. The nothrow ones do too, but a sanitizer has its own of them.
void *operator new(std::size_t size) { return allocate(size, __STDCPP_DEFAULT_NEW_ALIGNMENT__); }

void *operator new(std::size_t size, std::align_val_t alignment) {
	return allocate(size, static_cast<std::size_t>(alignment));
}

void *operator new(std::size_t size, const std::nothrow_t &) noexcept {
	return granted() ? std::malloc(size == 0 ? 1 : size) : nullptr;
}

void operator delete(void *memory) noexcept { std::free(memory); }

void operator delete(void *memory, std::size_t) noexcept { std::free(memory); }

void operator delete(void *memory, std::align_val_t) noexcept { std::free(memory); }

void operator delete(void *memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
