#include "nodes/scatter/scatter_viewers.hpp"

#include "core/terrain/view_focus.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/editor.hpp"

#include <godot_cpp/classes/camera3d.hpp>
#include <godot_cpp/classes/editor_interface.hpp>
#include <godot_cpp/classes/scene_tree.hpp>
#include <godot_cpp/classes/sub_viewport.hpp>
#include <godot_cpp/classes/viewport.hpp>
#include <godot_cpp/core/object.hpp>

#include <glm/geometric.hpp>

#include <cmath>

using namespace godot;

namespace thicket {

namespace {

constexpr int32_t editor_viewports = 4;

/// The visible height divided by the distance, for a perspective camera with the engine's default
/// field of view of 75 degrees.
constexpr double size_per_distance = 1.5347;

/// Returns the cameras of the editor's visible 3D viewports. If none is visible, for example while
/// the script editor is open, returns the first one.
std::vector<Camera3D *> editor_cameras() {
	std::vector<Camera3D *> cameras;
	for (int32_t index = 0; index < editor_viewports; ++index) {
		const SubViewport *viewport = EditorInterface::get_singleton()->get_editor_viewport_3d(index);
		Node *container = viewport != nullptr ? viewport->get_parent() : nullptr;
		if (container != nullptr && static_cast<bool>(container->call("is_visible_in_tree"))) {
			cameras.push_back(viewport->get_camera_3d());
		}
	}
	if (cameras.empty()) {
		cameras.push_back(EditorInterface::get_singleton()->get_editor_viewport_3d(0)->get_camera_3d());
	}
	return cameras;
}

bool is_orthogonal(const Camera3D &camera) { return camera.get_projection() == Camera3D::PROJECTION_ORTHOGONAL; }

/// The world position at which an orthogonal camera is aimed.
glm::dvec3 focus_of(const Camera3D &camera, const WorldFrame &frame, const ViewGround &ground) {
	const Transform3D transform = camera.get_global_transform();
	ParallelView view;
	view.from = to_world(transform.origin, frame);
	view.direction = -glm::normalize(frame.rotated(to_core(transform.basis))[2]);
	view.reach = camera.get_far();
	// The editor's orthogonal camera is half of its visible depth away from the point that it
	// orbits.
	view.usual_depth = in_editor() ? 0.5 * (view.reach - camera.get_near()) : 0.0;
	return view_focus(view, ground.terrain, ground.terrain == nullptr ? ground.level() : 0.0);
}

} // namespace

bool has_position(const Node3D &viewer) {
	const Vector3 position = viewer.get_global_position();
	return std::isfinite(position.x) && std::isfinite(position.z);
}

std::vector<Camera3D *> active_cameras(const Node3D &node) {
	std::vector<Camera3D *> cameras =
			in_editor() ? editor_cameras() : std::vector{node.get_viewport()->get_camera_3d()};
	std::erase(cameras, nullptr);
	return cameras;
}

CurrentViewers find_viewers(
		const Node3D &node, const ViewerSettings &settings, const WorldFrame &frame, const ViewGround &ground) {
	CurrentViewers result;
	const auto add = [&](const Node3D *viewer, int64_t index) {
		if (viewer == nullptr || !viewer->is_inside_tree() || !has_position(*viewer)) {
			return;
		}
		const Vector3 origin = viewer->get_global_position();
		glm::dvec3 position =
				to_world(Vector3(origin.x, std::isfinite(origin.y) ? origin.y : real_t(0.0), origin.z), frame);
		double height_offset = 0.0;
		const Camera3D *camera = Object::cast_to<Camera3D>(viewer);
		if (camera != nullptr && is_orthogonal(*camera)) {
			const glm::dvec3 focus = focus_of(*camera, frame, ground);
			const bool has_focus = std::isfinite(focus.x) && std::isfinite(focus.y) && std::isfinite(focus.z);
			position = has_focus ? focus : position;
			height_offset = camera->get_size() / size_per_distance;
		}
		const PackedFloat32Array &scales = settings.distance_scales;
		const double scale = index < scales.size() ? scales.ptr()[index] : 1.0;
		result.viewers.push_back({{position.x, position.z}, scale, position.y + height_offset});
		result.positions.push_back(position);
		result.ids.push_back(viewer->get_instance_id());
	};
	for (int64_t index = 0; index < settings.paths.size(); ++index) {
		add(Object::cast_to<Node3D>(node.get_node_or_null(settings.paths[index])), index);
	}
	if (settings.paths.is_empty()) {
		for (const Camera3D *camera : active_cameras(node)) {
			add(camera, 0);
		}
	}
	return result;
}

std::vector<glm::dvec3> find_near_centers(
		const Node3D &node, const CurrentViewers &viewers, const StringName &p_group, const WorldFrame &frame) {
	std::vector<glm::dvec3> centers = viewers.positions;
	if (p_group == StringName()) {
		return centers;
	}
	const TypedArray<Node> members = node.get_tree()->get_nodes_in_group(p_group);
	for (int64_t i = 0; i < members.size(); ++i) {
		const Node3D *member = Object::cast_to<Node3D>(members[i]);
		const Vector3 position = member != nullptr ? member->get_global_position() : Vector3();
		if (member != nullptr && std::isfinite(position.x) && std::isfinite(position.y) && std::isfinite(position.z)) {
			centers.push_back(to_world(position, frame));
		}
	}
	return centers;
}

} // namespace thicket
