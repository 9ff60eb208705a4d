// This file samples, paints and compares masks on planets.

#include "core/base/bilinear.hpp"
#include "core/base/check.hpp"
#include "core/base/floating_point.hpp"
#include "core/base/guard.hpp"
#include "core/rules/painted_mask.hpp"
#include "core/rules/painted_mask_brush.hpp"
#include "core/rules/painted_mask_edit.hpp"
#include "core/rules/planet_positions.hpp"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace thicket {

namespace {

/// Returns the cap that a dab covers.
PlanetCap cap_of_dab(double planet_radius, const glm::dvec3 &from_center, double radius) {
	return cap_within(Planet::up(from_center), radius / planet_radius);
}

} // namespace

/// The part of a dab on one face. The tangents of its columns and rows are computed once.
struct PaintedMask::FaceDab {
	FaceDab(const CubeGrid &p_grid, int p_face, double p_planet_radius, const PlanetCap &cap, const Brush &p_brush) :
			grid(p_grid), face(p_face), planet_radius(p_planet_radius), center(cap.middle), brush(p_brush),
			nodes(grid.nodes_in(face, cap)), corner(grid.corner(face)) {
		for (int x = nodes.min.x; x < nodes.max.x; ++x) {
			columns.push_back(grid.tangent(x));
		}
		for (int y = nodes.min.y; y < nodes.max.y; ++y) {
			rows.push_back(grid.tangent(y));
		}
	}

	/// Returns the weight of the dab at a node.
	double weight(glm::ivec2 node) const {
		const auto column = static_cast<std::size_t>(node.x - nodes.min.x);
		const auto row = static_cast<std::size_t>(node.y - nodes.min.y);
		const glm::dvec3 direction = CubeGrid::direction(face, {columns[column], rows[row]});
		return brush_weight(brush, planet_radius * glm::distance(direction, center));
	}

	const CubeGrid &grid;
	int face;
	double planet_radius;
	glm::dvec3 center; ///< Unit vector.
	const Brush &brush;
	PixelRect nodes;   ///< The nodes that the dab may change.
	glm::ivec2 corner; ///< The pixel of node (0, 0).
	std::vector<double> columns;
	std::vector<double> rows;
};

/// Reads the nodes of a face and, beyond its edges, the density of the neighboring faces.
class PaintedMask::FaceReader {
public:
	FaceReader(const PaintedMask &mask, const CubeGrid &grid, int face) : grid_(grid), face_(face), reader_(mask) {}

	/// Returns the value at a node. Nodes may extend beyond the face by less than half of its size.
	std::uint8_t at(int x, int y) {
		if (x >= 0 && y >= 0 && x <= grid_.count() && y <= grid_.count()) {
			return node(face_, x, y);
		}
		const glm::dvec3 direction = CubeGrid::direction(face_, {grid_.tangent(x), grid_.tangent(y)});
		return static_cast<std::uint8_t>(std::floor(value_toward(direction) + 0.5));
	}

	/// Returns the interpolated value in a direction, 0 to 255.
	double value_toward(const glm::dvec3 &from_center) {
		const CubeGrid::Place place = grid_.at(from_center);
		const glm::ivec2 first =
				glm::min(glm::ivec2(static_cast<int>(place.position.x), static_cast<int>(place.position.y)),
						glm::ivec2(grid_.count() - 1));
		const glm::dvec2 part = place.position - glm::dvec2(first);
		const auto at = [&](int x, int y) {
			return node(place.face, first.x + x, first.y + y);
		};
		return bilinear(at(0, 0), at(1, 0), at(0, 1), at(1, 1), part.x, part.y);
	}

private:
	std::uint8_t node(int face, int x, int y) {
		const glm::ivec2 pixel = grid_.pixel(face, {x, y});
		return reader_.at(pixel.x, pixel.y);
	}

	const CubeGrid &grid_;
	int face_;
	Reader reader_;
};

