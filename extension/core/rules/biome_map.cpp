#include "core/rules/biome_map.hpp"

#include "core/base/check.hpp"
#include "core/base/floating_point.hpp"
#include "core/base/guard.hpp"
#include "core/base/split_mix.hpp"
#include "core/rules/biome_pixels.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace thicket {

namespace {

/// The coordinate, in meters, up to which clamped border pixels extend. No world is that large.
constexpr double beyond = 1e12;

int blocks_for(int pixels) { return (pixels + biome_block - 1) / biome_block; }

} // namespace

Status validate(const BiomeBorders &borders) {
	return first_failure(check_range("border_width", borders.width, 0.0, max_border_width),
			check_range("border_noise", borders.noise, 0.0, max_border_noise),
			check_range("border_noise_size", borders.noise_size, min_border_noise_size, max_border_noise_size));
}

Status BiomeMap::set(glm::ivec2 size, std::span<const std::uint8_t> pixels, const Rect &area, BiomeEdge edge,
		const BiomeBorders &borders) {
	if (const Status status = first_failure(check_range("size", size.x, 1, max_biome_map_pixels),
				check_range("size", size.y, 1, max_biome_map_pixels), check_positive("rect", area.size().x),
				check_positive("rect", area.size().y),
				check_range("edge", static_cast<double>(edge), 0, static_cast<double>(BiomeEdge::clamp)),
				validate(borders));
			!status.ok()) {
		return status;
	}
	if (pixels.size() != static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y)) {
		return Status::wrong_size("pixels", pixels.size(), exactly(double{1.0} * size.x * size.y));
	}
	const auto bad =
			std::ranges::find_if(pixels, [](std::uint8_t index) { return index >= max_biomes && index != no_biome; });
	if (bad != pixels.end()) {
		return Status::out_of_range("pixels", *bad, at_most(max_biomes - 1, "the last biome"));
	}
	return guarded("pixels", static_cast<double>(pixels.size()), [&] {
		BiomeMap next;
		next.pixels_.assign(pixels.begin(), pixels.end());
		next.size_ = size;
		next.area_ = area;
		next.edge_ = edge;
		next.borders_ = borders;
		// The reach includes a small margin for rounding.
		next.reach_ = 1.001 * (borders.noise + 0.5 * borders.width) + 1e-6;
		next.find_blocks();
		constexpr double small_part = 0.25;
		for (std::size_t i = 0; i < next.noise_.size(); ++i) {
			const double noise_size = i % 2 == 0 ? borders.noise_size : small_part * borders.noise_size;
			// At these settings, the noise is uniform over [0, 1].
			next.noise_[i].set({.size = noise_size, .coverage = 0.5, .softness = 1.0},
					split_mix(split_mix(borders.seed) + i * split_mix_gamma));
		}
		*this = std::move(next);
	});
}

glm::ivec2 BiomeMap::block_count() const { return {blocks_for(size_.x), blocks_for(size_.y)}; }

void BiomeMap::find_blocks() {
	const glm::ivec2 count = block_count();
	blocks_.assign(static_cast<std::size_t>(count.x) * static_cast<std::size_t>(count.y), 0);
	for (int y = 0; y < size_.y; ++y) {
		BiomeSet *row = blocks_.data() + static_cast<std::size_t>(y / biome_block) * static_cast<std::size_t>(count.x);
		for (int x = 0; x < size_.x; ++x) {
			row[x / biome_block] |= biome_bit(pixel(x, y));
		}
	}
}

BiomeSet BiomeMap::biomes_in(const Rect &rect) const {
	const glm::dvec2 pixels_per_meter = glm::dvec2(size_) / area_.size();
	const bool is_whole_map = !rect.finite() || rect.max.x < rect.min.x || rect.max.y < rect.min.y;
	const Rect queried_area = is_whole_map ? expanded(area_, 1.0) : rect;
	const glm::dvec2 from = (queried_area.min - reach_ - area_.min) * pixels_per_meter;
	const glm::dvec2 to = (queried_area.max + reach_ - area_.min) * pixels_per_meter;
	const bool is_outside = from.x < 0.0 || from.y < 0.0 || to.x >= size_.x || to.y >= size_.y;
	const BiomeSet result = is_outside && edge_ == BiomeEdge::nothing ? biome_bit(no_biome) : 0;
	const bool none_inside = to.x < 0.0 || to.y < 0.0 || from.x > size_.x || from.y > size_.y;
	if (none_inside && edge_ == BiomeEdge::nothing) {
		return result;
	}
	return result |
			biomes_in_blocks({{held_index(from.x, size_.x), held_index(from.y, size_.y)},
					{held_index(to.x, size_.x) + 1, held_index(to.y, size_.y) + 1}});
}

/// Returns the biomes in all blocks that contain any of these pixels.
BiomeSet BiomeMap::biomes_in_blocks(const Pixels &pixels) const {
	const glm::ivec2 last = (pixels.max - 1) / biome_block;
	BiomeSet result = 0;
	for (int y = pixels.min.y / biome_block; y <= last.y; ++y) {
		const BiomeSet *row = blocks_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(block_count().x);
		for (int x = pixels.min.x / biome_block; x <= last.x; ++x) {
			result |= row[x];
		}
	}
	return result;
}

std::uint8_t BiomeMap::pixel_at(glm::dvec2 position) const {
	const glm::dvec2 at = (position - area_.min) * (glm::dvec2(size_) / area_.size());
	const bool inside = at.x >= 0.0 && at.y >= 0.0 && at.x < size_.x && at.y < size_.y;
	if (!inside && edge_ == BiomeEdge::nothing) {
		return no_biome;
	}
	return pixel(held_index(at.x, size_.x), held_index(at.y, size_.y));
}

