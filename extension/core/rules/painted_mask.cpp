#include "core/rules/painted_mask.hpp"

#include "core/base/bilinear.hpp"
#include "core/base/check.hpp"
#include "core/base/floating_point.hpp"
#include "core/base/guard.hpp"
#include "core/rules/painted_mask_edit.hpp"

#include <algorithm>
#include <cmath>

namespace thicket {

namespace {

/// Converts a coordinate in meters to pixels from the center of pixel 0. The conversion is
/// monotonic.
double pixel_position(double meters, double pixel_size) { return meters / pixel_size - 0.5; }

/// Returns the lower of the two pixels around a coordinate, clamped so that both are within
/// pixel_limit.
int first_pixel(double meters, double pixel_size) {
	const double pixel = std::floor(pixel_position(meters, pixel_size));
	return static_cast<int>(std::clamp<double>(pixel, -PaintedMask::pixel_limit, PaintedMask::pixel_limit - 2));
}

Status check_region(const PixelRect &region) {
	const auto check_corner = [](int pixel) {
		return check_range("region", pixel, -PaintedMask::pixel_limit, PaintedMask::pixel_limit);
	};
	if (const Status status = first_failure(check_corner(region.min.x), check_corner(region.min.y),
				check_corner(region.max.x), check_corner(region.max.y),
				check_order("region", region.min.x, region.max.x), check_order("region", region.min.y, region.max.y));
			!status.ok()) {
		return status;
	}
	const glm::dvec2 size = glm::dvec2(region.max) - glm::dvec2(region.min);
	return check_range("region", size.x * size.y, 0.0, PaintedMask::max_region_pixels);
}

} // namespace

Status PaintedMask::reset(double pixel_size, double background) {
	if (const Status status = first_failure(check_range("pixel_size", pixel_size, min_pixel_size, max_pixel_size),
				check_range("background", background, 0.0, 1.0));
			!status.ok()) {
		return status;
	}
	pixel_size_ = pixel_size;
	background_ = static_cast<std::uint8_t>(std::floor(background * 255.0 + 0.5));
	blocks_.clear();
	return {};
}

double PaintedMask::background() const { return background_ / 255.0; }

Status PaintedMask::sample(std::span<const glm::dvec2> positions, std::span<float> r_density) const {
	if (positions.size() != r_density.size()) {
		return Status::wrong_size("density", r_density.size(), exactly(positions.size()));
	}
	const auto within_limit = [](double below) {
		return below >= -pixel_limit && below <= pixel_limit - 2;
	};
	Reader reader(*this);
	for (std::size_t i = 0; i < positions.size(); ++i) {
		const glm::dvec2 position(
				pixel_position(positions[i].x, pixel_size_), pixel_position(positions[i].y, pixel_size_));
		const glm::dvec2 below(std::floor(position.x), std::floor(position.y));
		double value = background_;
		if (within_limit(below.x) && within_limit(below.y)) {
			const int x = static_cast<int>(below.x);
			const int y = static_cast<int>(below.y);
			value = bilinear(reader.at(x, y), reader.at(x + 1, y), reader.at(x, y + 1), reader.at(x + 1, y + 1),
					position.x - below.x, position.y - below.y);
		} else if (!std::isfinite(positions[i].x) || !std::isfinite(positions[i].y)) {
			value = 0.0;
		}
		r_density[i] = static_cast<float>(value / 255.0);
	}
	return {};
}

Status PaintedMask::read(const PixelRect &region, std::vector<std::uint8_t> &r_pixels) const {
	if (const Status status = check_region(region); !status.ok()) {
		return status;
	}
	const auto count = static_cast<double>(pixel_count(region));
	if (const Status status = guarded("region", count, [&] { r_pixels.resize(pixel_count(region)); }); !status.ok()) {
		return status;
	}
	Reader reader(*this);
	auto pixel = r_pixels.begin();
	for (int y = region.min.y; y < region.max.y; ++y) {
		for (int x = region.min.x; x < region.max.x; ++x) {
			*pixel++ = reader.at(x, y);
		}
	}
	return {};
}

Status PaintedMask::write(const PixelRect &region, std::span<const std::uint8_t> pixels, Rect &r_changed) {
	if (const Status status = check_region(region); !status.ok()) {
		return status;
	}
	if (pixels.size() != pixel_count(region)) {
		return Status::wrong_size("pixels", pixels.size(), exactly(pixel_count(region)));
	}
	const std::size_t columns = pixel_columns(region);
	return guarded("region", static_cast<double>(pixels.size()), [&] {
		Edit edit(*this);
		edit.apply(region, [&](int x, int y, std::uint8_t) {
			return pixels[static_cast<std::size_t>(y - region.min.y) * columns +
					static_cast<std::size_t>(x - region.min.x)];
		});
		r_changed = edit.changed_area();
	});
}

PixelRect PaintedMask::pixels_of(const Rect &area) const {
	if (area.empty()) {
		return {};
	}
	return {{first_pixel(area.min.x, pixel_size_), first_pixel(area.min.y, pixel_size_)},
			{first_pixel(area.max.x, pixel_size_) + 2, first_pixel(area.max.y, pixel_size_) + 2}};
}

bool operator==(const PaintedMask &a, const PaintedMask &b) {
	const auto same = [](const auto &one, const auto &other) {
		if (one.second == other.second) {
			// A block that both masks share has the same pixels.
			return one.first == other.first;
		}
		return one.first == other.first && *one.second == *other.second;
	};
	return a.pixel_size_ == b.pixel_size_ && a.background_ == b.background_ &&
			std::ranges::equal(a.blocks_, b.blocks_, same);
}

const PaintedMask::Block *PaintedMask::find(Key key) const {
	const auto found = blocks_.find(key);
	return found == blocks_.end() ? nullptr : found->second.get();
}

void PaintedMask::replace(Blocks &&blocks) noexcept {
	while (!blocks.empty()) {
		auto node = blocks.extract(blocks.begin());
		if (!node.mapped()) {
			blocks_.erase(node.key());
		} else if (const auto entry = blocks_.find(node.key()); entry != blocks_.end()) {
			entry->second = std::move(node.mapped());
		} else {
			blocks_.insert(std::move(node));
		}
	}
}

} // namespace thicket
