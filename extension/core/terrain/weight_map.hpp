#pragma once

#include "core/base/rect.hpp"
#include "core/base/status.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// The weights of up to four ground textures: an image with up to four 8-bit channels. Positions in
/// the map are not in meters: the first column and row are at 0 and the last ones at 1, at any
/// resolution. Copies of a map share memory.
class WeightMap {
public:
	static constexpr int max_side = 1 << 15; ///< Maximum number of pixels along x and y.
	static constexpr int max_channels = 4;

	/// Copies `weights`, row by row, with the channels of a pixel adjacent, one byte each. 255 is a
	/// weight of 1. Width and height must be 1 to max_side pixels, and a pixel must have 1 to
	/// max_channels channels. A failed call leaves the map unchanged.
	Status set(glm::ivec2 size, int channels, std::span<const std::uint8_t> weights);

	/// Returns true if no weights were set.
	bool empty() const { return weights_ == nullptr; }

	/// Appends the rectangles in which `other` has different weights, in map positions (0 to 1),
	/// extended to the neighboring pixels. If the sizes or channels differ, the whole map is
	/// appended. Throws std::bad_alloc.
	void add_changes(const WeightMap &other, std::vector<Rect> &r_rects) const;

	/// Returns the channels of `textures`, one bit each. Texture 0 is the first channel. Numbers
	/// without a channel are ignored.
	unsigned channels_of(std::span<const std::int32_t> textures) const;

	/// Returns the sum of the channels (bits as in channels_of) at a position, interpolated
	/// bilinearly and clamped to 0 to 1. Positions are clamped to 0 to 1 on both axes. The map must
	/// not be empty.
	float weight(glm::dvec2 position, unsigned channels) const;

private:
	int sum(int column, int row, unsigned channels) const;

	glm::ivec2 size_{0};
	int channels_ = 0;
	std::shared_ptr<const std::vector<std::uint8_t>> weights_;
};

} // namespace thicket
