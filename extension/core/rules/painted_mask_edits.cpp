// This file finds the differences between two states of a painted mask.

#include "core/rules/painted_mask.hpp"

#include <glm/common.hpp>

#include <limits>

namespace thicket {

namespace {

void add_pixel(PixelRect &r_region, glm::ivec2 pixel) {
	if (r_region.empty()) {
		r_region = {pixel, pixel + 1};
	} else {
		r_region = {glm::min(r_region.min, pixel), glm::max(r_region.max, pixel + 1)};
	}
}

} // namespace

template <typename Visit>
void PaintedMask::for_each_unshared_block(const PaintedMask &other, const Visit &visit) const {
	for (const auto &[key, block] : blocks_) {
		const auto twin = other.blocks_.find(key);
		const Block *theirs = twin != other.blocks_.end() ? twin->second.get() : nullptr;
		if (theirs == block.get()) {
			// Both masks share this block, so it has no differences.
			continue;
		}
		visit(key, block.get(), theirs);
	}
	for (const auto &[key, block] : other.blocks_) {
		if (!blocks_.contains(key)) {
			visit(key, static_cast<const Block *>(nullptr), block.get());
		}
	}
}

std::size_t PaintedMask::count_unshared_blocks(const PaintedMask &other) const {
	std::size_t count = 0;
	for_each_unshared_block(other, [&count](const Key &, const Block *, const Block *) { ++count; });
	return count;
}

bool PaintedMask::differs(const PaintedMask &other, Rect &r_area) const {
	constexpr double infinity = std::numeric_limits<double>::infinity();
	r_area = {};
	if (pixel_size_ != other.pixel_size_ || background_ != other.background_) {
		r_area = {glm::dvec2(-infinity), glm::dvec2(infinity)};
		return true;
	}
	Block blank;
	blank.fill(background_);
	PixelRect region;
	for_each_unshared_block(other, [&](const Key &key, const Block *mine, const Block *theirs) {
		const Block &a = mine != nullptr ? *mine : blank;
		const Block &b = theirs != nullptr ? *theirs : blank;
		for (std::size_t i = 0; i < a.size(); ++i) {
			if (a[i] != b[i]) {
				const auto at = static_cast<int>(i);
				const glm::ivec2 pixel{at % block_side, at / block_side};
				add_pixel(region, block_side * glm::ivec2(key.second, key.first) + pixel);
			}
		}
	});
	if (region.empty()) {
		return false;
	}
	// Between the centers of two pixels, the density depends on both.
	r_area = {pixel_size_ * (glm::dvec2(region.min) - 0.5), pixel_size_ * (glm::dvec2(region.max) + 0.5)};
	return true;
}

} // namespace thicket
