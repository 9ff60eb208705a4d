// This file describes the problems of a region in sentences for the editor's configuration
// warnings.

#include "core/rules/shape_frame.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/region/scatter_region_3d.hpp"

#include <godot_cpp/core/object.hpp>

#include <algorithm>
#include <cmath>

using namespace godot;

namespace thicket {

namespace {

constexpr bool differ(double a, double b) { return std::abs(a - b) > 1e-4 * std::max(a, b); }

} // namespace

void ScatterRegion3D::add_outline_problems(PackedStringArray &r_problems) const {
	if (shape_ == SHAPE_POLYGON && polygon_.size() < 3) {
		r_problems.push_back("ScatterRegion3D.polygon has fewer than 3 corners: the region has no effect.");
	}
	if (shape_ != SHAPE_PATH) {
		return;
	}
	if (cast_to<Path3D>(path_.is_empty() ? get_parent() : get_node_or_null(path_)) == nullptr) {
		r_problems.push_back("No path: set ScatterRegion3D.path to a Path3D, or make the region a child of one.");
	} else if (is_inside_tree() && path_outline().size() < 2) {
		r_problems.push_back("The Path3D's curve has fewer than 2 points: the region has no effect.");
	}
}

PackedStringArray ScatterRegion3D::get_problems() const {
	PackedStringArray problems;
	add_outline_problems(problems);
	if (!is_inside_tree()) {
		return problems;
	}
	if (host_ == nullptr) {
		problems.push_back("The region has no effect: it belongs below a TerrainScatter3D, at any depth.");
	} else {
		for (int64_t i = 0; i < layers_.size(); ++i) {
			if (const String problem = host_->layer_problem(layers_[i]); !problem.is_empty()) {
				problems.push_back("ScatterRegion3D.layers: " + problem);
			}
		}
	}
	if (is_flat()) {
		return problems;
	}
	ShapeFrame frame;
	const Status status = take_apart(to_core(transform_of(*this).basis), frame);
	const glm::dvec3 scale = frame.scale;
	if (!status.ok()) {
		problems.push_back("The region has no effect: " + sentence(class_name, status) + ".");
	} else if ((shape_ != SHAPE_BOX && differ(scale.x, scale.z)) ||
			(shape_ == SHAPE_SPHERE && differ(scale.x, scale.y))) {
		problems.push_back("The node's scale is not the same along all axes: the radius uses the largest.");
	}
	return problems;
}

} // namespace thicket
