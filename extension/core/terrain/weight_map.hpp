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

/// How much of the ground belongs to each of a few textures: an image of up to four channels of 8 bits. It knows no meters: its
/// first column and row lie at 0, its last at 1, whatever its resolution. A value: copies share their memory.
class WeightMap {
public:
	static constexpr int max_side = 1 << 15; ///< Pixels along x and along y.
	static constexpr int max_channels = 4;

	/// Copies `weights`, row by row, x fastest, a pixel's channels next to each other; 255 is all of the ground. A side has 1 to
	/// max_side pixels, 1 to max_channels channels, `weights` a byte for each. Refused ones change nothing.
	Status set(glm::ivec2 size, int channels, std::span<const std::uint8_t> weights);

	/// True if nothing was set.
	bool empty() const { return weights_ == nullptr; }

	/// Adds where another map has different weights: rectangles from 0 to 1 on both axes, which reach to the pixels around.
	/// Everything if its size or its channels are not the same. Throws std::bad_alloc.
	void add_changes(const WeightMap &other, std::vector<Rect> &r_rects) const;

	/// The channels that textures stand for, a bit each: texture 0 is the first channel. Numbers without a channel have no bit.
	unsigned channels_of(std::span<const std::int32_t> textures) const;

	/// The sum of some channels (bits as above) at a position, 0 to 1 on both axes, others held to that: bilinear between pixels,
	/// 0 to 1. Only if not empty.
	float weight(glm::dvec2 position, unsigned channels) const;

private:
	int sum(int column, int row, unsigned channels) const;

	glm::ivec2 size_{0};
	int channels_ = 0;
	std::shared_ptr<const std::vector<std::uint8_t>> weights_;
};

} // namespace thicket
