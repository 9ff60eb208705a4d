#include "nodes/scatter/scatter_viewers.hpp"

#include "nodes/gameplay/instance_answers.hpp"

#include <godot_cpp/classes/camera3d.hpp>
#include <godot_cpp/classes/editor_interface.hpp>
#include <godot_cpp/classes/engine.hpp>
#include <godot_cpp/classes/scene_tree.hpp>
#include <godot_cpp/classes/sub_viewport.hpp>
#include <godot_cpp/classes/viewport.hpp>
#include <godot_cpp/core/object.hpp>

#include <cmath>

using namespace godot;

namespace thicket {

namespace {

Node3D *active_camera(const Node3D &node) {
	if (Engine::get_singleton()->is_editor_hint()) {
		return EditorInterface::get_singleton()->get_editor_viewport_3d(0)->get_camera_3d();
	}
	return node.get_viewport()->get_camera_3d();
}

} // namespace

bool has_place(const Node3D &viewer) {
	const Vector3 at = viewer.get_global_position();
	return std::isfinite(at.x) && std::isfinite(at.z);
}

bool has_camera(const Node3D &node) { return active_camera(node) != nullptr; }

std::vector<Viewer> find_viewers(const Node3D &node, const ViewerSettings &settings, glm::dvec3 offset) {
	std::vector<Viewer> result;
	const auto add = [&](const Node3D *viewer, int64_t index) {
		if (viewer == nullptr || !viewer->is_inside_tree()) {
			return;
		}
		const Vector3 at = viewer->get_global_position();
		if (std::isfinite(at.x) && std::isfinite(at.z)) {
			const glm::dvec3 world = offset + glm::dvec3(at.x, std::isfinite(at.y) ? at.y : 0.0, at.z);
			const PackedFloat32Array &scales = settings.distance_scales;
			result.push_back({{world.x, world.z}, index < scales.size() ? scales.ptr()[index] : 1.0, world.y});
		}
	};
	for (int64_t index = 0; index < settings.paths.size(); ++index) {
		add(Object::cast_to<Node3D>(node.get_node_or_null(settings.paths[index])), index);
	}
	if (settings.paths.is_empty()) {
		add(active_camera(node), 0);
	}
	return result;
}

std::vector<glm::dvec3> find_near_centers(
		const Node3D &node, std::span<const Viewer> viewers, const StringName &p_group, glm::dvec3 offset) {
	std::vector<glm::dvec3> centers;
	for (const Viewer &viewer : viewers) {
		centers.emplace_back(viewer.position.x, viewer.height, viewer.position.y);
	}
	if (p_group == StringName()) {
		return centers;
	}
	const TypedArray<Node> members = node.get_tree()->get_nodes_in_group(p_group);
	for (int64_t i = 0; i < members.size(); ++i) {
		const Node3D *member = Object::cast_to<Node3D>(members[i]);
		const Vector3 at = member != nullptr ? member->get_global_position() : Vector3();
		if (member != nullptr && std::isfinite(at.x) && std::isfinite(at.y) && std::isfinite(at.z)) {
			centers.push_back(to_world(at, offset));
		}
	}
	return centers;
}

} // namespace thicket
