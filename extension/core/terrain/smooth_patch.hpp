#pragma once

#include "core/base/bilinear.hpp"
#include "core/base/floating_point.hpp"

#include <glm/vec2.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace thicket {

/// The height at a position on a grid of height samples, and the gradient per grid step along x and
/// y. Both are in the unit of the samples.
struct SmoothPatch {
	double height;
	glm::dvec2 gradient;
};

/// The indices, clamped to the grid, of four height samples in a line around a patch: one before
/// the patch, its two samples, and one after it. A line also contains the factors that convert
/// differences between the neighbors of a sample to gradients per grid step.
struct PostLine {
	std::array<int, 4> index;
	double first_weight;
	double second_weight;

	/// Returns the line around the patch between the height samples `patch` and `patch` + 1, in a
	/// line of `posts` samples.
	static constexpr PostLine about(int patch, int posts) {
		const int before = std::max(patch - 1, 0);
		const int behind = std::min(patch + 2, posts - 1);
		return {{before, patch, patch + 1, behind}, before == patch ? 1.0 : 0.5, behind == patch + 1 ? 1.0 : 0.5};
	}
};

/// Returns the gradient per grid step at the height sample `post`, from its two neighbors. If
/// samples may be missing (NAN), the difference next to a missing one is one-sided, as at the
/// border.
template <bool may_be_missing>
double post_gradient(double behind, double before, double post, double weight) {
	if constexpr (may_be_missing) {
		if (std::isnan(before)) {
			return behind - post;
		}
		if (std::isnan(behind)) {
			return post - before;
		}
	}
	return (behind - before) * weight;
}

/// Computes the surface between four height samples. The heights are interpolated bilinearly, and
/// so are the gradients at the four samples. The gradients are central differences (one-sided at
/// the border of the grid). `post(column, row)` returns a double for indices of the two lines.
/// `part` is the fraction of the way from the first sample to the next one on each axis, 0 to
/// 1. If samples may be missing and one of the four is NAN, the height is NAN and the gradient is
/// meaningless.
template <bool may_be_missing, class Post>
SmoothPatch smooth_patch(const PostLine &across, const PostLine &along, glm::dvec2 part, const Post &post) {
	// Returns one of the 4 x 4 height samples around the patch. The corners are never read.
	const auto near = [&](std::size_t i, std::size_t j) -> double {
		return post(across.index[i], along.index[j]);
	};
	const auto between = [part](const std::array<double, 4> &four) {
		return bilinear(four[0], four[1], four[2], four[3], part.x, part.y);
	};
	const std::array<double, 4> heights{near(1, 1), near(2, 1), near(1, 2), near(2, 2)};
	const double height = between(heights);
	if constexpr (may_be_missing) {
		if (std::isnan(height)) {
			// The gradient in a hole is never used.
			return {height, {0.0, 0.0}};
		}
	}
	constexpr auto gradient = post_gradient<may_be_missing>;
	const std::array<double, 4> rise_x{
			gradient(heights[1], near(0, 1), heights[0], across.first_weight),
			gradient(near(3, 1), heights[0], heights[1], across.second_weight),
			gradient(heights[3], near(0, 2), heights[2], across.first_weight),
			gradient(near(3, 2), heights[2], heights[3], across.second_weight),
	};
	const std::array<double, 4> rise_y{
			gradient(heights[2], near(1, 0), heights[0], along.first_weight),
			gradient(heights[3], near(2, 0), heights[1], along.first_weight),
			gradient(near(1, 3), heights[0], heights[2], along.second_weight),
			gradient(near(2, 3), heights[1], heights[3], along.second_weight),
	};
	return {height, {between(rise_x), between(rise_y)}};
}

/// Computes the surface in the patch whose first height sample is `patch`, in a grid of `posts`
/// samples.
template <bool may_be_missing, class Post>
SmoothPatch smooth_patch(glm::ivec2 posts, glm::ivec2 patch, glm::dvec2 part, const Post &post) {
	return smooth_patch<may_be_missing>(
			PostLine::about(patch.x, posts.x), PostLine::about(patch.y, posts.y), part, post);
}

/// Returns true if a patch does not touch the border of a grid. `inner_line`, relative to the
/// patch's first height sample, is then valid on both axes.
constexpr bool is_inner_patch(glm::ivec2 posts, glm::ivec2 patch) {
	return patch.x >= 1 && patch.y >= 1 && patch.x + 2 < posts.x && patch.y + 2 < posts.y;
}
inline constexpr PostLine inner_line{{-1, 0, 1, 2}, 0.5, 0.5};

} // namespace thicket
