#pragma once

#include "core/base/pixel_rect.hpp"

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace thicket {

inline constexpr int changed_block_side = 128; ///< Edge length of the compared blocks, in elements.

/// Compares two grids of the same size block by block. For each block with differences, appends the
/// smallest rectangle around them to `r_rects`. The first block starts at (0, 0). The last block of
/// a row or column may be one element larger. `bytes_a(column, row)` and `bytes_b` return the bytes
/// of an element and of the elements after it in the same row of a block, `element_bytes` each.
/// Compares bytes, so that NAN equals itself. Throws std::bad_alloc.
template <class BytesA, class BytesB>
void add_changed_blocks(glm::ivec2 size, std::size_t element_bytes, const BytesA &bytes_a, const BytesB &bytes_b,
		std::vector<PixelRect> &r_rects) {
	const glm::ivec2 blocks = glm::max((size - 2) / changed_block_side + 1, glm::ivec2(1));
	for (glm::ivec2 block{0}; block.y < blocks.y; ++block.y) {
		for (block.x = 0; block.x < blocks.x; ++block.x) {
			const glm::ivec2 first = block * changed_block_side;
			const glm::ivec2 end{block.x + 1 == blocks.x ? size.x : first.x + changed_block_side,
					block.y + 1 == blocks.y ? size.y : first.y + changed_block_side};
			PixelRect changed{end, first};
			for (int row = first.y; row < end.y; ++row) {
				const std::uint8_t *a = bytes_a(first.x, row);
				const std::uint8_t *b = bytes_b(first.x, row);
				const int columns = end.x - first.x;
				if (std::memcmp(a, b, static_cast<std::size_t>(columns) * element_bytes) == 0) {
					continue;
				}
				const auto differs = [&](int column) {
					const std::size_t at = static_cast<std::size_t>(column) * element_bytes;
					return std::memcmp(a + at, b + at, element_bytes) != 0;
				};
				int left = 0;
				int right = columns - 1;
				while (!differs(left)) {
					++left;
				}
				while (!differs(right)) {
					--right;
				}
				changed.min = glm::min(changed.min, glm::ivec2(first.x + left, row));
				changed.max = glm::max(changed.max, glm::ivec2(first.x + right, row) + 1);
			}
			if (!changed.empty()) {
				r_rects.push_back(changed);
			}
		}
	}
}

} // namespace thicket
