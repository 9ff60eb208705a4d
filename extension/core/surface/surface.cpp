#include "core/surface/surface.hpp"

#include "core/base/bvh_order.hpp"
#include "core/base/guard.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace thicket {

namespace {

constexpr Box3 no_box{
		glm::dvec3(std::numeric_limits<double>::infinity()), glm::dvec3(-std::numeric_limits<double>::infinity())};

Box3 with(const Box3 &box, const glm::dvec3 &position) {
	return {glm::min(box.min, position), glm::max(box.max, position)};
}

bool touch(const Box3 &a, const Box3 &b) {
	return glm::all(glm::lessThanEqual(a.min, b.max)) && glm::all(glm::lessThanEqual(b.min, a.max));
}

Status validate(std::span<const glm::dvec3> vertices, std::span<const std::uint32_t> indices) {
	for (const glm::dvec3 &vertex : vertices) {
		for (int side = 0; side < 3; ++side) {
			if (!std::isfinite(vertex[side])) {
				return {ErrorCode::not_finite, "vertices", vertex[side]};
			}
		}
	}
	if (indices.size() % 3 != 0) {
		return Status::wrong_size("indices", indices.size(), exactly(indices.size() / 3 * 3, "3 for each triangle"));
	}
	if (indices.size() / 3 > std::numeric_limits<std::uint32_t>::max() / 3) {
		return Status::wrong_size("indices", indices.size(), at_most(std::numeric_limits<std::uint32_t>::max()));
	}
	for (const std::uint32_t index : indices) {
		if (index >= vertices.size()) {
			return Status::out_of_range(
					"indices", index, between(0, static_cast<double>(vertices.size()) - 1.0, "the last vertex"));
		}
	}
	return {};
}

} // namespace

Status Surface::create(std::vector<glm::dvec3> vertices, std::vector<std::uint32_t> indices,
		std::shared_ptr<const Surface> &r_surface) {
	if (const Status status = validate(vertices, indices); !status.ok()) {
		return status;
	}
	return guarded("triangles", static_cast<double>(indices.size() / 3), [&] {
		const std::shared_ptr<Surface> made(new Surface);
		made->vertices_ = std::move(vertices);
		made->indices_ = std::move(indices);
		made->sort();
		r_surface = made;
	});
}

std::array<glm::dvec3, 3> Surface::triangle(std::uint32_t index) const {
	const std::size_t first = std::size_t{index} * 3;
	return {vertices_[indices_[first]], vertices_[indices_[first + 1]], vertices_[indices_[first + 2]]};
}

Box3 Surface::triangle_bounds(std::uint32_t index) const {
	const auto [a, b, c] = triangle(index);
	return with(with(with(no_box, a), b), c);
}

glm::dvec3 Surface::cross(std::uint32_t index) const {
	const auto [a, b, c] = triangle(index);
	return glm::cross(b - a, c - a);
}

double Surface::triangle_area(std::uint32_t index) const { return glm::length(cross(index)) * 0.5; }

void Surface::sort() {
	const std::size_t count = triangle_count();
	std::vector<BvhKey> keys(count);
	for (std::uint32_t index = 0; index < count; ++index) {
		const Box3 bounds = triangle_bounds(index);
		const glm::dvec3 middle = bounds.min + (bounds.max - bounds.min) * 0.5;
		keys[index] = {{middle.x, middle.z}, index};
		area_ += triangle_area(index);
	}
	tree_ = Bvh(count);
	put_in_order(tree_, keys);
	order_.resize(count);
	std::ranges::transform(keys, order_.begin(), &BvhKey::item);
	node_bounds_.resize(tree_.nodes());
	tree_.each([this](Bvh::Node node) {
		Box3 bounds = no_box;
		if (node.level == 0) {
			for (std::size_t at = tree_.begin(node); at < tree_.end(node); ++at) {
				const Box3 item = triangle_bounds(order_[at]);
				bounds = with(with(bounds, item.min), item.max);
			}
		} else {
			const Box3 &first = node_bounds_[tree_.index_of(tree_.first(node))];
			bounds = first;
			if (tree_.has_second(node)) {
				const Box3 &second = node_bounds_[tree_.index_of(tree_.second(node))];
				bounds = with(with(bounds, second.min), second.max);
			}
		}
		node_bounds_[tree_.index_of(node)] = bounds;
	});
	bounds_ = count > 0 ? node_bounds_[tree_.index_of(tree_.root())] : Box3();
}

void Surface::find(const Box3 &box, std::vector<std::uint32_t> &r_triangles) const {
	r_triangles.clear();
	if (tree_.empty()) {
		return;
	}
	BvhStack<Bvh::Node> left;
	left.push(tree_.root());
	while (!left.empty()) {
		const Bvh::Node node = left.pop();
		if (!touch(node_bounds_[tree_.index_of(node)], box)) {
			continue;
		}
		if (node.level == 0) {
			for (std::size_t at = tree_.begin(node); at < tree_.end(node); ++at) {
				if (touch(triangle_bounds(order_[at]), box)) {
					r_triangles.push_back(order_[at]);
				}
			}
			continue;
		}
		if (tree_.has_second(node)) {
			left.push(tree_.second(node));
		}
		left.push(tree_.first(node));
	}
	std::ranges::sort(r_triangles);
}

} // namespace thicket
