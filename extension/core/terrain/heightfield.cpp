#include "core/terrain/heightfield.hpp"

#include "core/base/check.hpp"
#include "core/base/floating_point.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace thicket {

namespace {

/// Values at the four posts of a patch, in the order (column, row) (column + 1, row) (column, row + 1) (both + 1).
using Patch = std::array<double, 4>;

double bilinear(const Patch &patch, double x, double y) {
	const double near = patch[0] + (patch[1] - patch[0]) * x;
	const double far = patch[2] + (patch[3] - patch[2]) * x;
	return near + (far - near) * y;
}

/// The indices of four posts in a line about a patch: before it, its two and behind it, held inside the field; and what
/// turns the difference of the neighbours of its first and of its second post into a gradient per post.
struct Line {
	std::array<std::size_t, 4> index;
	double first_weight;
	double second_weight;
};

Line line_about(int patch, int posts) {
	const int before = std::max(patch - 1, 0);
	const int behind = std::min(patch + 2, posts - 1);
	return {
			{static_cast<std::size_t>(before), static_cast<std::size_t>(patch), static_cast<std::size_t>(patch) + 1,
					static_cast<std::size_t>(behind)},
			before == patch ? 1.0 : 0.5,
			behind == patch + 1 ? 1.0 : 0.5,
	};
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
	if (const Status status = validate(frame); !status.ok()) {
		return status;
	}
	if (posts.size() != static_cast<std::size_t>(frame.posts.x) * static_cast<std::size_t>(frame.posts.y)) {
		return {ErrorCode::wrong_size, "posts", static_cast<double>(posts.size())};
	}
	posts_.assign(posts.begin(), posts.end());
	frame_ = frame;
	posts_per_metre_ = glm::dvec2(frame.posts - 1) / frame.area.size();
	metres_per_step_ = (frame.max_height - frame.min_height) / 65535.0;
	return {};
}

Status Heightfield::sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const {
	if (positions.size() != r_ground.size()) {
		return {ErrorCode::wrong_size, "ground", static_cast<double>(r_ground.size())};
	}
	const glm::dvec2 min = frame_.area.min;
	const glm::dvec2 max = frame_.area.max;
	for (std::size_t i = 0; i < positions.size(); ++i) {
		const glm::dvec2 position = positions[i];
		// False for NAN.
		const bool inside = position.x >= min.x && position.x <= max.x && position.y >= min.y && position.y <= max.y;
		r_ground[i] = inside && !posts_.empty() ? ground_in_area(position) : Ground{};
	}
	return {};
}

Ground Heightfield::ground_in_area(glm::dvec2 position) const {
	// In posts from the first one. The last patch takes its far border too.
	const glm::dvec2 place = (position - frame_.area.min) * posts_per_metre_;
	const int column = std::min(static_cast<int>(place.x), frame_.posts.x - 2);
	const int row = std::min(static_cast<int>(place.y), frame_.posts.y - 2);
	const double x = place.x - column;
	const double y = place.y - row;

	const Line across = line_about(column, frame_.posts.x);
	const Line along = line_about(row, frame_.posts.y);
	const auto stride = static_cast<std::size_t>(frame_.posts.x);
	// The post at a column and a row of the 4 x 4 about the patch; its corners are never asked for.
	const auto post = [&](std::size_t i, std::size_t j) {
		return static_cast<double>(posts_[along.index[j] * stride + across.index[i]]);
	};

	const Patch steps{post(1, 1), post(2, 1), post(1, 2), post(2, 2)};
	const Patch slope_x{
			(steps[1] - post(0, 1)) * across.first_weight,
			(post(3, 1) - steps[0]) * across.second_weight,
			(steps[3] - post(0, 2)) * across.first_weight,
			(post(3, 2) - steps[2]) * across.second_weight,
	};
	const Patch slope_y{
			(steps[2] - post(1, 0)) * along.first_weight,
			(steps[3] - post(2, 0)) * along.first_weight,
			(post(1, 3) - steps[0]) * along.second_weight,
			(post(2, 3) - steps[1]) * along.second_weight,
	};
	const double gradient_x = bilinear(slope_x, x, y) * metres_per_step_ * posts_per_metre_.x;
	const double gradient_y = bilinear(slope_y, x, y) * metres_per_step_ * posts_per_metre_.y;
	const double to_unit = 1.0 / std::sqrt(gradient_x * gradient_x + gradient_y * gradient_y + 1.0);
	return {
			static_cast<float>(frame_.min_height + bilinear(steps, x, y) * metres_per_step_),
			{
					static_cast<float>(-gradient_x * to_unit),
					static_cast<float>(to_unit),
					static_cast<float>(-gradient_y * to_unit),
			},
	};
}

} // namespace thicket
