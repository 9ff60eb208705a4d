// How two states of a painted mask are told apart.

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
	const auto compare = [&region](const Key &key, const Block &a, const Block &b) {
		for (std::size_t i = 0; i < a.size(); ++i) {
			if (a[i] != b[i]) {
				const auto at = static_cast<int>(i);
				const glm::ivec2 pixel{at % block_side, at / block_side};
				add_pixel(region, block_side * glm::ivec2(key.second, key.first) + pixel);
			}
		}
	};
	for (const auto &[key, block] : blocks_) {
		const auto twin = other.blocks_.find(key);
		if (twin == other.blocks_.end() || twin->second != block) {
			compare(key, *block, twin == other.blocks_.end() ? blank : *twin->second);
		}
	}
	for (const auto &[key, block] : other.blocks_) {
		if (!blocks_.contains(key)) {
			compare(key, *block, blank);
		}
	}
	if (region.empty()) {
		return false;
	}
	// Between the centers of two pixels the density depends on both.
	r_area = {pixel_size_ * (glm::dvec2(region.min) - 0.5), pixel_size_ * (glm::dvec2(region.max) + 0.5)};
	return true;
}

} // namespace thicket
