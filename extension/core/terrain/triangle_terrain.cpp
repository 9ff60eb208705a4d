#include "core/terrain/triangle_terrain.hpp"

#include "core/base/bvh_order.hpp"
#include "core/base/check.hpp"
#include "core/base/floating_point.hpp"
#include "core/base/guard.hpp"
#include "core/base/orientation.hpp"
#include "core/base/progress.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace thicket {

namespace {

glm::dvec2 from_above(glm::dvec3 corner) { return {corner.x, corner.z}; }

double area_from_above(const std::array<glm::dvec3, 3> &corners) {
	return orientation(from_above(corners[0]), from_above(corners[1]), from_above(corners[2]));
}

Status check_corner(glm::dvec3 corner) {
	const auto check = [](double coordinate) {
		return check_range("corners", coordinate, -TriangleTerrain::max_extent, TriangleTerrain::max_extent);
	};
	return first_failure(check(corner.x), check(corner.y), check(corner.z));
}

Status check_corners(std::span<const glm::dvec3> corners) {
	if (corners.size() % 3 != 0) {
		return Status::wrong_size("corners", corners.size(), at_least(0, "three a triangle"));
	}
	if (corners.size() / 3 > TriangleTerrain::max_triangles) {
		return Status::out_of_range("triangles", corners.size() / 3, at_most(TriangleTerrain::max_triangles));
	}
	const std::size_t refused = TriangleTerrain::find_refused_corner(corners);
	return refused < corners.size() ? check_corner(corners[refused]) : Status{};
}

} // namespace

std::size_t TriangleTerrain::find_refused_corner(std::span<const glm::dvec3> corners) {
	const auto is_refused = [](glm::dvec3 corner) {
		const auto fits = [](double coordinate) {
			return std::abs(coordinate) <= max_extent; // False for NAN.
		};
		return !(fits(corner.x) && fits(corner.y) && fits(corner.z));
	};
	return static_cast<std::size_t>(std::ranges::find_if(corners, is_refused) - corners.begin());
}

Status TriangleTerrain::set(std::span<const glm::dvec3> corners, const std::atomic<bool> *cancel) {
	if (const Status status = check_corners(corners); !status.ok()) {
		return status;
	}
	return guarded("corners", static_cast<double>(corners.size()), [&] {
		TriangleTerrain built;
		built.take(corners, cancel);
		if (is_cancelled(cancel)) {
			return Status{ErrorCode::cancelled, "corners", 0.0};
		}
		built.build_boxes();
		*this = std::move(built);
		return Status{};
	});
}

void TriangleTerrain::take(std::span<const glm::dvec3> corners, const std::atomic<bool> *cancel) {
	const auto triangle = [&](std::uint32_t index) {
		const std::size_t first = std::size_t{index} * 3;
		return Triangle{{corners[first], corners[first + 1], corners[first + 2]}, index};
	};
	std::vector<BvhKey> keys; // By three times the triangles' centers.
	keys.reserve(corners.size() / 3);
	for (std::uint32_t i = 0; i < corners.size() / 3; ++i) {
		const auto &[a, b, c] = triangle(i).corners;
		if (area_from_above({a, b, c}) != 0.0) {
			keys.push_back({from_above(a) + from_above(b) + from_above(c), i});
		}
	}
	tree_ = Bvh(keys.size());
	put_in_order(tree_, keys, cancel);
	if (is_cancelled(cancel)) {
		return;
	}
	triangles_.reserve(keys.size());
	for (const BvhKey &key : keys) {
		triangles_.push_back(triangle(key.item));
	}
}

void TriangleTerrain::build_boxes() {
	if (tree_.empty()) {
		return;
	}
	boxes_.resize(tree_.nodes());
	tree_.each([&](Bvh::Node node) {
		Box &box = boxes_[tree_.index_of(node)];
		if (node.level == 0) {
			box = around(triangles_[tree_.begin(node)]);
			for (std::size_t i = tree_.begin(node) + 1; i < tree_.end(node); ++i) {
				box = around(box, around(triangles_[i]));
			}
		} else {
			box = boxes_[tree_.index_of(tree_.first(node))];
			if (tree_.has_second(node)) {
				box = around(box, boxes_[tree_.index_of(tree_.second(node))]);
			}
		}
	});
	const Box &all = boxes_[tree_.index_of(tree_.root())];
	area_ = {all.min, all.max};
	top_ = all.top;
}

