#include "core/rules/outline.hpp"

#include "core/base/floating_point.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace thicket {

namespace {

/// Runs that are still to be looked at: one a level and one more, of at most 2^32 runs.
template <typename Run>
class Stack {
public:
	void push(const Run &run) { runs_[size_++] = run; }
	Run pop() { return runs_[--size_]; }
	bool empty() const { return size_ == 0; }

private:
	std::array<Run, 40> runs_;
	std::size_t size_ = 0;
};

enum class Side : std::uint8_t {
	none,  ///< The ray from the place towards +x misses the edge.
	cross, ///< It crosses the edge.
	on,    ///< The place lies on the edge.
};

/// An edge takes its lower end and leaves its upper one out, so a ray through a corner crosses once or twice as it should.
Side side(glm::dvec2 a, glm::dvec2 b, glm::dvec2 place) {
	// One order for both directions: an edge that is walked there and back is crossed twice or not at all.
	if (b.y < a.y || (b.y == a.y && b.x < a.x)) {
		std::swap(a, b);
	}
	if (place.y < a.y || place.y > b.y || place.x > std::max(a.x, b.x)) {
		return Side::none;
	}
	if (place.x >= std::min(a.x, b.x)) {
		const double left = (b.x - a.x) * (place.y - a.y) - (b.y - a.y) * (place.x - a.x);
		if (left == 0.0) {
			return Side::on;
		}
		if (left < 0.0) {
			return Side::none;
		}
	}
	return place.y < b.y ? Side::cross : Side::none;
}

double edge_distance2(glm::dvec2 a, glm::dvec2 b, glm::dvec2 place) {
	const glm::dvec2 edge = b - a;
	const glm::dvec2 offset = place - a;
	const double length2 = edge.x * edge.x + edge.y * edge.y;
	const double along = offset.x * edge.x + offset.y * edge.y;
	const double part = length2 > 0.0 ? std::clamp(along / length2, 0.0, 1.0) : 0.0; // A repeated point has no length.
	const glm::dvec2 gap = offset - edge * part;
	return gap.x * gap.x + gap.y * gap.y;
}

} // namespace

void Outline::set(std::span<const glm::dvec2> points, bool closed) {
	points_.assign(points.begin(), points.end());
	if (closed || points.size() == 1) {
		points_.push_back(points.front());
	}
	boxes_.clear();
	level_begin_ = {0};
	for (std::size_t begin = 0; begin < edges(); begin += run_edges) {
		Box box{points_[begin], points_[begin]};
		for (std::size_t i = begin + 1; i <= std::min(begin + run_edges, edges()); ++i) {
			box.min = {std::min(box.min.x, points_[i].x), std::min(box.min.y, points_[i].y)};
			box.max = {std::max(box.max.x, points_[i].x), std::max(box.max.y, points_[i].y)};
		}
		boxes_.push_back(box);
	}
	level_begin_.push_back(static_cast<std::uint32_t>(boxes_.size()));
	while (level_begin_.back() - level_begin_[level_begin_.size() - 2] > 1) {
		const std::size_t end = boxes_.size();
		for (std::size_t i = level_begin_[level_begin_.size() - 2]; i < end; i += 2) {
			const Box a = boxes_[i];
			const Box b = boxes_[std::min(i + 1, end - 1)];
			boxes_.push_back({{std::min(a.min.x, b.min.x), std::min(a.min.y, b.min.y)},
					{std::max(a.max.x, b.max.x), std::max(a.max.y, b.max.y)}});
		}
		level_begin_.push_back(static_cast<std::uint32_t>(boxes_.size()));
	}
}

std::size_t Outline::end_of(Run run) const { return std::min(begin_of(run) + (run_edges << run.level), edges()); }

bool Outline::contains(glm::dvec2 place) const {
	Stack<Run> stack;
	stack.push(root());
	bool within = false;
	while (!stack.empty()) {
		const Run run = stack.pop();
		const Box &box = box_of(run);
		if (place.y < box.min.y || place.y > box.max.y || place.x > box.max.x) {
			continue;
		}
		if (place.x < box.min.x) {
			// All of the run lies ahead: an odd number of crossings if it ends on the other side of the ray.
			const bool above_first = place.y < points_[begin_of(run)].y;
			within ^= above_first != (place.y < points_[end_of(run)].y);
		} else if (run.level > 0) {
			const Run first{run.level - 1, run.index * 2};
			const Run second{run.level - 1, run.index * 2 + 1};
			stack.push(first);
			if (has(second)) {
				stack.push(second);
			}
		} else {
			for (std::size_t i = begin_of(run); i < end_of(run); ++i) {
				const Side found = side(points_[i], points_[i + 1], place);
				if (found == Side::on) {
					return false;
				}
				within ^= found == Side::cross;
			}
		}
	}
	return within;
}

double Outline::distance(glm::dvec2 place, double limit) const {
	const auto box_distance2 = [&](Run run) {
		const Box &box = box_of(run);
		const double x = std::max({box.min.x - place.x, place.x - box.max.x, 0.0});
		const double y = std::max({box.min.y - place.y, place.y - box.max.y, 0.0});
		return x * x + y * y;
	};
	using Candidate = std::pair<Run, double>;
	Stack<Candidate> stack;
	stack.push({root(), box_distance2(root())});
	double nearest2 = limit * limit;
	bool found = false;
	while (!stack.empty()) {
		const auto [run, run_distance2] = stack.pop();
		if (run_distance2 >= nearest2) {
			continue;
		}
		if (run.level == 0) {
			for (std::size_t i = begin_of(run); i < end_of(run); ++i) {
				const double distance2 = edge_distance2(points_[i], points_[i + 1], place);
				found = found || distance2 < nearest2;
				nearest2 = std::min(nearest2, distance2);
			}
			continue;
		}
		Candidate near{{run.level - 1, run.index * 2}, 0.0};
		near.second = box_distance2(near.first);
		Candidate far{{run.level - 1, run.index * 2 + 1}, 0.0};
		if (has(far.first)) {
			far.second = box_distance2(far.first);
			if (far.second < near.second) {
				std::swap(near, far);
			}
			stack.push(far);
		}
		stack.push(near);
	}
	return found ? std::sqrt(nearest2) : limit;
}

} // namespace thicket
