#include "core/sampling/nearest_points.hpp"

#include "core/base/floating_point.hpp"
#include "core/base/guard.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace thicket {

namespace {

/// Points sorted into square buckets that are one radius wide.
class Buckets {
public:
	Buckets(const std::vector<SamplePoint> &points, const Rect &area, double side) :
			points_(points), area_(area), side_(side) {
		const glm::dvec2 count = glm::floor(area.size() / side) + 1.0;
		columns_ = static_cast<std::ptrdiff_t>(count.x);
		rows_ = static_cast<std::ptrdiff_t>(count.y);
		first_.assign(static_cast<std::size_t>(columns_ * rows_), none);
		next_.assign(points.size(), none);
		for (std::size_t i = 0; i < points.size(); ++i) {
			std::size_t &first = first_[bucket(points[i].position)];
			next_[i] = first;
			first = i;
		}
	}

	/// Returns the point nearest to `position`, or no_point if there is none within a bucket's
	/// width.
	const SamplePoint &nearest(glm::dvec2 position) const {
		double squared = side_ * side_;
		std::size_t best = none;
		const std::ptrdiff_t x = column(position.x - area_.min.x, columns_);
		const std::ptrdiff_t y = column(position.y - area_.min.y, rows_);
		for (std::ptrdiff_t row = std::max<std::ptrdiff_t>(y - 1, 0); row <= std::min(y + 1, rows_ - 1); ++row) {
			for (std::ptrdiff_t at = std::max<std::ptrdiff_t>(x - 1, 0); at <= std::min(x + 1, columns_ - 1); ++at) {
				for (std::size_t i = first_[static_cast<std::size_t>(row * columns_ + at)]; i != none; i = next_[i]) {
					const glm::dvec2 offset = points_[i].position - position;
					const double found = glm::dot(offset, offset);
					if (found < squared || (found == squared && best != none && points_[i].id < points_[best].id)) {
						squared = found;
						best = i;
					}
				}
			}
		}
		return best != none ? points_[best] : no_point;
	}

private:
	static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

	std::ptrdiff_t column(double along, std::ptrdiff_t count) const {
		return std::clamp<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(along / side_), 0, count - 1);
	}

	std::size_t bucket(glm::dvec2 position) const {
		const glm::dvec2 along = position - area_.min;
		return static_cast<std::size_t>(column(along.y, rows_) * columns_ + column(along.x, columns_));
	}

	const std::vector<SamplePoint> &points_;
	Rect area_;
	double side_;
	std::ptrdiff_t columns_ = 1;
	std::ptrdiff_t rows_ = 1;
	std::vector<std::size_t> first_; ///< Index of the first point of each bucket.
	std::vector<std::size_t> next_;  ///< Index of the next point in the same bucket.
};

/// Returns the maximum distance from a position to its nearest point: the radius, plus 0.1 % for
/// rounding.
double reach_of_point(const PointSet &set) { return 1.001 * set.radius; }

Status find(TileSampler &sampler, const PointSet &set, std::span<const glm::dvec2> positions,
		std::vector<SamplePoint> &r_points) {
	const Rect area = enclosing_rect(positions);
	if (!area.finite()) {
		return {ErrorCode::not_finite, "positions", std::isfinite(area.min.x) ? area.min.y : area.min.x};
	}
	std::vector<SamplePoint> points;
	if (const Status status = sampler.sample(set, point_area(set, area), points); !status.ok()) {
		return status;
	}
	if (points.empty()) {
		return {ErrorCode::out_of_range, "positions", positions.front().x, {}, {},
				"Move closer to the origin: the set ends there"};
	}
	nearest_among(points, set, positions, r_points);
	return {};
}

} // namespace

Rect enclosing_rect(std::span<const glm::dvec2> positions) {
	Rect rect{positions.front(), positions.front()};
	for (const glm::dvec2 position : positions) {
		if (!std::isfinite(position.x) || !std::isfinite(position.y)) {
			return {position, position};
		}
		rect = {glm::min(rect.min, position), glm::max(rect.max, position)};
	}
	return rect;
}

Rect point_area(const PointSet &set, const Rect &area) {
	const double reach = reach_of_point(set);
	return expanded(area, reach);
}

void nearest_among(const std::vector<SamplePoint> &points, const PointSet &set, std::span<const glm::dvec2> positions,
		std::vector<SamplePoint> &r_points) {
	r_points.clear();
	if (positions.empty()) {
		return;
	}
	const Buckets buckets(points, point_area(set, enclosing_rect(positions)), reach_of_point(set));
	r_points.reserve(positions.size());
	for (const glm::dvec2 position : positions) {
		r_points.push_back(buckets.nearest(position));
	}
}

Status nearest_points(TileSampler &sampler, const PointSet &set, std::span<const glm::dvec2> positions,
		std::vector<SamplePoint> &r_points) {
	r_points.clear();
	if (positions.empty()) {
		return {};
	}
	return guarded_answer("positions", static_cast<double>(positions.size()), r_points,
			[&] { return find(sampler, set, positions, r_points); });
}

} // namespace thicket