Status PaintedMask::sample_on(const Planet &planet, const PositionBatch &batch, std::span<float> r_density) const {
	if (batch.positions.size() != r_density.size()) {
		return Status::wrong_size("density", r_density.size(), exactly(batch.positions.size()));
	}
	const CubeGrid grid(planet.radius, pixel_size_);
	FaceReader reader(*this, grid, 0);
	for (std::size_t i = 0; i < batch.positions.size(); ++i) {
		const glm::dvec3 from_center = from_planet_center(planet, batch, i);
		r_density[i] = has_direction(from_center)
				? static_cast<float>(reader.value_toward(Planet::up(from_center)) / 255.0)
				: 0.0F;
	}
	return {};
}

double PaintedMask::toward(double planet_radius, const glm::dvec3 &from_center) const {
	const CubeGrid grid(planet_radius, pixel_size_);
	return has_direction(from_center) ? FaceReader(*this, grid, 0).value_toward(Planet::up(from_center)) / 255.0 : 0.0;
}

Status PaintedMask::paint_on(double planet_radius, const glm::dvec3 &from_center, const Brush &brush, bool &r_changed) {
	const bool has_center = has_direction(from_center) && glm::dot(from_center, from_center) > 0.0;
	if (const Status status = first_failure(check_brush(brush), check_positive("planet_radius", planet_radius),
				has_center ? Status() : Status::missing("from_center", "Use a finite position that is not the center"));
			!status.ok()) {
		return status;
	}
	const CubeGrid grid(planet_radius, pixel_size_);
	const PlanetCap cap = cap_of_dab(planet_radius, from_center, brush.radius);
	return guarded("radius", brush.radius, [&] {
		PaintedMask painted = *this; // The mask is unchanged if memory runs out, and smoothing reads it.
		bool changed = false;
		for (int face = 0; face < CubeGrid::faces; ++face) {
			const FaceDab dab(grid, face, planet_radius, cap, brush);
			changed = painted.paint_face(dab, *this) || changed;
		}
		*this = std::move(painted);
		r_changed = changed;
	});
}

/// Paints the part of a dab on one face. `before` is the mask before the dab. Returns true if any pixel
/// has changed.
bool PaintedMask::paint_face(const FaceDab &dab, const PaintedMask &before) {
	const PixelRect &nodes = dab.nodes;
	if (nodes.empty()) {
		// The dab does not touch this face.
		return false;
	}
	Edit edit(*this);
	const auto apply = [&](const auto &target) {
		edit.apply({dab.corner + nodes.min, dab.corner + nodes.max}, [&](int x, int y, std::uint8_t value) {
			const glm::ivec2 node = glm::ivec2(x, y) - dab.corner;
			return dab.grid.stores(dab.face, node) ? moved_toward(value, target(node), dab.weight(node)) : value;
		});
	};
	if (dab.brush.mode == Brush::Mode::smooth) {
		// The window may extend beyond the face by less than half of its size.
		const int reach = std::min(smoothing_reach(dab.brush.radius, dab.grid.spacing(dab.planet_radius)),
				std::max(0, dab.grid.count() / 2 - 1));
		const PixelMeans means(FaceReader(before, dab.grid, dab.face), nodes, reach);
		apply([&](glm::ivec2 node) { return means.about(node.x, node.y); });
	} else {
		const int target = dab.brush.mode == Brush::Mode::paint ? 255 : 0;
		apply([target](glm::ivec2) { return target; });
	}
	return !edit.changed_area().empty();
}

std::array<PixelRect, CubeGrid::faces> PaintedMask::pixels_on(
		double planet_radius, const glm::dvec3 &from_center, double radius) const {
	std::array<PixelRect, CubeGrid::faces> result;
	const CubeGrid grid(planet_radius, pixel_size_);
	for (int face = 0; face < CubeGrid::faces; ++face) {
		const PixelRect nodes = grid.nodes_in(face, cap_of_dab(planet_radius, from_center, radius));
		if (!nodes.empty()) {
			result[static_cast<std::size_t>(face)] = {grid.corner(face) + nodes.min, grid.corner(face) + nodes.max};
		}
	}
	return result;
}

} // namespace thicket
