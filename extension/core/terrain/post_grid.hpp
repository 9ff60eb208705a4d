#pragma once

#include "core/base/pixel_rect.hpp"
#include "core/terrain/changed_blocks.hpp"

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace thicket {

/// A grid of height samples, in row order. Copies share memory, but changing one copy does not
/// affect the others. A change copies only the blocks that it touches, so its cost does not depend
/// on the size of the grid. Different threads may use different copies.
template <typename Post>
class PostGrid {
public:
	static constexpr int block_side = changed_block_side; ///< Edge length of a block, in patches.

	PostGrid() = default;

	/// Creates a grid. `posts` must have count.x * count.y height samples, with at least 2 along
	/// each edge.
	PostGrid(glm::ivec2 count, std::shared_ptr<const std::vector<Post>> posts) :
			count_(count), base_(std::move(posts)) {}

	bool empty() const { return base_ == nullptr; }
	glm::ivec2 count() const { return count_; }

	/// Accesses the height samples around a patch. On both axes, these are its two samples, the
	/// sample before them and the sample after them, if they exist.
	struct Window {
		const Post *first; ///< The first of the patch's four height samples.
		std::ptrdiff_t stride;
	};

	/// Returns the window around the patch whose first height sample is `patch`, from 0 to count()
	/// - 2. The window is valid until the grid changes.
	Window window(glm::ivec2 patch) const {
		if (blocks_.empty()) {
			return base_window(patch);
		}
		const std::shared_ptr<const Block> &block = blocks_[index_of(patch / block_side)];
		return block == nullptr ? base_window(patch) : Window{block->data() + place_in_block(patch), block_stride};
	}

	Post at(glm::ivec2 post) const {
		const glm::ivec2 patch = glm::min(post, count_ - 2);
		const Window near = window(patch);
		return near.first[(post.y - patch.y) * near.stride + (post.x - patch.x)];
	}

	/// Returns all height samples, row by row. Throws std::bad_alloc.
	std::vector<Post> flattened() const {
		if (blocks_.empty()) {
			return *base_;
		}
		std::vector<Post> posts;
		posts.reserve(base_->size());
		for (glm::ivec2 post{0}; post.y < count_.y; ++post.y) {
			for (post.x = 0; post.x < count_.x; ++post.x) {
				posts.push_back(at(post));
			}
		}
		return posts;
	}

	/// Replaces the height samples of a rectangle inside the grid; `posts` lists them row by row.
	/// Throws std::bad_alloc, with the grid unchanged.
	void patch(const PixelRect &rect, std::span<const Post> posts) {
		auto blocks = blocks_;
		const glm::ivec2 count = block_count();
		blocks.resize(static_cast<std::size_t>(count.x) * static_cast<std::size_t>(count.y));
		// Blocks also store the height samples around their patches, so they overlap.
		const glm::ivec2 first = glm::max((rect.min - 2) / block_side, glm::ivec2(0));
		const glm::ivec2 last = glm::min(rect.max / block_side, count - 1);
		for (glm::ivec2 block = first; block.y <= last.y; ++block.y) {
			for (block.x = first.x; block.x <= last.x; ++block.x) {
				blocks[index_of(block)] = patched(block, rect, posts);
			}
		}
		blocks_ = std::move(blocks);
	}

	/// Appends the rectangles in which the height samples of a grid of the same size differ; see
	/// add_changed_blocks().
	void add_changes(const PostGrid &other, std::vector<PixelRect> &r_rects) const {
		const auto bytes_of = [](const PostGrid &grid) {
			return [&grid](int column, int row) {
				const glm::ivec2 post{column, row};
				const glm::ivec2 patch = glm::min(post, grid.count_ - 2);
				const Window near = grid.window(patch);
				const Post *first = near.first + (post.y - patch.y) * near.stride + (post.x - patch.x);
				return reinterpret_cast<const std::uint8_t *>(first); // NOLINT(*-reinterpret-cast): its bytes.
			};
		};
		add_changed_blocks(count_, sizeof(Post), bytes_of(*this), bytes_of(other), r_rects);
	}

private:
	/// Number of height samples along an edge of a block: those of its patches, plus one before and
	/// one after.
	static constexpr int block_posts = block_side + 3;
	static constexpr std::ptrdiff_t block_stride = block_posts;
	using Block = std::vector<Post>;

	glm::ivec2 block_count() const { return (count_ - 2) / block_side + 1; }

	std::size_t index_of(glm::ivec2 block) const {
		return static_cast<std::size_t>(block.y) * static_cast<std::size_t>(block_count().x) +
				static_cast<std::size_t>(block.x);
	}

	static std::ptrdiff_t place_in_block(glm::ivec2 patch) {
		return (patch.y % block_side + 1) * block_stride + patch.x % block_side + 1;
	}

	Window base_window(glm::ivec2 patch) const {
		const auto stride = static_cast<std::ptrdiff_t>(count_.x);
		return {base_->data() + patch.y * stride + patch.x, stride};
	}

	/// Returns a copy of a block, in which the height samples inside `rect` are replaced.
	std::shared_ptr<const Block> patched(glm::ivec2 block, const PixelRect &rect, std::span<const Post> posts) const {
		const glm::ivec2 corner = block * block_side - 1;
		const glm::ivec2 from = glm::max(corner, glm::ivec2(0));
		const glm::ivec2 to = glm::min(corner + block_posts, count_);
		const std::shared_ptr<const Block> before = blocks_.empty() ? nullptr : blocks_[index_of(block)];
		auto result = before != nullptr ? std::make_shared<Block>(*before)
										: std::make_shared<Block>(static_cast<std::size_t>(block_posts) * block_posts);
		const auto in_block = [&](int column, int row) {
			return result->data() + (row - corner.y) * block_stride + (column - corner.x);
		};
		for (int row = from.y; before == nullptr && row < to.y; ++row) {
			std::copy_n(base_->data() + static_cast<std::ptrdiff_t>(row) * count_.x + from.x, to.x - from.x,
					in_block(from.x, row));
		}
		const glm::ivec2 begin = glm::max(from, rect.min);
		const glm::ivec2 end = glm::min(to, rect.max);
		for (int row = begin.y; row < end.y && begin.x < end.x; ++row) {
			const std::ptrdiff_t offset = static_cast<std::ptrdiff_t>(row - rect.min.y) * rect.size().x;
			std::copy_n(posts.data() + offset + (begin.x - rect.min.x), end.x - begin.x, in_block(begin.x, row));
		}
		return result;
	}

	glm::ivec2 count_{0};
	std::shared_ptr<const std::vector<Post>> base_;
	/// Blocks that were changed; null for unchanged ones. Empty if there are no changes.
	std::vector<std::shared_ptr<const Block>> blocks_;
};

} // namespace thicket
