#include "core/terrain/triangle_terrain.hpp"

#include "core/base/bvh_order.hpp"
#include "core/base/check.hpp"
#include "core/base/floating_point.hpp"
#include "core/base/guard.hpp"
#include "core/base/orientation.hpp"
#include "core/base/progress.hpp"

#include <glm/geometric.hpp>

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

bool has_area(const std::array<glm::dvec3, 3> &corners) {
	return glm::cross(corners[1] - corners[0], corners[2] - corners[0]) != glm::dvec3(0.0);
}

Status check_corner(glm::dvec3 corner) {
	const auto check = [](double coordinate) {
		return check_range("corners", coordinate, -TriangleTerrain::max_extent, TriangleTerrain::max_extent);
	};
	return first_failure(check(corner.x), check(corner.y), check(corner.z));
}

Status check_corners(std::span<const glm::dvec3> corners) {
	if (corners.size() % 3 != 0) {
		return Status::wrong_size("corners", corners.size(), at_least(0, "a multiple of 3: three per triangle"));
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
			return std::abs(coordinate) <= max_extent; // The result is false for NAN.
		};
		return !(fits(corner.x) && fits(corner.y) && fits(corner.z));
	};
	return static_cast<std::size_t>(std::ranges::find_if(corners, is_refused) - corners.begin());
}

/// All triangles of a terrain; the vertical ones come last.
class TriangleTerrain::AllTriangles final : public Surface {
public:
	explicit AllTriangles(std::shared_ptr<const TriangleTerrain> terrain) : terrain_(std::move(terrain)) {}

	std::size_t triangle_count() const override { return terrain_->triangles_.size() + terrain_->vertical_.size(); }

	std::array<glm::dvec3, 3> triangle(std::uint32_t index) const override {
		const std::size_t non_vertical_count = terrain_->triangles_.size();
		const auto &[a, b, c] = index < non_vertical_count ? terrain_->triangles_[index].corners
														   : terrain_->vertical_[index - non_vertical_count];
		return terrain_->winding_ == Winding::clockwise ? std::array{a, c, b} : std::array{a, b, c};
	}

	const Box3 &bounds() const override { return terrain_->bounds_; }

	void find(const Box3 &box, std::vector<std::uint32_t> &r_triangles) const override {
		tree().find(box, [this](std::uint32_t index) { return triangle_bounds(index); }, r_triangles);
	}

private:
	const BoxTree &tree() const {
		return terrain_->surface_tree_->get(
				[this] { return BoxTree(triangle_count(), [this](auto index) { return triangle_bounds(index); }); });
	}

	std::shared_ptr<const TriangleTerrain> terrain_;
};

std::shared_ptr<const Surface> TriangleTerrain::surface_of(std::shared_ptr<const TriangleTerrain> terrain) {
	return std::make_shared<const AllTriangles>(std::move(terrain));
}

Status TriangleTerrain::set(std::span<const glm::dvec3> corners, const std::atomic<bool> *cancel, Winding winding) {
	if (const Status status = check_corners(corners); !status.ok()) {
		return status;
	}
	return guarded("corners", static_cast<double>(corners.size()), [&] {
		TriangleTerrain built;
		built.winding_ = winding;
		built.surface_tree_ = std::make_shared<const Lazy<BoxTree>>();
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
	std::vector<BvhKey> keys; // Sorted by three times the centers of the triangles.
	keys.reserve(corners.size() / 3);
	for (std::uint32_t i = 0; i < corners.size() / 3; ++i) {
		const auto &[a, b, c] = triangle(i).corners;
		if (area_from_above({a, b, c}) != 0.0) {
			keys.push_back({from_above(a) + from_above(b) + from_above(c), i});
		} else if (has_area(triangle(i).corners)) {
			vertical_.push_back(triangle(i).corners);
		} else {
			continue;
		}
		bounds_ = with(with(with(bounds_, a), b), c);
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

bool TriangleTerrain::find_top(glm::dvec2 position, double min_height, Top &r_top) const {
	Hit hit{nullptr, min_height};
	BvhStack<Bvh::Node> stack;
	const auto push = [&](Bvh::Node node) {
		if (!boxes_[tree_.index_of(node)].contains(position)) {
			// No triangle of the node covers the position.
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
				// The higher child is visited first, because the other child may then be skipped.
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

/// Replaces `r_hit` with the triangle if the triangle covers `position` and is higher there.
void TriangleTerrain::meet(const Triangle &triangle, glm::dvec2 position, Hit &r_hit) {
	const auto &[a, b, c] = triangle.corners;
	// The weight of a corner is the area of the triangle between the position and the other two
	// corners.
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
	// The normal is computed from projected areas instead of a cross product, which would be
	// inaccurate for narrow triangles.
	const auto area_along = [&](int x, int y) {
		return orientation(
				{corners[0][x], corners[0][y]}, {corners[1][x], corners[1][y]}, {corners[2][x], corners[2][y]});
	};
	glm::dvec3 normal(area_along(1, 2), area_along(2, 0), area_along(0, 1));
	const double longest = std::max({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)});
	normal /= normal.y < 0.0 ? -longest : longest; // This avoids underflow for tiny triangles.
	const double to_unit = 1.0 / std::sqrt(normal.x * normal.x + normal.y * normal.y + normal.z * normal.z);
	return glm::vec3(normal * to_unit);
}

} // namespace thicket
