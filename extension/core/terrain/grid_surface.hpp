#pragma once

#include "core/base/lazy.hpp"
#include "core/terrain/surface.hpp"

#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace thicket {

/// A rectangle in units of height samples.
struct PostRange {
	glm::dvec2 min;
	glm::dvec2 max;
};

/// The triangles of a grid of height samples: two for each patch of four samples. Their common edge
/// runs from the second sample of a row to the first sample of the next row. They face up. The
/// corners are read from the samples, so the surface needs little memory. Patches without ground
/// have no triangles.
///
/// `Grid` describes the height samples:
/// - `glm::ivec2 patches() const` returns the columns and rows of patches;
/// - `bool heights(glm::ivec2 patch, std::array<double, 4> &r_heights) const` reads the world
///   heights of a patch's samples, row by row, or returns false if the patch has no ground;
/// - `glm::dvec2 post_position(glm::ivec2 post) const` returns the world x and z of a height sample;
/// - `PostRange range(const Box3 &box) const` returns a box in units of height samples;
/// - `bool mirrored` is true if the world's x and z have the opposite orientation to columns and rows.
template <class Grid>
class GridSurface final : public Surface {
public:
	/// The grid may have at most max_triangles / 2 patches.
	explicit GridSurface(Grid grid) : grid_(std::move(grid)) {}

	std::size_t triangle_count() const override {
		const glm::ivec2 patches = grid_.patches();
		return 2 * static_cast<std::size_t>(patches.x) * static_cast<std::size_t>(patches.y);
	}

	std::array<glm::dvec3, 3> triangle(std::uint32_t index) const override {
		const auto columns = static_cast<std::uint32_t>(grid_.patches().x);
		const glm::ivec2 patch(index / 2 % columns, index / 2 / columns);
		std::array<double, 4> heights{};
		if (!grid_.heights(patch, heights)) {
			return {};
		}
		return corners(patch, heights, index % 2 != 0);
	}

	const Box3 &bounds() const override { return layout().bounds; }

	void find(const Box3 &box, std::vector<std::uint32_t> &r_triangles) const override {
		r_triangles.clear();
		const Layout &grid_layout = layout();
		if (!touch(grid_layout.bounds, box)) {
			return;
		}
		// A box may be infinite; the bounds are not.
		const auto &[first, last] =
				patches_in({glm::max(box.min, grid_layout.bounds.min), glm::min(box.max, grid_layout.bounds.max)});
		for (glm::ivec2 patch = first; patch.y <= last.y; ++patch.y) {
			for (patch.x = first.x; patch.x <= last.x; ++patch.x) {
				const Heights &block = grid_layout.blocks[block_of(patch)];
				if (block.low > box.max.y || block.high < box.min.y) {
					patch.x |= block_side - 1; // Continues after the block.
					continue;
				}
				add_patch(patch, box, r_triangles);
			}
		}
	}

private:
	/// Patches are examined in blocks of this many columns and rows, a power of two.
	static constexpr int block_side = 32;

	struct Heights {
		double low = std::numeric_limits<double>::infinity();
		double high = -std::numeric_limits<double>::infinity();
	};

	struct Layout {
		std::vector<Heights> blocks; ///< Row by row.
		Box3 bounds = no_box;
	};

	std::size_t block_of(glm::ivec2 patch) const {
		const int columns = (grid_.patches().x + block_side - 1) / block_side;
		return static_cast<std::size_t>(patch.y / block_side) * static_cast<std::size_t>(columns) +
				static_cast<std::size_t>(patch.x / block_side);
	}

	/// Reads all height samples, for the first search.
	const Layout &layout() const {
		return layout_.get([this] {
			Layout result;
			const glm::ivec2 patches = grid_.patches();
			result.blocks.resize(block_of(patches - 1) + 1);
			std::array<double, 4> heights{};
			for (glm::ivec2 patch{0}; patch.y < patches.y; ++patch.y) {
				for (patch.x = 0; patch.x < patches.x; ++patch.x) {
					if (grid_.heights(patch, heights)) {
						Heights &block = result.blocks[block_of(patch)];
						const auto &[lowest, highest] = std::ranges::minmax(heights);
						block.low = std::min(block.low, lowest);
						block.high = std::max(block.high, highest);
					}
				}
			}
			Heights extent;
			for (const Heights &block : result.blocks) {
				extent.low = std::min(extent.low, block.low);
				extent.high = std::max(extent.high, block.high);
			}
			for (int corner = 0; corner < 4 && extent.low <= extent.high; ++corner) {
				const glm::dvec2 post_position = grid_.post_position(patches * glm::ivec2(corner % 2, corner / 2));
				result.bounds = with(result.bounds,
						{{post_position.x, extent.low, post_position.y},
								{post_position.x, extent.high, post_position.y}});
			}
			return result;
		});
	}

	/// Returns the first and the last patch of a rectangle that contains all patches that touch the
	/// box, plus one patch on each side for rounding errors.
	std::array<glm::ivec2, 2> patches_in(const Box3 &box) const {
		const PostRange range = grid_.range(box);
		const auto clamped_patch = [](double at, int patches) {
			return at > 0.0 ? static_cast<int>(std::min(at, patches - 1.0)) : 0;
		};
		const glm::ivec2 patches = grid_.patches();
		return {glm::ivec2{clamped_patch(range.min.x - 1.0, patches.x), clamped_patch(range.min.y - 1.0, patches.y)},
				glm::ivec2{clamped_patch(range.max.x + 1.0, patches.x), clamped_patch(range.max.y + 1.0, patches.y)}};
	}

	void add_patch(glm::ivec2 patch, const Box3 &box, std::vector<std::uint32_t> &r_triangles) const {
		std::array<double, 4> heights{};
		if (!grid_.heights(patch, heights)) {
			return;
		}
		const auto columns = static_cast<std::uint32_t>(grid_.patches().x);
		const std::uint32_t first =
				2 * (static_cast<std::uint32_t>(patch.y) * columns + static_cast<std::uint32_t>(patch.x));
		for (std::uint32_t half = 0; half < 2; ++half) {
			const auto [a, b, c] = corners(patch, heights, half != 0);
			if (touch(with(with(Box3{a, a}, b), c), box)) {
				r_triangles.push_back(first + half);
			}
		}
	}

	std::array<glm::dvec3, 3> corners(glm::ivec2 patch, const std::array<double, 4> &heights, bool second) const {
		const auto corner = [&](int column, int row) {
			const glm::dvec2 post_position = grid_.post_position(patch + glm::ivec2(column, row));
			return glm::dvec3(post_position.x, heights[static_cast<std::size_t>(2 * row + column)], post_position.y);
		};
		const glm::dvec3 third_corner = second ? corner(1, 1) : corner(0, 0);
		return second != grid_.mirrored ? std::array{corner(1, 0), corner(0, 1), third_corner}
										: std::array{third_corner, corner(0, 1), corner(1, 0)};
	}

	Grid grid_;
	Lazy<Layout> layout_;
};

} // namespace thicket
