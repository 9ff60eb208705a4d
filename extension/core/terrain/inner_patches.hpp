#pragma once

#include "core/base/bilinear.hpp"

#include <glm/vec2.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace thicket {

/// Patches of a grid away from its border, many at a time: smooth_patch and the normal, in loops without a branch, of which compilers make
/// vectors. The same operations in the same order, so the same bits.
struct InnerPatches {
	static constexpr std::size_t most = 32;
	using Numbers = std::array<double, most>;
	using Floats = std::array<float, most>;

	/// Of a grid of heights: height = base + post * scale.
	struct Heights {
		double base = 0.0;
		double scale = 1.0;
		glm::dvec2 posts_per_meter{1.0};
	};

	/// Adds the patch whose first post `first` points at, in rows of `stride`; the position is `part` of the way to its far corner.
	template <class Post>
	void add(const Post *first, std::ptrdiff_t stride, glm::dvec2 part, std::size_t number) {
		const auto put = [&](std::size_t at, std::ptrdiff_t i, std::ptrdiff_t j) {
			posts[at][count] = static_cast<double>(first[j * stride + i]);
		};
		put(0, 0, -1);
		put(1, 1, -1);
		for (std::ptrdiff_t i = -1; i <= 2; ++i) {
			put(static_cast<std::size_t>(3 + i), i, 0);
			put(static_cast<std::size_t>(7 + i), i, 1);
		}
		put(10, 0, 2);
		put(11, 1, 2);
		x[count] = part.x;
		y[count] = part.y;
		numbers[count++] = number;
	}

	bool full() const { return count == most; }

	/// Computes the ground of all; of those behind the last one, too, for a loop whose length is known.
	void compute(const Heights &of) {
		const auto &[up_left, up_right, left, a, b, right, left_2, c, d, right_2, down_left, down_right] = posts;
		for (std::size_t i = 0; i < most; ++i) {
			const auto between = [&](double near_left, double near_right, double far_left, double far_right) {
				return bilinear(near_left, near_right, far_left, far_right, x[i], y[i]);
			};
			const double rise_x = between((b[i] - left[i]) * 0.5, (right[i] - a[i]) * 0.5, (d[i] - left_2[i]) * 0.5,
					(right_2[i] - c[i]) * 0.5);
			const double rise_y = between((c[i] - up_left[i]) * 0.5, (d[i] - up_right[i]) * 0.5,
					(down_left[i] - a[i]) * 0.5, (down_right[i] - b[i]) * 0.5);
			const double gradient_x = rise_x * of.scale * of.posts_per_meter.x;
			const double gradient_y = rise_y * of.scale * of.posts_per_meter.y;
			const double to_unit = 1.0 / std::sqrt(gradient_x * gradient_x + gradient_y * gradient_y + 1.0);
			height[i] = static_cast<float>(of.base + between(a[i], b[i], c[i], d[i]) * of.scale);
			normal_x[i] = static_cast<float>(-gradient_x * to_unit);
			normal_y[i] = static_cast<float>(to_unit);
			normal_z[i] = static_cast<float>(-gradient_y * to_unit);
		}
	}

	std::size_t count = 0;
	std::array<std::size_t, most> numbers{}; ///< The caller's own, of each.
	std::array<Numbers, 12> posts{};         ///< The 4 x 4 about the patch without the corners, row by row.
	Numbers x{};
	Numbers y{};

	// After `compute`.
	Floats height{};
	Floats normal_x{};
	Floats normal_y{};
	Floats normal_z{};
};

} // namespace thicket
