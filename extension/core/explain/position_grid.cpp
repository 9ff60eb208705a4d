#include "core/explain/position_grid.hpp"

#include "core/base/check.hpp"
#include "core/base/guard.hpp"
#include "core/base/trigonometry.hpp"
#include "core/rules/rules.hpp"

#include <algorithm>
#include <limits>

namespace thicket {

Status grid_positions(const Rect &rect, glm::ivec2 size, std::vector<glm::dvec2> &r_positions) {
	const double count = static_cast<double>(size.x) * static_cast<double>(size.y);
	if (size.x < 1 || size.y < 1) {
		return {ErrorCode::not_positive, "size", static_cast<double>(std::min(size.x, size.y))};
	}
	if (std::max(size.x, size.y) > max_grid_side || count > max_grid_positions) {
		return Status::out_of_range(
				"size", count, at_most(max_grid_positions, "positions"), "Lower its width or height");
	}
	if (!rect.finite()) {
		return {ErrorCode::not_finite, "rect", rect.size().x};
	}
	if (rect.min.x > rect.max.x || rect.min.y > rect.max.y) {
		return {ErrorCode::inverted, "rect", std::min(rect.size().x, rect.size().y), {}, {}, negative_size};
	}
	return guarded_answer("size", count, r_positions, [&] {
		r_positions.clear();
		r_positions.reserve(static_cast<std::size_t>(count));
		const glm::dvec2 cell_size = rect.size() / glm::dvec2(size);
		for (int y = 0; y < size.y; ++y) {
			for (int x = 0; x < size.x; ++x) {
				r_positions.push_back(rect.min + cell_size * (glm::dvec2(x, y) + 0.5));
			}
		}
	});
}

float ground_slope(const Ground &ground) {
	return is_ground(ground) ? static_cast<float>(slope_degrees(ground.normal))
							 : std::numeric_limits<float>::quiet_NaN();
}

} // namespace thicket
