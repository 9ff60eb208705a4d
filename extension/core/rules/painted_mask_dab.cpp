#include "core/base/check.hpp"
#include "core/base/floating_point.hpp"
#include "core/base/guard.hpp"
#include "core/rules/painted_mask.hpp"
#include "core/rules/painted_mask_edit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thicket {

namespace {

Status check_brush(const Brush &brush, double pixel_size) {
	constexpr double lowest = std::numeric_limits<double>::lowest();
	constexpr double highest = std::numeric_limits<double>::max();
	return first_failure(
			check_range("mode", static_cast<double>(brush.mode), 0, static_cast<double>(Brush::Mode::smooth)),
			check_range("center", brush.center.x, lowest, highest),
			check_range("center", brush.center.y, lowest, highest), check_positive("radius", brush.radius),
			check_range("radius", brush.radius, 0.0, max_brush_pixels * pixel_size),
			check_range("strength", brush.strength, 0.0, 1.0), check_range("hardness", brush.hardness, 0.0, 1.0));
}

/// Returns an error if a dab's bounding square, extended by one pixel on each side, exceeds
/// pixel_limit along an axis.
Status check_reach(double center, double radius, double pixel_size) {
	constexpr double limit = PaintedMask::pixel_limit;
	const bool inside = (center - radius) / pixel_size - 1.0 >= -limit && (center + radius) / pixel_size + 1.0 <= limit;
	return inside ? Status{}
				  : Status::out_of_range(
							"center", center, between(-limit * pixel_size, limit * pixel_size, "less the radius"));
}

/// Returns the fraction of the way to its target by which a dab changes a pixel, 0 to 1.
double weight_at(const Brush &brush, glm::dvec2 pixel_center) {
	const glm::dvec2 offset = pixel_center - brush.center;
	const double distance = std::sqrt(offset.x * offset.x + offset.y * offset.y);
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

std::uint8_t moved(std::uint8_t value, int target, double weight) {
	const int way = target - value;
	const bool at_least_one = way != 0 && weight >= 0.5 / 255.0;
	const int steps = static_cast<int>(std::floor(std::abs(way) * weight + 0.5));
	const int taken = std::max(steps, at_least_one ? 1 : 0);
	return static_cast<std::uint8_t>(way < 0 ? value - taken : value + taken);
}

/// Means of square windows, computed from a summed-area table (Crow, "Summed-area tables for
/// texture mapping", 1984).
class Means {
public:
	/// Prepares windows of 2 * reach + 1 pixels in width and height, centered on the pixels of
	/// `region`.
	template <typename Reader>
	Means(Reader reader, const PixelRect &region, int reach) : min_(region.min - reach), reach_(reach) {
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
	std::vector<std::uint32_t> sums_; ///< At most (2.5 max_brush_pixels + 3)^2 pixels, so no sum overflows.
};

} // namespace

Status PaintedMask::paint(const Brush &brush, Rect &r_changed) {
	if (const Status status = first_failure(check_brush(brush, pixel_size_),
				check_reach(brush.center.x, brush.radius, pixel_size_),
				check_reach(brush.center.y, brush.radius, pixel_size_));
			!status.ok()) {
		return status;
	}
	const PixelRect region = pixels_of({brush.center - brush.radius, brush.center + brush.radius});
	const auto weight = [&](int x, int y) {
		return weight_at(brush, (glm::dvec2(x, y) + 0.5) * pixel_size_);
	};
	return guarded("radius", brush.radius, [&] {
		Edit edit(*this);
		if (brush.mode == Brush::Mode::smooth) {
			const int reach = std::max(1, static_cast<int>(0.25 * brush.radius / pixel_size_));
			const Means means(Reader(*this), region, reach);
			edit.apply(region,
					[&](int x, int y, std::uint8_t value) { return moved(value, means.about(x, y), weight(x, y)); });
		} else {
			const int target = brush.mode == Brush::Mode::paint ? 255 : 0;
			edit.apply(region, [&](int x, int y, std::uint8_t value) { return moved(value, target, weight(x, y)); });
		}
		r_changed = edit.changed_area();
	});
}

Rect PaintedMask::Edit::changed_area() const {
	if (changed_.empty()) {
		return {};
	}
	// A pixel affects positions up to the centers of its neighbors, where its bilinear weight is 0.
	// Rounding the start is harmless, because every position before it is also outside in exact
	// arithmetic. The end is moved up by one ulp if a position there would round back into a
	// changed pixel's reach.
	const double size = mask_.pixel_size_;
	const auto end = [size](int pixel) {
		const double edge = pixel + 0.5;
		const double meters = edge * size;
		return meters / size >= edge ? meters : std::nextafter(meters, std::numeric_limits<double>::infinity());
	};
	return {(glm::dvec2(changed_.min) - 0.5) * size, {end(changed_.max.x), end(changed_.max.y)}};
}

} // namespace thicket
