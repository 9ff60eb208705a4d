#pragma once

#include "core/rules/painted_mask.hpp"

#include <glm/common.hpp>

#include <algorithm>

namespace thicket {

/// Base-2 logarithm of a block's edge length in pixels.
inline constexpr int block_bits = 6;
static_assert(1 << block_bits == PaintedMask::block_side);

/// Returns the block coordinate of a pixel along one axis.
constexpr int block_of(int pixel) { return pixel >> block_bits; }

/// Returns the index of a pixel in its block.
constexpr std::size_t index_in_block(int x, int y) {
	constexpr int mask = PaintedMask::block_side - 1;
	return static_cast<std::size_t>((y & mask) << block_bits | (x & mask));
}

/// Returns the number of columns of a rectangle, which must be within pixel_limit and not inverted.
inline std::size_t pixel_columns(const PixelRect &region) {
	return static_cast<std::size_t>(std::int64_t{region.max.x} - region.min.x);
}

/// Returns the number of pixels of a rectangle, which must be within pixel_limit and not inverted.
inline std::size_t pixel_count(const PixelRect &region) {
	return pixel_columns(region) * static_cast<std::size_t>(std::int64_t{region.max.y} - region.min.y);
}

inline bool is_uniform(std::span<const std::uint8_t> pixels) {
	return std::ranges::all_of(pixels, [&](std::uint8_t pixel) { return pixel == pixels.front(); });
}

/// Reads pixels of a mask, which must not change during the reader's lifetime. The reader caches
/// the last block, because neighboring pixels are usually in the same block.
class PaintedMask::Reader {
public:
	explicit Reader(const PaintedMask &mask) : mask_(mask), block_(mask.find({0, 0})) {}

	std::uint8_t at(int x, int y) {
		const Key key{block_of(y), block_of(x)};
		if (key == key_) {
			// The cached block contains this pixel.
			return pixel(x, y);
		}
		block_ = mask_.find(key);
		key_ = key;
		return pixel(x, y);
	}

private:
	std::uint8_t pixel(int x, int y) const { return block_ ? (*block_)[index_in_block(x, y)] : mask_.background_; }

	const PaintedMask &mask_;
	Key key_{0, 0};
	const Block *block_;
};

/// Changes pixels of a mask. An edit replaces blocks instead of writing to them, because copies of
/// the mask may share them. It allocates all memory before it changes the mask, so the mask is
/// unchanged after std::bad_alloc.
class PaintedMask::Edit {
public:
	explicit Edit(PaintedMask &r_mask) : mask_(r_mask) {}

	/// Replaces the value of each pixel of a region by `change(x, y, value)`. The region must be
	/// within pixel_limit.
	template <typename Change>
	void apply(const PixelRect &region, const Change &change) {
		if (region.empty()) {
			return;
		}
		Blocks blocks;
		for (int row = block_of(region.min.y); row <= block_of(region.max.y - 1); ++row) {
			for (int column = block_of(region.min.x); column <= block_of(region.max.x - 1); ++column) {
				const glm::ivec2 corner = glm::ivec2(column, row) * block_side;
				const PixelRect part{glm::max(region.min, corner), glm::min(region.max, corner + block_side)};
				const Block *const existing_block = mask_.find({row, column});
				Block block;
				if (existing_block) {
					block = *existing_block;
				} else {
					block.fill(mask_.background_);
				}
				if (!change_part(part, change, block)) {
					// Unchanged blocks remain shared with copies.
					continue;
				}
				const bool background = block.front() == mask_.background_ && is_uniform(block);
				blocks[{row, column}] = background ? nullptr : std::make_shared<const Block>(block);
			}
		}
		mask_.replace(std::move(blocks));
	}

	/// Returns a world rectangle that contains all changed densities, or an empty one if there are
	/// none.
	Rect changed_area() const;

private:
	/// Changes a part of a block. Returns true if the value of any pixel changed.
	template <typename Change>
	bool change_part(const PixelRect &part, const Change &change, Block &r_block) {
		bool has_changed = false;
		for (int y = part.min.y; y < part.max.y; ++y) {
			for (int x = part.min.x; x < part.max.x; ++x) {
				std::uint8_t &r_pixel = r_block[index_in_block(x, y)];
				const std::uint8_t value = change(x, y, r_pixel);
				if (value != r_pixel) {
					r_pixel = value;
					grow({x, y});
					has_changed = true;
				}
			}
		}
		return has_changed;
	}

	void grow(glm::ivec2 pixel) {
		const bool first = changed_.empty();
		changed_.min = first ? pixel : glm::min(changed_.min, pixel);
		changed_.max = first ? pixel + 1 : glm::max(changed_.max, pixel + 1);
	}

	PaintedMask &mask_;
	PixelRect changed_;
};

} // namespace thicket
