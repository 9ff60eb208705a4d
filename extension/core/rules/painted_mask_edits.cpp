// This file finds the differences between two states of a painted mask.

#include "core/rules/painted_mask.hpp"
#include "core/rules/planet_cap.hpp"

#include <glm/common.hpp>

#include <limits>

namespace thicket {

namespace {

/// Grows a region until it contains another one.
void add(PixelRect &r_region, const PixelRect &other) {
	if (r_region.empty()) {
		r_region = other;
	} else if (!other.empty()) {
		r_region = {glm::min(r_region.min, other.min), glm::max(r_region.max, other.max)};
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

/// Returns the range of pixels of a block that differ between two masks.
PixelRect PaintedMask::differing_pixels(const Key &key, const Block *mine, const Block *theirs) const {
	Block blank;
	blank.fill(background_);
	const Block &a = mine != nullptr ? *mine : blank;
	const Block &b = theirs != nullptr ? *theirs : blank;
	PixelRect region;
	for (std::size_t i = 0; i < a.size(); ++i) {
		if (a[i] != b[i]) {
			const auto at = static_cast<int>(i);
			const glm::ivec2 pixel{at % block_side, at / block_side};
			add(region, {pixel, pixel + 1});
		}
	}
	const glm::ivec2 corner = block_side * glm::ivec2(key.second, key.first);
	return region.empty() ? region : PixelRect{corner + region.min, corner + region.max};
}

bool PaintedMask::differs(const PaintedMask &other, Rect &r_area) const {
	constexpr double infinity = std::numeric_limits<double>::infinity();
	r_area = {};
	if (pixel_size_ != other.pixel_size_ || background_ != other.background_) {
		r_area = {glm::dvec2(-infinity), glm::dvec2(infinity)};
		return true;
	}
	PixelRect region;
	for_each_unshared_block(other, [&](const Key &key, const Block *mine, const Block *theirs) {
		add(region, differing_pixels(key, mine, theirs));
	});
	if (region.empty()) {
		return false;
	}
	// Between the centers of two pixels, the density depends on both.
	r_area = {pixel_size_ * (glm::dvec2(region.min) - 0.5), pixel_size_ * (glm::dvec2(region.max) + 0.5)};
	return true;
}

bool PaintedMask::find_edits_on(const Planet &planet, const PaintedMask &other, std::vector<Rect> &r_areas) const {
	if (pixel_size_ != other.pixel_size_ || background_ != other.background_) {
		return false;
	}
	const CubeGrid grid(planet.radius, pixel_size_);
	const glm::ivec2 whole(grid.count() + 1);
	std::array<PixelRect, CubeGrid::faces> edited;
	for_each_unshared_block(other, [&](const Key &key, const Block *mine, const Block *theirs) {
		const PixelRect pixels = differing_pixels(key, mine, theirs);
		for (int face = 0; face < CubeGrid::faces && !pixels.empty(); ++face) {
			// Pixels that belong to no face have no effect on a planet.
			const glm::ivec2 corner = grid.corner(face);
			add(edited[static_cast<std::size_t>(face)],
					{glm::max(pixels.min - corner, glm::ivec2(0)), glm::min(pixels.max - corner, whole)});
		}
	});
	for (int face = 0; face < CubeGrid::faces; ++face) {
		if (const PixelRect &nodes = edited[static_cast<std::size_t>(face)]; !nodes.empty()) {
			r_areas.push_back(shadow_of(planet, grid.cap_of(face, nodes)));
		}
	}
	return true;
}

} // namespace thicket
