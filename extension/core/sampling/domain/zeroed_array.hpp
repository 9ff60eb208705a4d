#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>

namespace thicket {

/// Requests large memory pages for a block, on systems that support this. A random lookup then
/// costs one cache miss instead of two.
void prefer_large_pages(void *block, std::size_t bytes);

/// A fixed-size array of zeros, aligned to a cache line. Large arrays cost time and memory only for
/// the parts that are touched.
template <typename Item>
class ZeroedArray {
	static_assert(std::is_trivial_v<Item>);

public:
	ZeroedArray() = default;

	/// Allocates the array. Throws std::bad_alloc.
	explicit ZeroedArray(std::size_t size) : size_(size), block_(std::calloc(1, size * sizeof(Item) + line)) {
		if (block_ == nullptr) {
			throw std::bad_alloc();
		}
		const auto address = reinterpret_cast<std::uintptr_t>(block_.get());
		items_ = reinterpret_cast<Item *>((address + line - 1) & ~(line - 1));
		prefer_large_pages(items_, bytes());
	}

	Item *data() { return items_; }
	const Item *data() const { return items_; }
	Item &operator[](std::size_t index) { return items_[index]; }
	const Item &operator[](std::size_t index) const { return items_[index]; }
	std::size_t size() const { return size_; }
	std::size_t bytes() const { return size_ * sizeof(Item); }

private:
	static constexpr std::uintptr_t line = 64;

	struct Free {
		void operator()(void *block) const { std::free(block); }
	};

	std::size_t size_ = 0;
	std::unique_ptr<void, Free> block_;
	Item *items_ = nullptr;
};

} // namespace thicket
