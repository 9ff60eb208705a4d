#include "core/terrain/region_field.hpp"

#include "core/base/bilinear.hpp"
#include "core/base/check.hpp"
#include "core/base/floating_point.hpp"
#include "core/base/guard.hpp"
#include "core/terrain/grid_surface.hpp"
#include "core/terrain/post_format.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

namespace thicket {

namespace {

/// Maximum absolute index of a height sample.
constexpr double max_post = static_cast<double>(RegionField::max_location) * PixelGrid::max_side;

// Bits of a control value.
constexpr std::uint32_t auto_bit = 1u << 0u;
constexpr std::uint32_t hole_bit = 1u << 2u;
constexpr unsigned blend_shift = 14;
constexpr unsigned overlay_shift = 22;
constexpr unsigned base_shift = 27;

int divided_down(int value, int by) { return value >= 0 ? value / by : -1 - (-1 - value) / by; }

std::uint32_t word_at(const PixelGrid &controls, glm::ivec2 post) {
	std::uint32_t word = 0;
	std::memcpy(&word, controls.pixel(post.x, post.y), sizeof(word));
	return word;
}

double height_at(const PixelGrid &heights, glm::ivec2 post) {
	return post_height(heights.pixel(post.x, post.y), PostFormat::float32);
}

Status check(const FieldRegion &region, int side) {
	const auto fits = [side](const PixelGrid &map) {
		return map.size() == glm::ivec2(side);
	};
	if (!fits(region.heights)) {
		return Status::wrong_size(
				"height map of a region", region.heights.size().x, exactly(side, "pixels on each side"));
	}
	if (!region.controls.empty() && !fits(region.controls)) {
		return Status::wrong_size(
				"control map of a region", region.controls.size().x, exactly(side, "pixels on each side"));
	}
	const int limit = RegionField::max_location;
	return first_failure(check_range("location of a region", region.location.x, -limit, limit - 1),
			check_range("location of a region", region.location.y, -limit, limit - 1));
}

/// Returns the height difference from a height sample to the next. If there is no next sample,
/// returns `difference_in_patch`, the difference within the patch.
double rise(double post, double next, double difference_in_patch) {
	const double difference = next - post;
	return std::isfinite(difference) ? difference : difference_in_patch;
}

} // namespace

Status RegionField::set(int side, double spacing, std::vector<FieldRegion> regions, const AutoPaint &paint) {
	Status status = first_failure(check_range("region_size", side, 2, PixelGrid::max_side),
			check_range("vertex_spacing", spacing, min_spacing, max_spacing));
	for (std::size_t i = 0; i < regions.size() && status.ok(); ++i) {
		status = check(regions[i], side);
	}
	if (!status.ok()) {
		return status;
	}
	return guarded("regions", static_cast<double>(regions.size()), [&]() -> Status {
		auto layout = std::make_shared<Layout>();
		if (!regions.empty()) {
			layout->first = regions.front().location;
			glm::ivec2 last = layout->first;
			for (const FieldRegion &region : regions) {
				layout->first = glm::min(layout->first, region.location);
				last = glm::max(last, region.location);
			}
			layout->size = last - layout->first + 1;
		}
		const std::size_t cells = static_cast<std::size_t>(layout->size.x) * static_cast<std::size_t>(layout->size.y);
		if (cells > max_table) {
			return Status::out_of_range(
					"locations of regions", cells, at_most(max_table, "cells in the rectangle around all"));
		}
		layout->table.assign(cells, -1);
		for (std::size_t i = 0; i < regions.size(); ++i) {
			const glm::ivec2 cell = regions[i].location - layout->first;
			std::int32_t &entry =
					layout->table[static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(layout->size.x) +
							static_cast<std::size_t>(cell.x)];
			if (entry >= 0) {
				return {ErrorCode::out_of_range, "location of a region", static_cast<double>(regions[i].location.x), {},
						{}, "Remove the second region at this location"};
			}
			entry = static_cast<std::int32_t>(i);
		}
		layout->regions = std::move(regions);
		RegionField next(*this);
		next.side_ = side;
		next.spacing_ = spacing;
		next.paint_ = paint;
		next.layout_ = std::move(layout);
		next.make_surface();
		*this = std::move(next);
		return {};
	});
}

RegionField RegionField::at_offset(glm::dvec3 offset) const {
	RegionField field = *this;
	field.offset_ = offset;
	field.make_surface();
	return field;
}

/// The patches that begin in a region.
struct RegionField::Grid {
	std::shared_ptr<const RegionField> field;
	glm::ivec2 first; ///< The index of the region's first height sample.
	static constexpr bool mirrored = false;

