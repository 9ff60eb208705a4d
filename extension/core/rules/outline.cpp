#include "core/rules/outline.hpp"

#include "core/base/floating_point.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace thicket {

namespace {

enum class Side : std::uint8_t {
	none,  ///< The ray from the position in the +x direction misses the edge.
	cross, ///< The ray crosses the edge.
	on,    ///< The position lies on the edge.
};

/// Tests whether the ray from `position` in the +x direction crosses an edge. An edge includes its
/// lower end and excludes its upper end, so that a ray through a corner counts the correct number
/// of crossings.
Side side(glm::dvec2 a, glm::dvec2 b, glm::dvec2 position) {
	// The ends are sorted, so that both directions of an edge produce the same result.
	if (b.y < a.y || (b.y == a.y && b.x < a.x)) {
		std::swap(a, b);
	}
	if (position.y < a.y || position.y > b.y || position.x > std::max(a.x, b.x)) {
		return Side::none;
	}
	if (position.x >= std::min(a.x, b.x)) {
		const double left = (b.x - a.x) * (position.y - a.y) - (b.y - a.y) * (position.x - a.x);
		if (left == 0.0) {
			return Side::on;
		}
		if (left < 0.0) {
			return Side::none;
		}
	}
	return position.y < b.y ? Side::cross : Side::none;
}

double edge_distance2(glm::dvec2 a, glm::dvec2 b, glm::dvec2 position) {
	const glm::dvec2 edge = b - a;
	const glm::dvec2 offset = position - a;
	const double length2 = edge.x * edge.x + edge.y * edge.y;
	const double along = offset.x * edge.x + offset.y * edge.y;
	// A repeated point yields an edge of length 0.
	const double part = length2 > 0.0 ? std::clamp(along / length2, 0.0, 1.0) : 0.0;
	const glm::dvec2 gap = offset - edge * part;
	return gap.x * gap.x + gap.y * gap.y;
}

} // namespace

void Outline::set(std::span<const glm::dvec2> points, bool closed) {
	points_.assign(points.begin(), points.end());
	if (closed || points.size() == 1) {
		points_.push_back(points.front());
	}
	edge_tree_ = Bvh(edges());
	boxes_.resize(edge_tree_.nodes());
	edge_tree_.each([&](Bvh::Node node) {
		Box &box = boxes_[edge_tree_.index_of(node)];
		if (node.level == 0) {
			box = {points_[edge_tree_.begin(node)], points_[edge_tree_.begin(node)]};
			for (std::size_t i = edge_tree_.begin(node) + 1; i <= edge_tree_.end(node); ++i) {
				box = around(box, {points_[i], points_[i]});
			}
		} else {
			box = boxes_[edge_tree_.index_of(edge_tree_.first(node))];
			if (edge_tree_.has_second(node)) {
				box = around(box, boxes_[edge_tree_.index_of(edge_tree_.second(node))]);
			}
		}
	});
}

Outline::Box Outline::around(const Box &a, const Box &b) {
	return {{std::min(a.min.x, b.min.x), std::min(a.min.y, b.min.y)},
			{std::max(a.max.x, b.max.x), std::max(a.max.y, b.max.y)}};
}

bool Outline::contains(glm::dvec2 position) const {
	BvhStack<Bvh::Node> stack;
	stack.push(edge_tree_.root());
	bool within = false;
	while (!stack.empty()) {
		const Bvh::Node node = stack.pop();
		const Box &box = boxes_[edge_tree_.index_of(node)];
		if (position.y < box.min.y || position.y > box.max.y || position.x > box.max.x) {
			// The ray from the position misses the whole node.
			continue;
		}
		if (position.x < box.min.x) {
			// The whole node lies ahead. The ray crosses it an odd number of times if the two ends
			// of its line are on different sides of the ray.
			const bool above_first = position.y < points_[edge_tree_.begin(node)].y;
			within ^= above_first != (position.y < points_[edge_tree_.end(node)].y);
		} else if (node.level > 0) {
			stack.push(edge_tree_.first(node));
			if (edge_tree_.has_second(node)) {
				stack.push(edge_tree_.second(node));
			}
		} else {
			for (std::size_t i = edge_tree_.begin(node); i < edge_tree_.end(node); ++i) {
				const Side found = side(points_[i], points_[i + 1], position);
				if (found == Side::on) {
					return false;
				}
				within ^= found == Side::cross;
			}
		}
	}
	return within;
}

double Outline::distance(glm::dvec2 position, double limit) const {
	const auto box_distance2 = [&](Bvh::Node node) {
		const Box &box = boxes_[edge_tree_.index_of(node)];
		const double x = std::max({box.min.x - position.x, position.x - box.max.x, 0.0});
		const double y = std::max({box.min.y - position.y, position.y - box.max.y, 0.0});
		return x * x + y * y;
	};
	using Candidate = std::pair<Bvh::Node, double>;
	BvhStack<Candidate> stack;
	stack.push({edge_tree_.root(), box_distance2(edge_tree_.root())});
	double nearest2 = limit * limit;
	bool found = false;
	while (!stack.empty()) {
		const auto [node, node_distance2] = stack.pop();
		if (node_distance2 >= nearest2) {
			// An edge cannot be nearer than its bounding box.
			continue;
		}
		if (node.level == 0) {
			for (std::size_t i = edge_tree_.begin(node); i < edge_tree_.end(node); ++i) {
				const double distance2 = edge_distance2(points_[i], points_[i + 1], position);
				found = found || distance2 < nearest2;
				nearest2 = std::min(nearest2, distance2);
			}
			continue;
		}
		Candidate near{edge_tree_.first(node), box_distance2(edge_tree_.first(node))};
		if (edge_tree_.has_second(node)) {
			Candidate far{edge_tree_.second(node), box_distance2(edge_tree_.second(node))};
			if (far.second < near.second) {
				// The nearer half is visited first, because it may rule out the other half.
				std::swap(near, far);
			}
			stack.push(far);
		}
		stack.push(near);
	}
	return found ? std::sqrt(nearest2) : limit;
}

} // namespace thicket
