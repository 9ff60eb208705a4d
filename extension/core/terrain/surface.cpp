#include "core/terrain/surface.hpp"

#include "core/base/guard.hpp"
#include "core/base/lazy.hpp"
#include "core/terrain/box_tree.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>
#include <utility>

namespace thicket {

namespace {

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
	if (indices.size() / 3 > Surface::max_triangles / 3) {
		return Status::wrong_size("indices", indices.size(), at_most(Surface::max_triangles));
	}
	for (const std::uint32_t index : indices) {
		if (index >= vertices.size()) {
			return Status::out_of_range(
					"indices", index, between(0, static_cast<double>(vertices.size()) - 1.0, "the last vertex"));
		}
	}
	return {};
}

/// A surface whose triangles share vertices.
class IndexedSurface final : public Surface {
public:
	IndexedSurface(std::vector<glm::dvec3> vertices, std::vector<std::uint32_t> indices) :
			vertices_(std::move(vertices)), indices_(std::move(indices)),
			tree_(IndexedSurface::triangle_count(), [this](std::uint32_t index) { return triangle_bounds(index); }) {}

	std::size_t triangle_count() const override { return indices_.size() / 3; }

	std::array<glm::dvec3, 3> triangle(std::uint32_t index) const override {
		const std::size_t first = std::size_t{index} * 3;
		return {vertices_[indices_[first]], vertices_[indices_[first + 1]], vertices_[indices_[first + 2]]};
	}

	const Box3 &bounds() const override { return tree_.bounds(); }

	void find(const Box3 &box, std::vector<std::uint32_t> &r_triangles) const override {
		tree_.find(box, [this](std::uint32_t index) { return triangle_bounds(index); }, r_triangles);
	}

private:
	std::vector<glm::dvec3> vertices_;
	std::vector<std::uint32_t> indices_;
	BoxTree tree_;
};

/// An order of surfaces that depends only on their triangles.
bool comes_before(const Surface &a, const Surface &b) {
	const auto key = [](const Surface &surface) {
		const auto &[min, max] = surface.bounds();
		return std::tuple(min.x, min.z, min.y, max.x, max.z, max.y, surface.triangle_count());
	};
	if (&a == &b || key(a) != key(b)) {
		return key(a) < key(b);
	}
	for (std::uint32_t index = 0; index < a.triangle_count(); ++index) {
		const auto corners_a = a.triangle(index);
		const auto corners_b = b.triangle(index);
		for (std::size_t corner = 0; corner < corners_a.size(); ++corner) {
			const glm::dvec3 &here = corners_a[corner];
			const glm::dvec3 &there = corners_b[corner];
			if (here != there) {
				return std::tie(here.x, here.y, here.z) < std::tie(there.x, there.y, there.z);
			}
		}
	}
	return false;
}

/// Several surfaces. Their triangles are numbered one part after the other. The numbers do not
/// depend on the order of the arguments, because the first of two coincident triangles is used.
class JoinedSurface final : public Surface {
public:
	explicit JoinedSurface(std::vector<Part> parts) : parts_(std::move(parts)) {
		for (const Part &part : parts_) {
			count_ += part->triangle_count();
		}
	}

	std::size_t triangle_count() const override { return count_; }

	std::array<glm::dvec3, 3> triangle(std::uint32_t index) const override {
		const Numbered &numbered = numbers();
		const auto part =
				static_cast<std::size_t>(std::ranges::upper_bound(numbered.ends, index) - numbered.ends.begin());
		return numbered.parts[part]->triangle(index - numbered.first_of(part));
	}

	const Box3 &bounds() const override { return numbers().tree.bounds(); }

	void find(const Box3 &box, std::vector<std::uint32_t> &r_triangles) const override {
		const Numbered &numbered = numbers();
		r_triangles.clear();
		std::vector<std::uint32_t> found;
		numbered.tree.find(box, [&](std::uint32_t part) {
			numbered.parts[part]->find(box, found);
			for (const std::uint32_t index : found) {
				r_triangles.push_back(numbered.first_of(part) + index);
			}
		});
		std::ranges::sort(r_triangles);
	}

private:
	/// The parts in order, and a tree over those that have triangles, which come first.
	struct Numbered {
		std::vector<const Surface *> parts;
		std::vector<std::size_t> ends; ///< For each part, the number of triangles up to its end.
		BoxTree tree;

		std::uint32_t first_of(std::size_t part) const {
			return part == 0 ? 0 : static_cast<std::uint32_t>(ends[part - 1]);
		}
	};

	/// Computed for the first search, because computing the bounds of a large part takes time.
	const Numbered &numbers() const {
		return numbered_.get([this] {
			Numbered numbered;
			std::ranges::transform(parts_, std::back_inserter(numbered.parts), &Part::get);
			std::ranges::sort(numbered.parts, [](const Surface *a, const Surface *b) { return comes_before(*a, *b); });
			std::vector<Box3> boxes;
			std::size_t end = 0;
			for (const Surface *part : numbered.parts) {
				numbered.ends.push_back(end += part->triangle_count());
				if (!is_empty(part->bounds())) {
					boxes.push_back(part->bounds());
				}
			}
			numbered.tree = BoxTree(boxes);
			return numbered;
		});
	}

	std::vector<Part> parts_;
	std::size_t count_ = 0;
	Lazy<Numbered> numbered_;
};

} // namespace

Status Surface::create(std::vector<glm::dvec3> vertices, std::vector<std::uint32_t> indices,
		std::shared_ptr<const Surface> &r_surface) {
	if (const Status status = validate(vertices, indices); !status.ok()) {
		return status;
	}
	return guarded("triangles", static_cast<double>(indices.size() / 3),
			[&] { r_surface = std::make_shared<const IndexedSurface>(std::move(vertices), std::move(indices)); });
}

std::shared_ptr<const Surface> Surface::of_parts(std::span<const Part> parts) {
	return std::make_shared<const JoinedSurface>(std::vector<Part>(parts.begin(), parts.end()));
}

Box3 Surface::triangle_bounds(std::uint32_t index) const {
	const auto [a, b, c] = triangle(index);
	return with(with(Box3{a, a}, b), c);
}

glm::dvec3 Surface::cross(std::uint32_t index) const {
	const auto [a, b, c] = triangle(index);
	return glm::cross(b - a, c - a);
}

double Surface::triangle_area(std::uint32_t index) const { return glm::length(cross(index)) * 0.5; }

double Surface::area() const {
	double area = 0.0;
	for (std::uint32_t index = 0; index < triangle_count(); ++index) {
		area += triangle_area(index);
	}
	return area;
}

} // namespace thicket
