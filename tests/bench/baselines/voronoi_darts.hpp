#pragma once

#include "tests/bench/baselines/free_cell.hpp"
#include "tests/bench/baselines/sum_tree.hpp"
#include "tests/bench/common/random.hpp"

#include <glm/common.hpp>
#include <glm/vec2.hpp>

// CGAL's predicates use doubles, and exact numbers if doubles cannot decide. CGAL's own number
// types suffice for that, so no library is linked. CGAL's assertions are disabled, because they
// would distort benchmarks of the debug build.
#define CGAL_DISABLE_GMP 1
#define CGAL_NDEBUG 1
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Periodic_2_Delaunay_triangulation_2.h>
#include <CGAL/Periodic_2_Delaunay_triangulation_traits_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace thicket::bench {

/// Jones, "Efficient generation of Poisson-disk sampling patterns" (2006), on the torus [0,
/// side)^2, in double precision. The method maintains the Voronoi diagram of the growing set, and
/// the area of every cell outside its own disk. Each dart chooses a cell with a probability
/// proportional to that area, and then a uniform position in that part of the cell. Darts are
/// therefore uniform over all free positions, and the sets are maximal and have the distribution of
/// dart throwing. The method takes O(n log n) time and about 200 bytes per point.
///
/// The diagram is CGAL's periodic Delaunay triangulation, which finds a new dart's triangle in a
/// few steps from the chosen cell. The paper throws darts into the triangles of a cell's fan until
/// one misses the disk. This implementation draws directly from the free part (`FreeCell`), which
/// results in the same distribution with less work.
class VoronoiDarts {
public:
	/// Replaces `r_points` with a set in which no two points are closer than 1 and every position
	/// of the torus has a point within 1 + `FreeCell::tolerance`. `side` >= 4.
	void sample(double side, std::uint64_t seed, std::vector<glm::dvec2> &r_points) {
		side_ = side;
		Xoroshiro random(seed);
		triangulation_.emplace(Triangulation::Iso_rectangle(0.0, 0.0, side, side));
		vertices_.clear();
		weights_.reset(static_cast<std::size_t>(max_points * side * side) + 1);
		r_points.clear();
		const double x = FreeCell::unit(random) * side;
		const double y = FreeCell::unit(random) * side;
		add({wrap(x), wrap(y)}, Triangulation::Face_handle(), r_points);
		while (weights_.total() > 0.0) {
			const Vertex vertex = vertices_[weights_.find(FreeCell::unit(random) * weights_.total())];
			visit_vertex(vertex);
			const glm::dvec2 fallen = r_points[vertex->info()] + cell_.draw(random);
			const glm::dvec2 dart(wrap(fallen.x), wrap(fallen.y));
			if (keeps_distance(dart, r_points[vertex->info()], r_points)) {
				add(dart, vertex->face(), r_points);
			}
		}
		triangulation_.reset();
	}

private:
	using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
	using Traits = CGAL::Periodic_2_Delaunay_triangulation_traits_2<Kernel>;
	using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Traits,
			CGAL::Periodic_2_triangulation_vertex_base_2<Traits>>;
	using Structure =
			CGAL::Triangulation_data_structure_2<VertexBase, CGAL::Periodic_2_triangulation_face_base_2<Traits>>;
	using Triangulation = CGAL::Periodic_2_Delaunay_triangulation_2<Traits, Structure>;
	using Vertex = Triangulation::Vertex_handle;

	/// The maximum number of points at distance 1 per unit of area. Disks of diameter 1 cover the
	/// most in a hexagonal lattice.
	static constexpr double max_points = 1.1547006;

	double side_ = 0.0;
	std::optional<Triangulation> triangulation_;
	/// The triangulation's vertices, indexed like the points. The index is also stored in the
	/// vertex's info.
	std::vector<Vertex> vertices_;
	SumTree weights_; ///< The free areas of all cells.

	// The last computed cell.
	FreeCell cell_;
	std::vector<glm::dvec2> around_;
	std::vector<Vertex> neighbors_;
	std::vector<Vertex> changed_; ///< The neighbors of the last added point.

	/// Wraps a coordinate that is at most one side outside the torus.
	double wrap(double coordinate) const {
		const double wrapped = coordinate < 0.0 ? coordinate + side_ : coordinate;
		const double wrapped_once = wrapped < side_ ? wrapped : wrapped - side_;
		return wrapped_once < side_ ? wrapped_once : 0.0;
	}

	/// Finds a point's neighbors and computes its cell. While there are few points, the
	/// triangulation covers nine copies of the torus. A neighbor may then be a copy, even of the
	/// point itself, and is replaced with the original in `vertices_`.
	void visit_vertex(Vertex vertex) {
		around_.clear();
		neighbors_.clear();
		const auto first = triangulation_->incident_faces(vertex);
		auto face = first;
		do {
			const int vertex_index = face->index(vertex);
			const int next_index = Triangulation::ccw(vertex_index);
			const auto [from, from_copy] = triangulation_->periodic_point(face, vertex_index);
			const auto [to, to_copy] = triangulation_->periodic_point(face, next_index);
			around_.emplace_back(to.x() - from.x() + (to_copy.x() - from_copy.x()) * side_,
					to.y() - from.y() + (to_copy.y() - from_copy.y()) * side_);
			neighbors_.push_back(triangulation_->get_original_vertex(face->vertex(next_index)));
		} while (++face != first);
		cell_.assign(around_);
	}

	/// Returns false for a dart that rounding has moved from the edge of a free part into the disk
	/// of its cell's point or, in a corner, of a neighbor. Such a dart is discarded.
	bool keeps_distance(glm::dvec2 dart, glm::dvec2 site, const std::vector<glm::dvec2> &points) const {
		const auto far_enough = [&](glm::dvec2 point) {
			const glm::dvec2 straight = point - dart;
			const glm::dvec2 shortest = straight - side_ * glm::round(straight / side_);
			return shortest.x * shortest.x + shortest.y * shortest.y >= 1.0;
		};
		return far_enough(site) && std::all_of(neighbors_.begin(), neighbors_.end(), [&](Vertex neighbor) {
			return far_enough(points[neighbor->info()]);
		});
	}

	/// Adds a point in or near the triangle `near`, and updates its cell and those of its
	/// neighbors. No other cells change.
	void add(glm::dvec2 point, Triangulation::Face_handle hint, std::vector<glm::dvec2> &r_points) {
		const Vertex vertex = triangulation_->insert({point.x, point.y}, hint);
		vertex->info() = static_cast<std::uint32_t>(r_points.size());
		vertices_.push_back(vertex);
		r_points.push_back(point);
		visit_vertex(vertex);
		weights_.set(vertex->info(), cell_.area());
		changed_ = neighbors_;
		for (const Vertex neighbor : changed_) {
			visit_vertex(neighbor);
			weights_.set(neighbor->info(), cell_.area());
		}
	}
};

} // namespace thicket::bench