void BiomeMap::taps_at(glm::dvec2 position, BiomeTaps &r_taps) const {
	if (!std::isfinite(position.x) || !std::isfinite(position.y)) {
		r_taps.fill(no_biome);
		return;
	}
	if (const BiomeSet nearby_biomes = biomes_in({position, position}); std::has_single_bit(nearby_biomes)) {
		// Away from borders, there is only one candidate, so no noise is evaluated.
		r_taps.fill(static_cast<std::uint8_t>(std::countr_zero(nearby_biomes)));
		return;
	}
	glm::dvec2 bent_position = position;
	if (borders_.noise > 0.0) {
		bent_position += borders_.noise * glm::dvec2(border_offset(position, 0), border_offset(position, 1));
	}
	if (borders_.width <= 0.0) {
		// All taps have the same position.
		r_taps.fill(pixel_at(bent_position));
		return;
	}
	for (std::size_t tap = 0; tap < biome_taps; ++tap) {
		r_taps[tap] = pixel_at(bent_position + borders_.width * biome_tap_offsets[tap]);
	}
}

std::uint8_t dominant_of(const BiomeTaps &taps) {
	PerBiome<std::uint8_t> counts{};
	for (const std::uint8_t biome : taps) {
		++counts[biome];
	}
	return static_cast<std::uint8_t>(std::ranges::max_element(counts) - counts.begin());
}

std::uint8_t BiomeMap::dominant_at(glm::dvec2 position) const {
	BiomeTaps taps{};
	taps_at(position, taps);
	return dominant_of(taps);
}

bool BiomeMap::same_frame(const BiomeMap &other) const {
	return size_ == other.size_ && area_.min == other.area_.min && area_.max == other.area_.max &&
			edge_ == other.edge_ && borders_ == other.borders_;
}

bool operator==(const BiomeMap &a, const BiomeMap &b) { return a.same_frame(b) && a.pixels_ == b.pixels_; }

/// Returns true if the value may differ in any pixel of a block.
bool BiomeMap::block_differs(const BiomeMap &before, const SameValue &same, glm::ivec2 at) const {
	const std::size_t index =
			static_cast<std::size_t>(at.y) * static_cast<std::size_t>(block_count().x) + static_cast<std::size_t>(at.x);
	const BiomeSet current = blocks_[index];
	bool differs = false;
	for (BiomeSet remaining = before.blocks_[index]; remaining != 0; remaining &= remaining - 1) {
		differs = differs || (current & ~same[static_cast<std::size_t>(std::countr_zero(remaining))]) != 0;
	}
	return differs;
}

/// Returns the smallest rectangle around the pixels of `among` whose value differs.
BiomeMap::Pixels BiomeMap::edited_pixels(
		const BiomeMap &before, const SameValue &same, const Pixels &search_area) const {
	Pixels found{size_, {0, 0}};
	for (int y = search_area.min.y; y < search_area.max.y; ++y) {
		for (int x = search_area.min.x; x < search_area.max.x; ++x) {
			if ((same[before.pixel(x, y)] & biome_bit(pixel(x, y))) == 0) {
				found.min = glm::min(found.min, glm::ivec2(x, y));
				found.max = glm::max(found.max, glm::ivec2(x + 1, y + 1));
			}
		}
	}
	return found;
}

/// Returns the world rectangle that contains every position affected by these pixels.
Rect BiomeMap::reached_from(const Pixels &pixels) const {
	const glm::dvec2 meters = area_.size() / glm::dvec2(size_);
	Rect rect{
			area_.min + glm::dvec2(pixels.min) * meters - reach_, area_.min + glm::dvec2(pixels.max) * meters + reach_};
	for (int axis = 0; edge_ == BiomeEdge::clamp && axis < 2; ++axis) {
		rect.min[axis] = pixels.min[axis] == 0 ? -beyond : rect.min[axis];
		rect.max[axis] = pixels.max[axis] == size_[axis] ? beyond : rect.max[axis];
	}
	return rect;
}

bool BiomeMap::find_edits(
		const BiomeMap &before, const SameValue &same, std::vector<Rect> &r_areas, const Planet &planet) const {
	if (!same_frame(before)) {
		return false;
	}
	const glm::ivec2 count = block_count();
	const glm::ivec2 part = (count + find_grid - 1) / find_grid; // Size of a part, in blocks.
	for (int part_y = 0; part_y < count.y; part_y += part.y) {
		for (int part_x = 0; part_x < count.x; part_x += part.x) {
			Pixels found{size_, {0, 0}};
			for (int y = part_y; y < std::min(part_y + part.y, count.y); ++y) {
				for (int x = part_x; x < std::min(part_x + part.x, count.x); ++x) {
					if (!block_differs(before, same, {x, y})) {
						// The biome changed here, but the value stayed the same.
						continue;
					}
					const glm::ivec2 first(x * biome_block, y * biome_block);
					const Pixels more = edited_pixels(before, same, {first, glm::min(first + biome_block, size_)});
					found.min = glm::min(found.min, more.min);
					found.max = glm::max(found.max, more.max);
				}
			}
			if (found.min.x < found.max.x) {
				r_areas.push_back(planet.exists() ? shadow_of(planet, cap_reached_from(planet.radius, found))
												  : reached_from(found));
			}
		}
	}
	return true;
}

} // namespace thicket
