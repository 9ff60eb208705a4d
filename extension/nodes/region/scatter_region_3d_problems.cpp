// This file describes the problems of a region for the editor's configuration warnings.

#include "core/rules/shape_frame.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/region/scatter_region_3d.hpp"

#include <godot_cpp/core/object.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

using namespace godot;

namespace thicket {

namespace {

/// The smallest allowed cosine of the angle between a polygon's normal and the up direction (60
/// degrees).
constexpr double min_upright = 0.5;

constexpr bool are_different(double a, double b) { return std::abs(a - b) > 1e-4 * std::max(a, b); }

} // namespace

void ScatterRegion3D::add_outline_problems(PackedStringArray &r_problems) const {
	if (shape_ == SHAPE_POLYGON && polygon_.size() < 3) {
		r_problems.push_back(
				"ScatterRegion3D.polygon has fewer than 3 corners, so the region has no effect. Add corners.");
	}
	if (shape_ != SHAPE_PATH) {
		return;
	}
	if (cast_to<Path3D>(path_.is_empty() ? get_parent() : get_node_or_null(path_)) == nullptr) {
		r_problems.push_back("No path: set ScatterRegion3D.path to a Path3D, or make the region a child of one.");
	} else if (is_inside_tree() && path_points().size() < 2) {
		r_problems.push_back(
				"The Path3D's curve has fewer than 2 points, so the region has no effect. Add points to the curve.");
	}
}

/// Adds the problems of a region on a planet that ignores height.
void ScatterRegion3D::add_planet_problems(PackedStringArray &r_problems) const {
	thicket::Shape shape;
	const Status status = build(shape);
	if (!shape.planet.exists() || status.code == ErrorCode::missing) {
		return;
	}
	if (!status.ok()) {
		r_problems.push_back("The region has no effect: " + sentence(class_name, status) + ".");
	} else if (shape_ == SHAPE_POLYGON) {
		const glm::dvec3 normal = glm::normalize(to_core(transform_of(*this).basis)[1]);
		if (std::abs(glm::dot(normal, shape.planet.up_at(shape.center))) < min_upright) {
			r_problems.push_back("ScatterRegion3D.polygon is too steep on the planet (over 60 degrees). Rotate "
								 "the node so that its y axis points away from the planet's center.");
		}
	}
}

PackedStringArray ScatterRegion3D::get_problems() const {
	PackedStringArray problems;
	add_outline_problems(problems);
	if (!is_inside_tree()) {
		return problems;
	}
	if (host_ == nullptr) {
		problems.push_back(
				"The region has no effect: make it a child of a TerrainScatter3D, or a descendant at any depth.");
	} else {
		for (int64_t i = 0; i < layers_.size(); ++i) {
			if (const String problem = host_->layer_problem(layers_[i]); !problem.is_empty()) {
				problems.push_back("ScatterRegion3D.layers: " + problem);
			}
		}
	}
	if (is_flat()) {
		add_planet_problems(problems);
		return problems;
	}
	ShapeFrame frame;
	const Status status = decompose(to_core(transform_of(*this).basis), frame);
	const glm::dvec3 scale = frame.scale;
	if (!status.ok()) {
		problems.push_back("The region has no effect: " + sentence(class_name, status) + ".");
	} else if ((shape_ != SHAPE_BOX && are_different(scale.x, scale.z)) ||
			(shape_ == SHAPE_SPHERE && are_different(scale.x, scale.y))) {
		problems.push_back(
				"The node's scale differs between axes, so the largest is used for the radius. Use a uniform "
				"scale.");
	}
	if (status.ok()) {
		add_planet_problems(problems);
	}
	return problems;
}

} // namespace thicket
