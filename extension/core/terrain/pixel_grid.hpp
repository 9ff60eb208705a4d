#pragma once

#include "core/base/pixel_rect.hpp"
#include "core/base/status.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// Bytes that somebody else keeps. They neither move nor change while `owner` is held.
struct SharedBytes {
	std::shared_ptr<const void> owner;
	std::span<const std::uint8_t> bytes;
};

/// The pixels of an image that somebody else keeps, without a copy; only what is patched later is copied, in blocks. A value:
/// copies share what they have in common, and a patch of one is not seen in another. Safe on any thread.
class PixelGrid {
public:
	static constexpr int max_side = 1 << 15; ///< Pixels along x and along y.
	static constexpr int max_pixel_bytes = 16;
	static constexpr int block_side = 128; ///< Pixels: what is copied for a patch of a single one.

	/// Takes `size.x` * `size.y` pixels of `pixel_bytes` bytes each, row by row, x fastest. A side has 1 to max_side pixels, a
	/// pixel 1 to max_pixel_bytes; `bytes` may be longer, as those of images with mipmaps are. Refused ones change nothing.
	Status set(glm::ivec2 size, int pixel_bytes, SharedBytes bytes);

	/// Replaces the pixels of a rectangle by those that `image` has there: bytes of all pixels of the grid, as `set` takes them,
	/// which are not needed any more afterwards. Refuses a rectangle that is empty or not within the grid, and too few bytes; a
	/// failure changes nothing. Copies the blocks that the rectangle touches.
	Status patch(const PixelRect &rect, std::span<const std::uint8_t> image);

	/// True if nothing was set.
	bool empty() const { return base_.bytes.empty(); }

	glm::ivec2 size() const { return size_; }
	int pixel_bytes() const { return static_cast<int>(pixel_bytes_); }

	/// The bytes of a pixel of the grid.
	const std::uint8_t *pixel(int column, int row) const {
		if (blocks_.empty()) {
			return base_.bytes.data() + offset(column, row, size_.x);
		}
		return patched_pixel(column, row);
	}

	/// True if both were set to the same bytes in memory, and have no patches that only one of them has.
	bool same_memory(const PixelGrid &other) const;

	/// The smallest rectangle outside which both have the same pixels; empty if they have all, everything if their sizes differ.
	/// What is the same memory is not looked at.
	PixelRect difference(const PixelGrid &other) const;

private:
	using Block = std::vector<std::uint8_t>; ///< block_side * block_side pixels.

	std::size_t offset(int column, int row, int columns) const {
		return (static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column)) *
				pixel_bytes_;
	}
	glm::ivec2 block_count() const { return (size_ + (block_side - 1)) / block_side; }
	PixelRect rect_of(glm::ivec2 block) const;
	std::size_t index_of(glm::ivec2 block) const;
	const std::uint8_t *patched_pixel(int column, int row) const;
	std::shared_ptr<Block> copy_of(glm::ivec2 block) const;
	bool same_block(const PixelGrid &other, glm::ivec2 block) const;
	void widen_by_block(const PixelGrid &other, glm::ivec2 block, PixelRect &r_rect) const;

	glm::ivec2 size_{0};
	std::size_t pixel_bytes_ = 0;
	SharedBytes base_;
	std::vector<std::shared_ptr<const Block>> blocks_; ///< Null for those that the base has. Empty: nothing is patched.
};

} // namespace thicket
