#include "core/terrain/pixel_grid.hpp"

#include "core/base/check.hpp"
#include "core/base/guard.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <cstring>
#include <utility>

namespace thicket {

Status PixelGrid::set(glm::ivec2 size, int pixel_bytes, SharedBytes bytes) {
	const Status status = first_failure(check_range("pixels", size.x, 1, max_side),
			check_range("pixels", size.y, 1, max_side), check_range("pixel_bytes", pixel_bytes, 1, max_pixel_bytes));
	if (!status.ok()) {
		return status;
	}
	const std::size_t needed =
			static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) * static_cast<std::size_t>(pixel_bytes);
	if (bytes.bytes.size() < needed) {
		return Status::wrong_size("bytes", bytes.bytes.size(), at_least(needed));
	}
	size_ = size;
	pixel_bytes_ = static_cast<std::size_t>(pixel_bytes);
	base_ = std::move(bytes);
	blocks_.clear();
	return {};
}

PixelRect PixelGrid::rect_of(glm::ivec2 block) const {
	return {block * block_side, glm::min((block + 1) * block_side, size_)};
}

std::size_t PixelGrid::index_of(glm::ivec2 block) const {
	return static_cast<std::size_t>(block.y) * static_cast<std::size_t>(block_count().x) +
			static_cast<std::size_t>(block.x);
}

const std::uint8_t *PixelGrid::patched_pixel(int column, int row) const {
	const glm::ivec2 block{column / block_side, row / block_side};
	const std::shared_ptr<const Block> &patched = blocks_[index_of(block)];
	return patched == nullptr ? base_.bytes.data() + offset(column, row, size_.x)
							  : patched->data() + offset(column % block_side, row % block_side, block_side);
}

std::shared_ptr<PixelGrid::Block> PixelGrid::copy_of(glm::ivec2 block) const {
	auto copy = std::make_shared<Block>(pixel_bytes_ * block_side * block_side);
	const PixelRect rect = rect_of(block);
	for (int row = rect.min.y; row < rect.max.y; ++row) {
		std::memcpy(copy->data() + offset(0, row - rect.min.y, block_side), pixel(rect.min.x, row),
				static_cast<std::size_t>(rect.size().x) * pixel_bytes_);
	}
	return copy;
}

Status PixelGrid::patch(const PixelRect &rect, std::span<const std::uint8_t> image) {
	if (rect.empty() || rect.min.x < 0 || rect.min.y < 0 || rect.max.x > size_.x || rect.max.y > size_.y) {
		return {ErrorCode::out_of_range, "rect", static_cast<double>(rect.min.x), {}, {}, "Stay within the grid"};
	}
	if (image.size() < offset(0, size_.y, size_.x)) {
		return Status::wrong_size("image", image.size(), at_least(offset(0, size_.y, size_.x), "bytes"));
	}
	return guarded("blocks", static_cast<double>(image.size()), [&] {
		auto blocks = blocks_;
		blocks.resize(static_cast<std::size_t>(block_count().x) * static_cast<std::size_t>(block_count().y));
		const glm::ivec2 first = rect.min / block_side;
		const glm::ivec2 last = (rect.max - 1) / block_side;
		for (glm::ivec2 block = first; block.y <= last.y; ++block.y) {
			for (block.x = first.x; block.x <= last.x; ++block.x) {
				const std::shared_ptr<Block> copy = copy_of(block);
				const PixelRect whole = rect_of(block);
				const PixelRect part{glm::max(whole.min, rect.min), glm::min(whole.max, rect.max)};
				for (int row = part.min.y; row < part.max.y; ++row) {
					std::memcpy(copy->data() + offset(part.min.x - whole.min.x, row - whole.min.y, block_side),
							image.data() + offset(part.min.x, row, size_.x),
							static_cast<std::size_t>(part.size().x) * pixel_bytes_);
				}
				blocks[index_of(block)] = copy;
			}
		}
		blocks_ = std::move(blocks);
	});
}

bool PixelGrid::same_memory(const PixelGrid &other) const {
	return size_ == other.size_ && pixel_bytes_ == other.pixel_bytes_ &&
			base_.bytes.data() == other.base_.bytes.data() && blocks_ == other.blocks_;
}

bool PixelGrid::same_block(const PixelGrid &other, glm::ivec2 block) const {
	const auto of = [&](const PixelGrid &grid) {
		return grid.blocks_.empty() ? nullptr : grid.blocks_[index_of(block)].get();
	};
	const Block *mine = of(*this);
	return mine == of(other) && (mine != nullptr || base_.bytes.data() == other.base_.bytes.data());
}

/// Extends `r_rect` by the differing pixels of a block. Single pixels are compared only in rows
/// that differ.
void PixelGrid::widen_by_block(const PixelGrid &other, glm::ivec2 block, PixelRect &r_rect) const {
	const PixelRect rect = rect_of(block);
	const auto differs = [&](int column, int row, int columns) {
		return std::memcmp(pixel(column, row), other.pixel(column, row),
					   static_cast<std::size_t>(columns) * pixel_bytes_) != 0;
	};
	for (int row = rect.min.y; row < rect.max.y; ++row) {
		if (!differs(rect.min.x, row, rect.size().x)) {
			continue;
		}
		int first = rect.min.x;
		while (!differs(first, row, 1)) {
			++first;
		}
		int last = rect.max.x - 1;
		while (!differs(last, row, 1)) {
			--last;
		}
		r_rect.min = glm::min(r_rect.min, glm::ivec2(first, row));
		r_rect.max = glm::max(r_rect.max, glm::ivec2(last, row) + 1);
	}
}

PixelRect PixelGrid::difference(const PixelGrid &other) const {
	if (size_ != other.size_ || pixel_bytes_ != other.pixel_bytes_) {
		return {glm::ivec2(0), glm::max(size_, other.size_)};
	}
	PixelRect rect{size_, glm::ivec2(0)};
	for (glm::ivec2 block{0}; block.y < block_count().y; ++block.y) {
		for (block.x = 0; block.x < block_count().x; ++block.x) {
			const PixelRect inside = rect_of(block);
			const bool known = inside.min.x >= rect.min.x && inside.min.y >= rect.min.y && inside.max.x <= rect.max.x &&
					inside.max.y <= rect.max.y;
			if (known) {
				// The block lies inside the rectangle and cannot extend it.
				continue;
			}
			if (same_block(other, block)) {
				// Both grids share this memory, so its pixels are equal.
				continue;
			}
			widen_by_block(other, block, rect);
		}
	}
	return rect.empty() ? PixelRect{} : rect;
}

} // namespace thicket
