#include "core/terrain/heightfield.hpp"

#include "core/base/check.hpp"
#include "core/base/floating_point.hpp"
#include "core/base/guard.hpp"
#include "core/terrain/grid_surface.hpp"
#include "core/terrain/inner_patches.hpp"
#include "core/terrain/smooth_patch.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <type_traits>
#include <utility>

namespace thicket {

namespace {

Status check(const HeightfieldFrame &frame, std::size_t posts) {
	if (const Status status = validate(frame); !status.ok()) {
		return status;
	}
	if (const std::size_t needed = static_cast<std::size_t>(frame.posts.x) * static_cast<std::size_t>(frame.posts.y);
			posts != needed) {
		return Status::wrong_size("posts", posts, exactly(needed));
	}
	return {};
}

/// Converts a height sample from units to meters. The result is rounded to float, to match samples
/// that are stored in meters.
float height_of_unit(const HeightfieldFrame &frame, float post) {
	return static_cast<float>(frame.min_height + (frame.max_height - frame.min_height) * post);
}

} // namespace

/// The height samples of a field as a grid of triangles.
struct Heightfield::Grid {
	HeightfieldFrame frame;
	HeightPosts posts;
	double base;
	double meters_per_step;
	static constexpr bool mirrored = false;

	glm::ivec2 patches() const { return frame.posts - 1; }
	glm::dvec2 post_position(glm::ivec2 post) const {
		return frame.area.min + frame.area.size() * glm::dvec2(post) / glm::dvec2(patches());
	}
	PostRange range(const Box3 &box) const {
		const auto to_posts = [this](const glm::dvec3 &corner) {
			return (glm::dvec2(corner.x, corner.z) - frame.area.min) / frame.area.size() * glm::dvec2(patches());
		};
		return {to_posts(box.min), to_posts(box.max)};
	}
	bool heights(glm::ivec2 patch, std::array<double, 4> &r_heights) const {
		if (posts.floats.empty()) {
			read(posts.steps.window(patch), r_heights, [](std::uint16_t post) -> double { return post; });
		} else if (posts.meaning == FloatPosts::meters) {
			read(posts.floats.window(patch), r_heights, [](float post) -> double { return post; });
		} else {
			read(posts.floats.window(patch), r_heights,
					[this](float post) -> double { return height_of_unit(frame, post); });
		}
		return std::ranges::none_of(r_heights, [](double height) { return std::isnan(height); });
	}

private:
	template <class Window, class HeightOf>
	void read(const Window &window, std::array<double, 4> &r_heights, const HeightOf &height_of) const {
		for (std::ptrdiff_t i = 0; i < 4; ++i) {
			const auto post = window.first[i / 2 * window.stride + i % 2];
			r_heights[static_cast<std::size_t>(i)] = base + height_of(post) * meters_per_step;
		}
	}
};

Status validate(const HeightfieldFrame &frame) {
	const auto check_posts = [](int posts) {
		return check_range("posts", posts, min_heightfield_posts, max_heightfield_posts);
	};
	const auto check_height = [](const char *property, double height) {
		return check_range(property, height, -max_heightfield_height, max_heightfield_height);
	};
	const auto check_size = [](double size, int posts) {
		// The size is not finite if either end of the area is not finite.
		const Status status = check_positive("area", size);
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

RefusedPost find_refused_post(std::span<const float> posts, int columns, FloatPosts meaning) {
	const bool units = meaning == FloatPosts::units;
	const float min = units ? 0.0F : static_cast<float>(-max_heightfield_height);
	const float max = units ? 1.0F : static_cast<float>(max_heightfield_height);
	const auto is_invalid = [=](float post) {
		return post < min || post > max; // False for NAN, which is a hole.
	};
	const auto invalid_post = std::ranges::find_if(posts, is_invalid);
	if (invalid_post == posts.end()) {
		return {};
	}
	const auto index = static_cast<int>(invalid_post - posts.begin());
	return {check_range("posts", *invalid_post, min, max), {index % columns, index / columns}};
}

Status Heightfield::set(const HeightfieldFrame &frame, std::span<const std::uint16_t> posts) {
	if (const Status status = check(frame, posts.size()); !status.ok()) {
		return status;
	}
	return guarded("posts", static_cast<double>(posts.size()), [&] {
		const auto copy = std::make_shared<const std::vector<std::uint16_t>>(posts.begin(), posts.end());
		return set_posts(frame, HeightPosts{{frame.posts, copy}, {}, FloatPosts::meters});
	});
}

Status Heightfield::set_meters(const HeightfieldFrame &frame, std::span<const float> posts) {
	if (const Status status = check(frame, posts.size()); !status.ok()) {
		return status;
	}
	if (const RefusedPost refused = find_refused_post(posts, frame.posts.x, FloatPosts::meters); !refused.status.ok()) {
		return refused.status;
	}
	return guarded("posts", static_cast<double>(posts.size()), [&] {
		const auto copy = std::make_shared<const std::vector<float>>(posts.begin(), posts.end());
		return set_posts(frame, HeightPosts{{}, {frame.posts, copy}, FloatPosts::meters});
	});
}

Status Heightfield::set_posts(const HeightfieldFrame &frame, const HeightPosts &posts) {
	if (const Status status = validate(frame); !status.ok()) {
		return status;
	}
	if (posts.count() != frame.posts) {
		return Status::wrong_size("posts", posts.count().x, exactly(frame.posts.x, "columns"));
	}
	return guarded("posts", static_cast<double>(frame.posts.x), [&] {
		Heightfield next(*this);
		next.frame_ = frame;
		next.posts_per_meter_ = glm::dvec2(frame.posts - 1) / frame.area.size();
		const bool in_steps = !posts.steps.empty();
		next.base_ = in_steps ? frame.min_height : 0.0;
		next.meters_per_step_ = in_steps ? (frame.max_height - frame.min_height) / 65535.0 : 1.0;
		next.take(posts);
		*this = std::move(next);
	});
}

/// Stores the samples and rebuilds the surface. The members that define heights must be set.
void Heightfield::take(HeightPosts posts) {
	surface_ = std::make_shared<const GridSurface<Grid>>(Grid{frame_, posts, base_, meters_per_step_});
	posts_ = std::move(posts);
}

Status Heightfield::check_patch(const PixelRect &rect, std::size_t posts, bool type_matches) const {
	const glm::ivec2 count = frame_.posts;
	if (!type_matches) {
		return {ErrorCode::missing, "height samples of this type", 0.0};
	}
	if (rect.empty() || rect.min.x < 0 || rect.min.y < 0 || rect.max.x > count.x || rect.max.y > count.y) {
		return {ErrorCode::out_of_range, "rect", static_cast<double>(rect.min.x), {}, {},
				"Use a non-empty rectangle that lies within the height map"};
	}
	if (const std::size_t needed = static_cast<std::size_t>(rect.size().x) * static_cast<std::size_t>(rect.size().y);
			posts != needed) {
		return Status::wrong_size("posts", posts, exactly(needed));
	}
	return {};
}

Status Heightfield::patch(const PixelRect &rect, std::span<const std::uint16_t> posts) {
	if (const Status status = check_patch(rect, posts.size(), !posts_.steps.empty()); !status.ok()) {
		return status;
	}
	return guarded("posts", static_cast<double>(posts.size()), [&] {
		HeightPosts next = posts_;
		next.steps.patch(rect, posts);
		take(std::move(next));
	});
}

Status Heightfield::patch(const PixelRect &rect, std::span<const float> posts) {
	if (const Status status = check_patch(rect, posts.size(), !posts_.floats.empty()); !status.ok()) {
		return status;
	}
	const RefusedPost refused = find_refused_post(posts, rect.size().x, posts_.meaning);
	if (!refused.status.ok()) {
		return refused.status;
	}
	return guarded("posts", static_cast<double>(posts.size()), [&] {
		HeightPosts next = posts_;
		next.floats.patch(rect, posts);
		take(std::move(next));
	});
}

/// A height sample affects the heights of the adjacent patches, and slopes up to one sample
/// farther.
Rect Heightfield::area_of(const PixelRect &rect) const {
	constexpr int margin = 2;
	const glm::dvec2 first = glm::max(rect.min - margin, glm::ivec2(0));
	const glm::dvec2 last = glm::min(rect.max - 1 + margin, frame_.posts - 1);
	return {frame_.area.min + first / posts_per_meter_, frame_.area.min + last / posts_per_meter_};
}

void Heightfield::add_changes(const Heightfield &before, std::vector<Rect> &r_areas) const {
	const HeightPosts &posts = posts_;
	const HeightPosts &previous_posts = before.posts_;
	const bool floats_differ = !posts.floats.empty() && posts.meaning != previous_posts.meaning;
	if (!(frame_ == before.frame_) || posts.steps.empty() != previous_posts.steps.empty() || floats_differ) {
		r_areas.push_back(before.frame_.area);
		r_areas.push_back(frame_.area);
		return;
	}
	std::vector<PixelRect> changed;
	if (posts.steps.empty()) {
		posts.floats.add_changes(previous_posts.floats, changed);
	} else {
		posts.steps.add_changes(previous_posts.steps, changed);
	}
	for (const PixelRect &rect : changed) {
		r_areas.push_back(area_of(rect));
	}
	std::vector<Rect> weight_areas;
	weights_.add_changes(before.weights_, weight_areas);
	for (const Rect &weight_area : weight_areas) {
		const glm::dvec2 size = frame_.area.size();
		r_areas.push_back({frame_.area.min + weight_area.min * size, frame_.area.min + weight_area.max * size});
	}
}

Status Heightfield::sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const {
	if (positions.size() != r_ground.size()) {
		return Status::wrong_size("ground", r_ground.size(), exactly(positions.size()));
	}
	if (posts_.floats.empty()) {
		sample_posts(positions, r_ground);
		return {};
	}
	const auto meters = [](float post) {
		return post;
	};
	const auto units = [this](float post) {
		return height_of_unit(frame_, post);
	};
	for (std::size_t i = 0; i < positions.size(); ++i) {
		if (!in_area(positions[i])) {
			r_ground[i] = Ground{};
		} else if (posts_.meaning == FloatPosts::meters) {
			r_ground[i] = ground_in_area(posts_.floats, meters, positions[i]);
		} else {
			r_ground[i] = ground_in_area(posts_.floats, units, positions[i]);
		}
	}
	return {};
}

double Heightfield::post_height(glm::ivec2 post) const {
	if (posts_.floats.empty()) {
		return base_ + posts_.steps.at(post) * meters_per_step_;
	}
	const float value = posts_.floats.at(post);
	return posts_.meaning == FloatPosts::meters ? value : height_of_unit(frame_, value);
}

/// Samples ground from 16-bit height samples, which have no holes.
void Heightfield::sample_posts(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const {
	InnerPatches patches;
	const auto identity = [](std::uint16_t post) {
		return post;
	};
	const auto compute = [&] {
		patches.compute({base_, meters_per_step_, posts_per_meter_});
		for (std::size_t i = 0; i < patches.count; ++i) {
			r_ground[patches.indices[i]] = {
					patches.height[i], {patches.normal_x[i], patches.normal_y[i], patches.normal_z[i]}};
		}
		patches.count = 0;
	};
	for (std::size_t i = 0; i < positions.size(); ++i) {
		if (!in_area(positions[i]) || posts_.steps.empty()) {
			r_ground[i] = Ground{};
			continue;
		}
		const Patch patch = patch_at(positions[i]);
		if (!is_inner_patch(frame_.posts, patch.first)) {
			r_ground[i] = ground_in_area(posts_.steps, identity, positions[i]);
			continue;
		}
		// Patches that are not at the border, which are most patches, are computed many at a time.
		const PostGrid<std::uint16_t>::Window window = posts_.steps.window(patch.first);
		patches.add(window.first, window.stride, patch.fraction, i);
		if (patches.full()) {
			compute();
		}
	}
	if (patches.count > 0) {
		compute();
	}
}

/// Returns the patch that contains a position. The last patch includes its far border.
Heightfield::Patch Heightfield::patch_at(glm::dvec2 position) const {
	const glm::dvec2 along_posts = (position - frame_.area.min) * posts_per_meter_;
	const int column = std::min(static_cast<int>(along_posts.x), frame_.posts.x - 2);
	const int row = std::min(static_cast<int>(along_posts.y), frame_.posts.y - 2);
	return {{column, row}, {along_posts.x - column, along_posts.y - row}};
}

Status Heightfield::weigh(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
		std::span<Ground> r_ground) const {
	if (positions.size() != r_ground.size()) {
		return Status::wrong_size("ground", r_ground.size(), exactly(positions.size()));
	}
	if (weights_.empty()) {
		return {};
	}
	const unsigned channels = weights_.channels_of(textures);
	const glm::dvec2 size = frame_.area.size();
	for (std::size_t i = 0; i < positions.size(); ++i) {
		const bool is_inside = in_area(positions[i]);
		r_ground[i].weight = is_inside ? weights_.weight((positions[i] - frame_.area.min) / size, channels) : 0.0f;
	}
	return {};
}

bool Heightfield::in_area(glm::dvec2 position) const {
	const auto &[min, max] = frame_.area;
	// The result is false for NAN.
	return position.x >= min.x && position.x <= max.x && position.y >= min.y && position.y <= max.y;
}

/// Returns the ground at a position inside the area. `height_of` converts a height sample to a
/// height, in steps or in meters.
template <typename Post, class HeightOf>
Ground Heightfield::ground_in_area(const PostGrid<Post> &posts, const HeightOf &height_of, glm::dvec2 position) const {
	const auto &[corner, fraction] = patch_at(position);
	const int column = corner.x;
	const int row = corner.y;
	constexpr bool may_be_missing = std::is_floating_point_v<Post>;
	const typename PostGrid<Post>::Window window = posts.window(corner);
	const auto from_first = [&](int i, int j) {
		return static_cast<double>(height_of(window.first[j * window.stride + i]));
	};
	const auto from_corner = [&](int i, int j) {
		return from_first(i - column, j - row);
	};
	SmoothPatch patch;
	if (is_inner_patch(frame_.posts, corner)) {
		// Away from the border, the offsets of the height samples around a patch are constant.
		patch = smooth_patch<may_be_missing>(inner_line, inner_line, fraction, from_first);
	} else {
		patch = smooth_patch<may_be_missing>(frame_.posts, corner, fraction, from_corner);
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
