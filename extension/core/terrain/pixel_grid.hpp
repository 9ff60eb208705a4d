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

/// Bytes that another object owns. They neither move nor change while `owner` exists.
struct SharedBytes {
	std::shared_ptr<const void> owner;
	std::span<const std::uint8_t> bytes;
};

/// Refers to the pixels of an image that another object owns, without copying them. Patching copies
/// only the affected blocks. Copies of a grid share memory, but patching one copy does not affect
/// the others. Different threads may use different copies.
class PixelGrid {
public:
	static constexpr int max_side = 1 << 15; ///< Maximum number of pixels along x and y.
	static constexpr int max_pixel_bytes = 16;
	static constexpr int block_side = 128; ///< Edge length, in pixels, of the blocks that patching copies.

	/// Sets size.x * size.y pixels of `pixel_bytes` bytes each, row by row. Width and height must
	/// be 1 to max_side pixels, and a pixel must have 1 to max_pixel_bytes bytes. `bytes` may be
	/// longer, as for images with mipmaps. A failed call leaves the grid unchanged.
	Status set(glm::ivec2 size, int pixel_bytes, SharedBytes bytes);

	/// Replaces the pixels of a rectangle with those of `image`, which has the size and format of
	/// the whole grid. The pixels are copied, together with the rest of the blocks that the
	/// rectangle touches. Returns an error and leaves the grid unchanged if the rectangle is empty
	/// or not inside the grid, or if there are too few bytes.
	Status patch(const PixelRect &rect, std::span<const std::uint8_t> image);

	/// Returns true if no pixels were set.
	bool empty() const { return base_.bytes.empty(); }

	glm::ivec2 size() const { return size_; }
	int pixel_bytes() const { return static_cast<int>(pixel_bytes_); }

	/// Returns the bytes of a pixel.
	const std::uint8_t *pixel(int column, int row) const {
		if (blocks_.empty()) {
			return base_.bytes.data() + offset(column, row, size_.x);
		}
		return patched_pixel(column, row);
	}

	/// Returns true if both grids refer to the same bytes in memory and have the same patches.
	bool same_memory(const PixelGrid &other) const;

	/// Returns the smallest rectangle that contains all pixels that differ. The rectangle is empty
	/// if all pixels are equal, and covers the whole grid if the sizes differ. Shared memory is not
	/// compared.
	PixelRect difference(const PixelGrid &other) const;

private:
	using Block = std::vector<std::uint8_t>; ///< The bytes of block_side * block_side pixels.

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
	/// Blocks that were patched; null for unpatched ones. Empty if there are no patches.
	std::vector<std::shared_ptr<const Block>> blocks_;
};

} // namespace thicket
