#pragma once

// The parts of a dab that planes and planets share.

#include "core/base/floating_point.hpp"
#include "core/rules/painted_mask.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// Returns the fraction of the way to its target by which a dab changes a pixel at a distance in meters
/// from the dab's center, 0 to 1.
inline double brush_weight(const Brush &brush, double distance) {
	const double inner = brush.hardness * brush.radius;
	if (distance <= inner) {
		return brush.strength;
	}
	if (distance >= brush.radius) {
		return 0.0;
	}
	const double part = (brush.radius - distance) / (brush.radius - inner);
	return brush.strength * (part * part * (3.0 - 2.0 * part));
}

/// Returns a pixel's value, moved toward a target by a fraction of the way. A weight of at least half an
/// 8-bit step moves it by at least one step.
inline std::uint8_t moved_toward(std::uint8_t value, int target, double weight) {
	const int way = target - value;
	const bool at_least_one = way != 0 && weight >= 0.5 / 255.0;
	const int steps = static_cast<int>(std::floor(std::abs(way) * weight + 0.5));
	const int taken = std::max(steps, at_least_one ? 1 : 0);
	return static_cast<std::uint8_t>(way < 0 ? value - taken : value + taken);
}

/// Returns the number of pixels on each side of a pixel over which a dab smooths.
inline int smoothing_reach(double radius, double pixel_size) {
	return std::max(1, static_cast<int>(0.25 * radius / pixel_size));
}

/// Means of square windows, computed from a summed-area table (Crow, "Summed-area tables for
/// texture mapping", 1984).
class PixelMeans {
public:
	/// Prepares windows of 2 * reach + 1 pixels in width and height, centered on the pixels of
	/// `region`.
	template <typename Reader>
	PixelMeans(Reader reader, const PixelRect &region, int reach) : min_(region.min - reach), reach_(reach) {
		const glm::ivec2 size = region.max - region.min + 2 * reach;
		stride_ = static_cast<std::size_t>(size.x) + 1;
		sums_.resize(stride_ * (static_cast<std::size_t>(size.y) + 1));
		for (int y = 0; y < size.y; ++y) {
			std::uint32_t row = 0;
			for (int x = 0; x < size.x; ++x) {
				row += reader.at(min_.x + x, min_.y + y);
				sums_[index(x + 1, y + 1)] = sums_[index(x + 1, y)] + row;
			}
		}
	}

	/// Returns the mean of the window around a pixel, rounded to a whole number.
	int about(int x, int y) const {
		const int side = 2 * reach_ + 1;
		const int left = x - reach_ - min_.x;
		const int top = y - reach_ - min_.y;
		const std::uint32_t sum = sums_[index(left + side, top + side)] - sums_[index(left, top + side)] -
				sums_[index(left + side, top)] + sums_[index(left, top)];
		const auto pixels = static_cast<std::uint32_t>(side * side);
		return static_cast<int>((sum + pixels / 2) / pixels);
	}

private:
	std::size_t index(int x, int y) const {
		return static_cast<std::size_t>(y) * stride_ + static_cast<std::size_t>(x);
	}

	glm::ivec2 min_;
	int reach_;
	std::size_t stride_ = 0;
	std::vector<std::uint32_t> sums_; ///< May wrap around, but the differences of sums do not.
};

} // namespace thicket
