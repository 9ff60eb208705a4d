#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>

namespace thicket {

/// Asks the system for large pages under a block, where it has such a call: a place that is looked up at random then costs one
/// cache miss, not two.
void prefer_large_pages(void *block, std::size_t bytes);

/// A fixed array of zeros. Large ones cost time and memory only where they are touched.
template <typename Item>
class ZeroedArray {
	static_assert(std::is_trivial_v<Item>);

public:
	ZeroedArray() = default;

	/// Throws std::bad_alloc.
	explicit ZeroedArray(std::size_t size) : size_(size), items_(static_cast<Item *>(std::calloc(size, sizeof(Item)))) {
		if (size > 0 && items_ == nullptr) {
			throw std::bad_alloc();
		}
		prefer_large_pages(items_.get(), bytes());
	}

	Item *data() { return items_.get(); }
	const Item *data() const { return items_.get(); }
	Item &operator[](std::size_t index) { return items_.get()[index]; }
	const Item &operator[](std::size_t index) const { return items_.get()[index]; }
	std::size_t size() const { return size_; }
	std::size_t bytes() const { return size_ * sizeof(Item); }

private:
	struct Free {
		void operator()(Item *items) const { std::free(items); }
	};

	std::size_t size_ = 0;
	std::unique_ptr<Item, Free> items_;
};

} // namespace thicket
