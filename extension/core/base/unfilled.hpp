#pragma once

#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

namespace thicket {

/// An allocator for vectors whose elements are written before they are read. The vector does not
/// initialize elements that are added without a value. The threads that later write these elements
/// are therefore the first to touch their memory pages.
template <class Value>
struct UnfilledAllocator : std::allocator<Value> {
	UnfilledAllocator() = default;

	template <class Other>
	explicit(false) UnfilledAllocator(const UnfilledAllocator<Other> &) noexcept {}

	template <class Other>
	void construct([[maybe_unused]] Other *at) noexcept {
		static_assert(std::is_trivially_copyable_v<Other>);
	}

	template <class Other, class First, class... Rest>
	void construct(Other *at, First &&first, Rest &&...rest) {
		std::construct_at(at, std::forward<First>(first), std::forward<Rest>(rest)...);
	}
};

template <class Value>
using UnfilledVector = std::vector<Value, UnfilledAllocator<Value>>;

} // namespace thicket
