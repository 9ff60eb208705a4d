#include "core/base/check.hpp"
#include "core/base/floating_point.hpp"
#include "core/base/guard.hpp"
#include "core/rules/painted_mask.hpp"
#include "core/rules/painted_mask_brush.hpp"
#include "core/rules/painted_mask_edit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thicket {

namespace {

/// Returns an error if a dab's bounding square, extended by one pixel on each side, exceeds
/// pixel_limit along an axis.
Status check_reach(double center, double radius, double pixel_size) {
	constexpr double limit = PaintedMask::pixel_limit;
	const bool inside = (center - radius) / pixel_size - 1.0 >= -limit && (center + radius) / pixel_size + 1.0 <= limit;
	return inside ? Status{}
				  : Status::out_of_range("center", center,
							between(-limit * pixel_size, limit * pixel_size, "the dab must not exceed this range"));
}

} // namespace

Status PaintedMask::check_brush(const Brush &brush) const {
	constexpr double lowest = std::numeric_limits<double>::lowest();
	constexpr double highest = std::numeric_limits<double>::max();
	return first_failure(
			check_range("mode", static_cast<double>(brush.mode), 0, static_cast<double>(Brush::Mode::smooth)),
			check_range("center", brush.center.x, lowest, highest),
			check_range("center", brush.center.y, lowest, highest), check_positive("radius", brush.radius),
			check_range("radius", brush.radius, 0.0, max_brush_pixels * pixel_size_),
			check_range("strength", brush.strength, 0.0, 1.0), check_range("hardness", brush.hardness, 0.0, 1.0));
}

Status PaintedMask::paint(const Brush &brush, Rect &r_changed) {
	if (const Status status = first_failure(check_brush(brush), check_reach(brush.center.x, brush.radius, pixel_size_),
				check_reach(brush.center.y, brush.radius, pixel_size_));
			!status.ok()) {
		return status;
	}
	const PixelRect region = pixels_of({brush.center - brush.radius, brush.center + brush.radius});
	const auto weight = [&](int x, int y) {
		const glm::dvec2 offset = (glm::dvec2(x, y) + 0.5) * pixel_size_ - brush.center;
		return brush_weight(brush, std::sqrt(offset.x * offset.x + offset.y * offset.y));
	};
	return guarded("radius", brush.radius, [&] {
		Edit edit(*this);
		if (brush.mode == Brush::Mode::smooth) {
			const int reach = smoothing_reach(brush.radius, pixel_size_);
			const PixelMeans means(Reader(*this), region, reach);
			edit.apply(region, [&](int x, int y, std::uint8_t value) {
				return moved_toward(value, means.about(x, y), weight(x, y));
			});
		} else {
			const int target = brush.mode == Brush::Mode::paint ? 255 : 0;
			edit.apply(region,
					[&](int x, int y, std::uint8_t value) { return moved_toward(value, target, weight(x, y)); });
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
