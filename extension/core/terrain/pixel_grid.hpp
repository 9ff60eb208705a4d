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

/// Bytes that a different object owns. They neither move nor change while `owner` is held.
struct SharedBytes {
	std::shared_ptr<const void> owner;
	std::span<const std::uint8_t> bytes;
};

/// The pixels of an image that a different object owns, without a copy. Only pixels that are patched later are copied,
/// in blocks. A value type: copies share common memory, and a patch of one copy does not affect the others. Safe on any
/// thread.
class PixelGrid {
public:
	static constexpr int max_side = 1 << 15; ///< Pixels along x and along y.
	static constexpr int max_pixel_bytes = 16;
	static constexpr int block_side = 128; ///< In pixels: the block that is copied to patch a single one.

	/// Takes `size.x` * `size.y` pixels of `pixel_bytes` bytes each, row by row, x fastest. A side has 1 to max_side pixels, a pixel 1 to
	/// max_pixel_bytes bytes. `bytes` may be longer, as for images with mipmaps. Refused input changes nothing.
	Status set(glm::ivec2 size, int pixel_bytes, SharedBytes bytes);

	/// Replaces the pixels of a rectangle with those of `image`, which has the bytes of all pixels of the grid, as in
	/// `set`. These bytes are no longer needed afterwards. Refuses a rectangle that is empty or not inside the grid,
	/// and too few bytes. A failure changes nothing. Copies the blocks that the rectangle touches.
	Status patch(const PixelRect &rect, std::span<const std::uint8_t> image);

	/// True if no pixels were set.
	bool empty() const { return base_.bytes.empty(); }

	glm::ivec2 size() const { return size_; }
	int pixel_bytes() const { return static_cast<int>(pixel_bytes_); }

	/// The bytes of a pixel in the grid.
	const std::uint8_t *pixel(int column, int row) const {
		if (blocks_.empty()) {
			return base_.bytes.data() + offset(column, row, size_.x);
		}
		return patched_pixel(column, row);
	}

	/// True if both were set to the same bytes in memory and have no patches that only one of them has.
	bool same_memory(const PixelGrid &other) const;

	/// The smallest rectangle outside which both have the same pixels: empty if all are equal, everything if their sizes differ. Skips
	/// shared memory.
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
	std::vector<std::shared_ptr<const Block>> blocks_; ///< Null for blocks of the base. Empty if nothing is patched.
};

} // namespace thicket