	glm::ivec2 patches() const { return glm::ivec2(field->side_); }
	glm::dvec2 post_position(glm::ivec2 post) const {
		return glm::dvec2(field->offset_.x, field->offset_.z) + glm::dvec2(first + post) * field->spacing_;
	}
	PostRange range(const Box3 &box) const {
		const auto to_posts = [this](const glm::dvec3 &corner) {
			return (glm::dvec2(corner.x, corner.z) - post_position(glm::ivec2(0))) / field->spacing_;
		};
		return {to_posts(box.min), to_posts(box.max)};
	}
	bool heights(glm::ivec2 patch, std::array<double, 4> &r_heights) const {
		return field->heights_of(first + patch, r_heights);
	}
};

void RegionField::make_surface() {
	surface_ = nullptr;
	const std::size_t triangles_per_region = 2 * static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_);
	if (regions().empty() || regions().size() > Surface::max_triangles / triangles_per_region) {
		return;
	}
	const auto field = std::make_shared<const RegionField>(*this);
	std::vector<Surface::Part> parts;
	for (const FieldRegion &region : regions()) {
		parts.push_back(std::make_shared<const GridSurface<Grid>>(Grid{field, region.location * side_}));
	}
	surface_ = Surface::of_parts(parts);
}

const FieldRegion *RegionField::region_at(glm::ivec2 location) const {
	if (layout_ == nullptr) {
		return nullptr;
	}
	const glm::ivec2 cell = location - layout_->first;
	if (cell.x < 0 || cell.y < 0 || cell.x >= layout_->size.x || cell.y >= layout_->size.y) {
		return nullptr;
	}
	const std::int32_t index =
			layout_->table[static_cast<std::size_t>(cell.y) * static_cast<std::size_t>(layout_->size.x) +
					static_cast<std::size_t>(cell.x)];
	return index >= 0 ? &layout_->regions[static_cast<std::size_t>(index)] : nullptr;
}

bool RegionField::find_post_position(glm::dvec2 position, PostPosition &r_post_position) const {
	const glm::dvec2 posts = (position - glm::dvec2(offset_.x, offset_.z)) / spacing_;
	if (!(std::abs(posts.x) < max_post && std::abs(posts.y) < max_post)) {
		return false; // Also returned for NAN, because the comparison is then false.
	}
	const glm::dvec2 before = glm::floor(posts);
	r_post_position = {glm::ivec2(before), posts - before};
	return true;
}

RegionField::Post RegionField::post_at(glm::ivec2 post) const {
	const glm::ivec2 location{divided_down(post.x, side_), divided_down(post.y, side_)};
	const FieldRegion *region = region_at(location);
	if (region == nullptr) {
		return {std::numeric_limits<double>::quiet_NaN(), false};
	}
	const glm::ivec2 post_in_region = post - location * side_;
	return {height_at(region->heights, post_in_region),
			!region->controls.empty() && (word_at(region->controls, post_in_region) & hole_bit) != 0};
}

/// Reads the world heights of a patch's samples, row by row. Returns false if it has no ground.
bool RegionField::heights_of(glm::ivec2 first, std::array<double, 4> &r_heights) const {
	bool has_ground = true;
	for (int i = 0; i < 4 && has_ground; ++i) {
		const Post post = post_at(first + glm::ivec2(i % 2, i / 2));
		r_heights[static_cast<std::size_t>(i)] = post.height + offset_.y;
		has_ground = std::isfinite(post.height) && !post.hole;
	}
	return has_ground;
}

std::uint32_t RegionField::control_at(glm::ivec2 post) const {
	const glm::ivec2 location{divided_down(post.x, side_), divided_down(post.y, side_)};
	const FieldRegion *region = region_at(location);
	return region == nullptr || region->controls.empty() ? 0 : word_at(region->controls, post - location * side_);
}

