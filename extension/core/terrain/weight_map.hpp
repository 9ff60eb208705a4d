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

/// The share of the ground that belongs to each of a few textures: an image of up to four 8-bit channels. The map is
/// independent of meters: the first column and row lie at 0, the last at 1, whatever the resolution. A value type:
/// copies share their memory.
class WeightMap {
public:
	static constexpr int max_side = 1 << 15; ///< Pixels along x and along y.
	static constexpr int max_channels = 4;

	/// Copies `weights`, row by row, x fastest, with a pixel's channels adjacent. 255 is all of the ground. A side has 1 to max_side
	/// pixels; there are 1 to max_channels channels and one byte in `weights` for each. Refused input changes nothing.
	Status set(glm::ivec2 size, int channels, std::span<const std::uint8_t> weights);

	/// True if no weights were set.
	bool empty() const { return weights_ == nullptr; }

	/// Adds the rectangles where a different map has different weights: from 0 to 1 on both axes, extended to the neighboring pixels.
	/// Adds everything if the sizes or channels differ. Throws std::bad_alloc.
	void add_changes(const WeightMap &other, std::vector<Rect> &r_rects) const;

	/// The channels of textures, one bit each: texture 0 is the first channel. Numbers without a channel have no bit.
	unsigned channels_of(std::span<const std::int32_t> textures) const;

	/// The sum of some channels (bits as above) at a position, clamped to 0 to 1 on both axes: bilinear between pixels, 0 to 1. The map
	/// must not be empty.
	float weight(glm::dvec2 position, unsigned channels) const;

private:
	int sum(int column, int row, unsigned channels) const;

	glm::ivec2 size_{0};
	int channels_ = 0;
	std::shared_ptr<const std::vector<std::uint8_t>> weights_;
};

} // namespace thicket
