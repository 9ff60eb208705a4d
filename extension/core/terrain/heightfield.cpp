#include "core/terrain/heightfield.hpp"

#include "core/base/check.hpp"
#include "core/base/floating_point.hpp"
#include "core/base/guard.hpp"
#include "core/terrain/inner_patches.hpp"
#include "core/terrain/smooth_patch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>

namespace thicket {

namespace {

Status check(const HeightfieldFrame &frame, std::size_t posts) {
	if (const Status status = validate(frame); !status.ok()) {
		return status;
	}
	if (posts != static_cast<std::size_t>(frame.posts.x) * static_cast<std::size_t>(frame.posts.y)) {
		return {ErrorCode::wrong_size, "posts", static_cast<double>(posts)};
	}
	return {};
}

} // namespace

Status validate(const HeightfieldFrame &frame) {
	const auto check_posts = [](int posts) {
		return check_range("posts", posts, 2, max_heightfield_posts);
	};
	const auto check_height = [](const char *property, double height) {
		return check_range(property, height, -max_heightfield_height, max_heightfield_height);
	};
	const auto check_size = [](double size, int posts) {
		const Status status = check_positive("area", size); // Not finite if either end is not.
		return status.ok()
				? check_range("area", size, min_post_spacing * (posts - 1), std::numeric_limits<double>::max())
				: status;
	};
	const glm::dvec2 size = frame.area.size();
	return first_failure(check_posts(frame.posts.x), check_posts(frame.posts.y), check_size(size.x, frame.posts.x),
			check_size(size.y, frame.posts.y), check_height("min_height", frame.min_height),
			check_height("max_height", frame.max_height),
			check_order("max_height", frame.min_height, frame.max_height));
}

Status Heightfield::set(const HeightfieldFrame &frame, std::span<const std::uint16_t> posts) {
	if (const Status status = check(frame, posts.size()); !status.ok()) {
		return status;
	}
	return guarded("posts", static_cast<double>(posts.size()), [&] {
		posts_ = std::vector<std::uint16_t>(posts.begin(), posts.end());
		meters_ = {};
		take(frame, frame.min_height, (frame.max_height - frame.min_height) / 65535.0);
	});
}

Status Heightfield::set_meters(const HeightfieldFrame &frame, std::span<const float> posts) {
	if (const Status status = check(frame, posts.size()); !status.ok()) {
		return status;
	}
	for (const float post : posts) {
		if (std::isnan(post)) {
			continue;
		}
		const Status status = check_range("posts", post, -max_heightfield_height, max_heightfield_height);
		if (!status.ok()) {
			return status;
		}
	}
	return guarded("posts", static_cast<double>(posts.size()), [&] {
		meters_ = std::vector<float>(posts.begin(), posts.end());
		posts_ = {};
		take(frame, 0.0, 1.0);
	});
}

void Heightfield::take(const HeightfieldFrame &frame, double base, double meters_per_step) {
	frame_ = frame;
	posts_per_meter_ = glm::dvec2(frame.posts - 1) / frame.area.size();
	base_ = base;
	meters_per_step_ = meters_per_step;
}

Status Heightfield::sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const {
	if (positions.size() != r_ground.size()) {
		return {ErrorCode::wrong_size, "ground", static_cast<double>(r_ground.size())};
	}
	if (meters_.empty()) {
		sample_posts(positions, r_ground);
		return {};
	}
	for (std::size_t i = 0; i < positions.size(); ++i) {
		r_ground[i] = in_area(positions[i]) ? ground_in_area(meters_, positions[i]) : Ground{};
	}
	return {};
}

/// Of whole numbers, of which none is missing.
void Heightfield::sample_posts(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const {
	InnerPatches patches;
	const auto stride = static_cast<std::ptrdiff_t>(frame_.posts.x);
	const auto compute = [&] {
		patches.compute({base_, meters_per_step_, posts_per_meter_});
		for (std::size_t i = 0; i < patches.count; ++i) {
			r_ground[patches.numbers[i]] = {
					patches.height[i], {patches.normal_x[i], patches.normal_y[i], patches.normal_z[i]}};
		}
		patches.count = 0;
	};
	for (std::size_t i = 0; i < positions.size(); ++i) {
		if (!in_area(positions[i]) || posts_.empty()) {
			r_ground[i] = Ground{};
			continue;
		}
		const Patch patch = patch_at(positions[i]);
		if (!is_inner_patch(frame_.posts, patch.first)) {
			r_ground[i] = ground_in_area(posts_, positions[i]);
			continue;
		}
		// Fast path: most patches are away from the border, and computed many at a time.
		patches.add(posts_.data() + patch.first.y * stride + patch.first.x, stride, patch.part, i);
		if (patches.full()) {
			compute();
		}
	}
	if (patches.count > 0) {
		compute();
	}
}

/// In posts from the first one. The last patch takes its far border too.
Heightfield::Patch Heightfield::patch_at(glm::dvec2 position) const {
	const glm::dvec2 along_posts = (position - frame_.area.min) * posts_per_meter_;
	const int column = std::min(static_cast<int>(along_posts.x), frame_.posts.x - 2);
	const int row = std::min(static_cast<int>(along_posts.y), frame_.posts.y - 2);
	return {{column, row}, {along_posts.x - column, along_posts.y - row}};
}

Status Heightfield::weigh(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
		std::span<Ground> r_ground) const {
	if (positions.size() != r_ground.size()) {
		return {ErrorCode::wrong_size, "ground", static_cast<double>(r_ground.size())};
	}
	if (weights_.empty()) {
		return {};
	}
	const unsigned channels = weights_.channels_of(textures);
	const glm::dvec2 size = frame_.area.size();
	for (std::size_t i = 0; i < positions.size(); ++i) {
		const bool inside = in_area(positions[i]);
		r_ground[i].weight = inside ? weights_.weight((positions[i] - frame_.area.min) / size, channels) : 0.0f;
	}
	return {};
}

bool Heightfield::in_area(glm::dvec2 position) const {
	const auto &[min, max] = frame_.area;
	// False for NAN.
	return position.x >= min.x && position.x <= max.x && position.y >= min.y && position.y <= max.y;
}

template <typename Post>
Ground Heightfield::ground_in_area(const std::vector<Post> &posts, glm::dvec2 position) const {
	const auto &[corner, part] = patch_at(position);
	const int column = corner.x;
	const int row = corner.y;
	const auto stride = static_cast<std::size_t>(frame_.posts.x);
	constexpr bool may_be_missing = std::is_floating_point_v<Post>;
	const Post *first = &posts[static_cast<std::size_t>(row) * stride + static_cast<std::size_t>(column)];
	const auto from_first = [first, step = static_cast<std::ptrdiff_t>(stride)](int i, int j) {
		return static_cast<double>(first[j * step + i]);
	};
	const auto from_corner = [&](int i, int j) {
		return from_first(i - column, j - row);
	};
	SmoothPatch patch;
	if (is_inner_patch(frame_.posts, corner)) {
		// Fast path: away from the border, what is around a patch is known when this is compiled.
		patch = smooth_patch<may_be_missing>(inner_line, inner_line, part, from_first);
	} else {
		patch = smooth_patch<may_be_missing>(frame_.posts, corner, part, from_corner);
	}
	const double height = base_ + patch.height * meters_per_step_;
	if (may_be_missing && std::isnan(height)) {
		return {};
	}
	const double gradient_x = patch.gradient.x * meters_per_step_ * posts_per_meter_.x;
	const double gradient_y = patch.gradient.y * meters_per_step_ * posts_per_meter_.y;
	const double to_unit = 1.0 / std::sqrt(gradient_x * gradient_x + gradient_y * gradient_y + 1.0);
	return {
			static_cast<float>(height),
			{
					static_cast<float>(-gradient_x * to_unit),
					static_cast<float>(to_unit),
					static_cast<float>(-gradient_y * to_unit),
			},
	};
}

} // namespace thicket