Ground RegionField::ground_at(glm::dvec2 position) const {
	PostPosition post_position{};
	if (!find_post_position(position, post_position)) {
		return {};
	}
	const glm::ivec2 first = post_position.post;
	// The four height samples of the patch and the samples after them: 3 x 3 samples, without the
	// last.
	constexpr std::array<glm::ivec2, 8> steps{{{0, 0}, {1, 0}, {2, 0}, {0, 1}, {1, 1}, {2, 1}, {0, 2}, {1, 2}}};
	std::array<Post, 8> posts{};
	const glm::ivec2 location{divided_down(first.x, side_), divided_down(first.y, side_)};
	const FieldRegion *region = region_at(location);
	if (region == nullptr) {
		return {};
	}
	const glm::ivec2 post_in_region = first - location * side_;
	const bool is_single_region = post_in_region.x + 2 < side_ && post_in_region.y + 2 < side_;
	for (std::size_t i = 0; i < posts.size(); ++i) {
		if (is_single_region) {
			// Most patches and their surroundings lie in a single region, which is looked up only
			// once.
			const glm::ivec2 post = post_in_region + steps[i];
			posts[i] = {height_at(region->heights, post),
					!region->controls.empty() && (word_at(region->controls, post) & hole_bit) != 0};
		} else {
			posts[i] = post_at(first + steps[i]);
		}
	}
	const auto &[p00, p10, p20, p01, p11, p21, p02, p12] = posts;
	const auto [x, z] = std::pair{post_position.part.x, post_position.part.y};
	const double height = bilinear(p00.height, p10.height, p01.height, p11.height, x, z);
	if (!std::isfinite(height) || p00.hole || p10.hole || p01.hole || p11.hole) {
		return {};
	}
	const double near = p10.height - p00.height;
	const double far = p11.height - p01.height;
	const double left = p01.height - p00.height;
	const double right = p11.height - p10.height;
	const double rise_x =
			bilinear(near, rise(p10.height, p20.height, near), far, rise(p11.height, p21.height, far), x, z);
	const double rise_z =
			bilinear(left, right, rise(p01.height, p02.height, left), rise(p11.height, p12.height, right), x, z);
	const double to_unit = 1.0 / std::sqrt(rise_x * rise_x + rise_z * rise_z + spacing_ * spacing_);
	return {
			static_cast<float>(height + offset_.y),
			{
					static_cast<float>(-rise_x * to_unit),
					static_cast<float>(spacing_ * to_unit),
					static_cast<float>(-rise_z * to_unit),
			},
	};
}

Status RegionField::sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const {
	if (positions.size() != r_ground.size()) {
		return Status::wrong_size("ground", r_ground.size(), exactly(positions.size()));
	}
	for (std::size_t i = 0; i < positions.size(); ++i) {
		r_ground[i] = ground_at(positions[i]);
	}
	return {};
}

float RegionField::weight_at(
		const PostPosition &post_position, glm::dvec2 position, std::span<const std::int32_t> textures) const {
	const std::uint32_t control = control_at(post_position.post);
	auto base = static_cast<std::int32_t>(control >> base_shift & 0x1fu);
	auto overlay = static_cast<std::int32_t>(control >> overlay_shift & 0x1fu);
	double blend = (control >> blend_shift & 0xffu) / 255.0;
	if (paint_.enabled && (control & auto_bit) != 0) {
		const Ground ground = ground_at(position);
		const double height = ground.height - offset_.y;
		blend = paint_.slope * 2.0 * (ground.normal.y - 1.0) + 1.0 - paint_.height_reduction * 0.01 * height;
		blend = blend > 0.0 ? std::min(blend, 1.0) : 0.0; // The condition is false for NAN, which becomes 0.
		base = paint_.base;
		overlay = paint_.overlay;
	}
	const auto is_selected = [textures](std::int32_t texture) {
		return std::ranges::find(textures, texture) != textures.end();
	};
	return static_cast<float>((is_selected(base) ? 1.0 - blend : 0.0) + (is_selected(overlay) ? blend : 0.0));
}

Status RegionField::weigh(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
		std::span<Ground> r_ground) const {
	if (positions.size() != r_ground.size()) {
		return Status::wrong_size("ground", r_ground.size(), exactly(positions.size()));
	}
	for (std::size_t i = 0; i < positions.size(); ++i) {
		PostPosition post_position{};
		r_ground[i].weight = find_post_position(positions[i], post_position)
				? weight_at(post_position, positions[i], textures)
				: 0.0F;
	}
	return {};
}

} // namespace thicket
