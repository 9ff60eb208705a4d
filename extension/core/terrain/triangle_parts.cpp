#include "core/terrain/triangle_parts.hpp"

#include "core/base/bvh_order.hpp"
#include "core/base/guard.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <tuple>
#include <utility>

namespace thicket {

namespace {

/// Returns true if a rectangle contains a position, including its borders, and false for NAN.
bool contains(const Rect &area, glm::dvec2 position) {
	return position.x >= area.min.x && position.x <= area.max.x && position.y >= area.min.y && position.y <= area.max.y;
}

/// Returns true if `a` takes priority over `b` as the ground.
bool is_above(const TriangleTerrain::Top &a, const TriangleTerrain::Top &b) {
	return std::tie(a.height, a.normal.y, a.normal.x, a.normal.z) >
			std::tie(b.height, b.normal.y, b.normal.x, b.normal.z);
}

std::shared_ptr<const Surface> surface_of(std::span<const TriangleParts::Part> parts) {
	std::vector<std::shared_ptr<const Surface>> surfaces;
	for (const TriangleParts::Part &part : parts) {
		surfaces.push_back(TriangleTerrain::surface_of(part));
	}
	return Surface::of_parts(surfaces);
}

} // namespace

Status TriangleParts::set(std::span<const Part> parts) {
	return guarded("parts", static_cast<double>(parts.size()), [&] {
		TriangleParts built;
		std::vector<BvhKey> keys;
		for (std::uint32_t i = 0; i < parts.size(); ++i) {
			const Rect &area = parts[i]->area();
			if (parts[i]->has_ground()) {
				keys.push_back({area.min + area.max, i});
			}
		}
		built.tree_ = Bvh(keys.size());
		put_in_order(built.tree_, keys);
		built.parts_.reserve(keys.size());
		for (const BvhKey &key : keys) {
			built.parts_.push_back(parts[key.item]);
		}
		built.boxes_.resize(built.tree_.nodes());
		built.tree_.each([&](Bvh::Node node) {
			Box &box = built.boxes_[built.tree_.index_of(node)];
			box = {built.parts_[built.tree_.begin(node)]->area(), built.parts_[built.tree_.begin(node)]->top()};
			for (std::size_t i = built.tree_.begin(node) + 1; i < built.tree_.end(node); ++i) {
				const Rect &area = built.parts_[i]->area();
				box.area = united(box.area, area);
				box.top = std::max(box.top, built.parts_[i]->top());
			}
		});
		built.surface_ = surface_of(parts);
		*this = std::move(built);
	});
}

Status TriangleParts::sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const {
	if (positions.size() != r_ground.size()) {
		return Status::wrong_size("ground", r_ground.size(), exactly(positions.size()));
	}
	for (std::size_t i = 0; i < positions.size(); ++i) {
		r_ground[i] = ground_at(positions[i]);
	}
	return {};
}

Ground TriangleParts::ground_at(glm::dvec2 position) const {
	bool found = false;
	TriangleTerrain::Top best{-std::numeric_limits<double>::infinity(), {}};
	BvhStack<Bvh::Node> stack;
	const auto push = [&](Bvh::Node node) {
		const Box &box = boxes_[tree_.index_of(node)];
		if (!contains(box.area, position) || box.top < best.height) {
			// No part of the node covers the position, or all parts are lower than the best one.
			return;
		}
		stack.push(node);
	};
	if (!tree_.empty()) {
		push(tree_.root());
	}
	while (!stack.empty()) {
		const Bvh::Node node = stack.pop();
		if (boxes_[tree_.index_of(node)].top < best.height) {
			// A higher part was found after the node was pushed.
			continue;
		}
		if (node.level > 0) {
			if (tree_.has_second(node)) {
				push(tree_.second(node));
			}
			push(tree_.first(node));
			continue;
		}
		for (std::size_t i = tree_.begin(node); i < tree_.end(node); ++i) {
			if (!contains(parts_[i]->area(), position)) {
				// No triangle of the part covers the position.
				continue;
			}
			TriangleTerrain::Top top;
			if (parts_[i]->find_top(position, best.height, top) && (!found || is_above(top, best))) {
				best = top;
				found = true;
			}
		}
	}
	return found ? Ground{static_cast<float>(best.height), best.normal} : Ground{};
}

} // namespace thicket
