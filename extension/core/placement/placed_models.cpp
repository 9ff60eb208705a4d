#include "core/placement/placed_models.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace thicket {

namespace {

/// The margin of a search is the sum of `search_margin`, in meters, and of `search_share` times the
/// largest coordinate. It exceeds the rounding errors of transforms.
constexpr double search_margin = 1e-6;
constexpr double search_share = 1e-12;

glm::dmat3 absolute(const glm::dmat3 &basis) { return {glm::abs(basis[0]), glm::abs(basis[1]), glm::abs(basis[2])}; }

/// Returns the bounds of a box after a linear transform.
Box3 transformed(const Box3 &box, const glm::dmat3 &basis) {
	const glm::dvec3 center = basis * (0.5 * (box.min + box.max));
	const glm::dvec3 half = absolute(basis) * (0.5 * (box.max - box.min));
	return {center - half, center + half};
}

/// Returns the margin of a search near a box, in meters.
double margin_at(const Box3 &box) {
	const glm::dvec3 farthest = glm::max(glm::abs(box.min), glm::abs(box.max));
	return search_margin + search_share * std::max(farthest.x, std::max(farthest.y, farthest.z));
}

} // namespace

Box3 PlacedModels::bounds_of(const Part &part) {
	const double volume = glm::determinant(part.instance.basis);
	if (!std::isfinite(1.0 / volume) || is_empty(part.model->bounds())) {
		return no_box;
	}
	const Box3 box = transformed(part.model->bounds(), part.instance.basis);
	const Box3 placed{box.min + part.instance.position, box.max + part.instance.position};
	const double margin = margin_at(placed);
	return {placed.min - margin, placed.max + margin};
}

PlacedModels::PlacedModels(const std::vector<Part> &parts, const Box3 &around) {
	std::vector<Box3> boxes;
	std::size_t end = 0;
	for (const Part &part : parts) {
		const glm::dmat3 &basis = part.instance.basis;
		boxes.push_back(bounds_of(part));
		parts_.push_back({part.model, part.instance.position, basis, glm::inverse(basis), glm::determinant(basis) < 0.0,
				boxes.back()});
		ends_.push_back(end += part.model->triangle_count());
	}
	tree_ = BoxTree(boxes);
	bounds_ = parts.empty() ? no_box : with(tree_.bounds(), around);
}

std::array<glm::dvec3, 3> PlacedModels::Placed::triangle(std::uint32_t index) const {
	std::array<glm::dvec3, 3> corners = model->triangle(index);
	for (glm::dvec3 &corner : corners) {
		corner = position + basis * corner;
	}
	if (mirrored) {
		std::swap(corners[1], corners[2]); // Mirroring would otherwise swap front and back.
	}
	return corners;
}

/// Returns a box in the model's space that contains a box in world space, with a margin.
Box3 PlacedModels::Placed::to_model(const Box3 &box) const {
	const double margin = margin_at(box) + margin_at(bounds);
	return transformed({box.min - position - margin, box.max - position + margin}, inverse);
}

std::array<glm::dvec3, 3> PlacedModels::triangle(std::uint32_t index) const {
	const auto part = static_cast<std::size_t>(std::ranges::upper_bound(ends_, index) - ends_.begin());
	return parts_[part].triangle(index - static_cast<std::uint32_t>(part == 0 ? 0 : ends_[part - 1]));
}

void PlacedModels::find(const Box3 &box, std::vector<std::uint32_t> &r_triangles) const {
	r_triangles.clear();
	std::vector<std::uint32_t> near_parts;
	tree_.find(box, [&](std::uint32_t part) { return parts_[part].bounds; }, near_parts);
	std::vector<std::uint32_t> triangles;
	for (const std::uint32_t part : near_parts) {
		const Placed &placed = parts_[part];
		const auto first = static_cast<std::uint32_t>(part == 0 ? 0 : ends_[part - 1]);
		placed.model->find(placed.to_model(box), triangles);
		for (const std::uint32_t index : triangles) {
			const auto [a, b, c] = placed.triangle(index);
			if (touch(with(with(Box3{a, a}, b), c), box)) {
				r_triangles.push_back(first + index);
			}
		}
	}
}

} // namespace thicket
