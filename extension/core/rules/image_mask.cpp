#include "core/rules/image_mask.hpp"

#include "core/base/bilinear.hpp"
#include "core/base/check.hpp"
#include "core/base/floating_point.hpp"
#include "core/base/guard.hpp"
#include "core/rules/planet_positions.hpp"
#include "core/rules/sphere_image.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace thicket {

namespace {

/// Along one axis, the pixels before and after a position, and the position's fraction of the way
/// from the first to the second.
struct Taps {
	std::size_t first;
	std::size_t second;
	double part;
};

/// Returns the pixels around `position`, which is in pixels from the image's edge, 0 to `count`.
Taps taps_at(double position, int count, bool repeat) {
	const double from_center = position - 0.5;
	const double below = std::floor(from_center);
	int first = static_cast<int>(below);
	int second = first + 1;
	if (repeat) {
		first = first < 0 ? first + count : first;
		second = second >= count ? second - count : second;
	} else {
		first = std::max(first, 0);
		second = std::min(second, count - 1);
	}
	return {static_cast<std::size_t>(first), static_cast<std::size_t>(second), from_center - below};
}

} // namespace

Status ImageMask::set(glm::ivec2 size, std::span<const std::uint8_t> pixels, const Rect &area, MaskEdge edge) {
	if (const Status status = first_failure(check_range("size", size.x, 1, max_mask_pixels),
				check_range("size", size.y, 1, max_mask_pixels), check_positive("area", area.size().x),
				check_positive("area", area.size().y),
				check_range("edge", static_cast<double>(edge), 0, static_cast<double>(MaskEdge::repeat)));
			!status.ok()) {
		return status;
	}
	if (pixels.size() != static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y)) {
		return Status::wrong_size("pixels", pixels.size(), exactly(double{1.0} * size.x * size.y));
	}
	return guarded("pixels", static_cast<double>(pixels.size()), [&] {
		pixels_ = std::vector<std::uint8_t>(pixels.begin(), pixels.end());
		size_ = size;
		area_ = area;
		edge_ = edge;
	});
}

Status ImageMask::sample(std::span<const glm::dvec2> positions, std::span<float> r_density) const {
	if (positions.size() != r_density.size()) {
		return Status::wrong_size("density", r_density.size(), exactly(positions.size()));
	}
	for (std::size_t i = 0; i < positions.size(); ++i) {
		r_density[i] = static_cast<float>(at(positions[i]));
	}
	return {};
}

/// Interpolates at a position in the image; `fraction` is 0 to 1 along both axes.
inline double ImageMask::interpolate(glm::dvec2 fraction, bool repeat_x, bool repeat_y) const {
	const Taps taps_x = taps_at(fraction.x * size_.x, size_.x, repeat_x);
	const Taps taps_y = taps_at(fraction.y * size_.y, size_.y, repeat_y);
	const std::uint8_t *near_row = pixels_.data() + taps_y.first * static_cast<std::size_t>(size_.x);
	const std::uint8_t *far_row = pixels_.data() + taps_y.second * static_cast<std::size_t>(size_.x);
	return bilinear(near_row[taps_x.first], near_row[taps_x.second], far_row[taps_x.first], far_row[taps_x.second],
				   taps_x.part, taps_y.part) /
			255.0;
}

double ImageMask::at(glm::dvec2 position) const {
	if (!std::isfinite(position.x) || !std::isfinite(position.y)) {
		return 0.0;
	}
	const bool repeat = edge_ == MaskEdge::repeat;
	if (!repeat) {
		if (edge_ != MaskEdge::clamp && !area_.contains(position)) {
			return edge_ == MaskEdge::everything ? 1.0 : 0.0;
		}
		position = glm::clamp(position, area_.min, area_.max);
	}
	glm::dvec2 part = (position - area_.min) / area_.size();
	if (repeat) {
		if (!std::isfinite(part.x) || !std::isfinite(part.y)) {
			return 0.0; // So far away, doubles cannot resolve the position within the image.
		}
		part -= glm::dvec2(std::floor(part.x), std::floor(part.y));
	}
	return interpolate(part, repeat, repeat);
}

double ImageMask::toward(const glm::dvec3 &from_center) const {
	if (!has_direction(from_center)) {
		return 0.0;
	}
	return interpolate(sphere_image_position(from_center), true, false);
}

bool operator==(const ImageMask &a, const ImageMask &b) {
	return a.size_ == b.size_ && a.pixels_ == b.pixels_ && a.area_.min == b.area_.min && a.area_.max == b.area_.max &&
			a.edge_ == b.edge_;
}

} // namespace thicket