TriangleTerrain::Box TriangleTerrain::around(const Triangle &triangle) {
	const auto &[a, b, c] = triangle.corners;
	return {{std::min({a.x, b.x, c.x}), std::min({a.z, b.z, c.z})},
			{std::max({a.x, b.x, c.x}), std::max({a.z, b.z, c.z})}, std::max({a.y, b.y, c.y})};
}

TriangleTerrain::Box TriangleTerrain::around(const Box &a, const Box &b) {
	return {{std::min(a.min.x, b.min.x), std::min(a.min.y, b.min.y)},
			{std::max(a.max.x, b.max.x), std::max(a.max.y, b.max.y)}, std::max(a.top, b.top)};
}

Status TriangleTerrain::sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const {
	if (positions.size() != r_ground.size()) {
		return Status::wrong_size("ground", r_ground.size(), exactly(positions.size()));
	}
	Top top;
	for (std::size_t i = 0; i < positions.size(); ++i) {
		const bool found = find_top(positions[i], -std::numeric_limits<double>::infinity(), top);
		r_ground[i] = found ? Ground{static_cast<float>(top.height), top.normal} : Ground{};
	}
	return {};
}

bool TriangleTerrain::find_top(glm::dvec2 position, double least, Top &r_top) const {
	Hit hit{nullptr, least};
	BvhStack<Bvh::Node> stack;
	const auto push = [&](Bvh::Node node) {
		if (!boxes_[tree_.index_of(node)].holds(position)) {
			// No triangle of the node lies above or below the position.
			return;
		}
		stack.push(node);
	};
	if (!tree_.empty()) {
		push(tree_.root());
	}
	while (!stack.empty()) {
		const Bvh::Node node = stack.pop();
		if (boxes_[tree_.index_of(node)].top < hit.height) {
			// The whole node lies below the best triangle.
			continue;
		}
		if (node.level == 0) {
			for (std::size_t i = tree_.begin(node); i < tree_.end(node); ++i) {
				meet(triangles_[i], position, hit);
			}
			continue;
		}
		Bvh::Node first = tree_.first(node);
		if (tree_.has_second(node)) {
			Bvh::Node second = tree_.second(node);
			if (boxes_[tree_.index_of(second)].top > boxes_[tree_.index_of(first)].top) {
				// Visits the higher half first, because it may lie above the whole other half.
				std::swap(first, second);
			}
			push(second);
		}
		push(first);
	}
	if (hit.triangle == nullptr) {
		return false;
	}
	r_top = {hit.height, normal_of(*hit.triangle)};
	return true;
}

/// Keeps the higher of `r_hit` and the triangle, if the triangle lies above or below `position`.
void TriangleTerrain::meet(const Triangle &triangle, glm::dvec2 position, Hit &r_hit) {
	const auto &[a, b, c] = triangle.corners;
	// Each corner's weight at the position: the area of the triangle formed by the position and the other two corners.
	const double part_a = orientation(position, from_above(b), from_above(c));
	const double part_b = orientation(position, from_above(c), from_above(a));
	const double part_c = orientation(position, from_above(a), from_above(b));
	const bool within =
			(part_a >= 0.0 && part_b >= 0.0 && part_c >= 0.0) || (part_a <= 0.0 && part_b <= 0.0 && part_c <= 0.0);
	if (!within) {
		return;
	}
	const double mean = (part_a * a.y + part_b * b.y + part_c * c.y) / (part_a + part_b + part_c);
	const double height = std::clamp(mean, std::min({a.y, b.y, c.y}), std::max({a.y, b.y, c.y}));
	const bool higher = height > r_hit.height ||
			(height == r_hit.height && (r_hit.triangle == nullptr || triangle.index < r_hit.triangle->index));
	if (higher) {
		r_hit = {&triangle, height};
	}
}

glm::vec3 TriangleTerrain::normal_of(const Triangle &triangle) {
	const auto &corners = triangle.corners;
	// Areas along the axes rather than a cross product, which is imprecise for narrow triangles.
	const auto area_along = [&](int x, int y) {
		return orientation(
				{corners[0][x], corners[0][y]}, {corners[1][x], corners[1][y]}, {corners[2][x], corners[2][y]});
	};
	glm::dvec3 normal(area_along(1, 2), area_along(2, 0), area_along(0, 1));
	const double longest = std::max({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)});
	normal /= normal.y < 0.0 ? -longest : longest; // Otherwise the squared areas of a tiny triangle would underflow.
	const double to_unit = 1.0 / std::sqrt(normal.x * normal.x + normal.y * normal.y + normal.z * normal.z);
	return glm::vec3(normal * to_unit);
}

} // namespace thicket
