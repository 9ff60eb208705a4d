// Whom a TerrainScatter3D streams around, and where the engine's origin is in the world.

#include "nodes/scatter/terrain_scatter_3d.hpp"

#include "nodes/gameplay/instance_answers.hpp"

#include <godot_cpp/classes/camera3d.hpp>
#include <godot_cpp/classes/editor_interface.hpp>
#include <godot_cpp/classes/engine.hpp>
#include <godot_cpp/classes/sub_viewport.hpp>
#include <godot_cpp/classes/viewport.hpp>

#include <cmath>

using namespace godot;

namespace thicket {

namespace {

constexpr const char *class_name = "TerrainScatter3D";

} // namespace

Node3D *TerrainScatter3D::active_camera() const {
	if (Engine::get_singleton()->is_editor_hint()) {
		return EditorInterface::get_singleton()->get_editor_viewport_3d(0)->get_camera_3d();
	}
	return get_viewport()->get_camera_3d();
}

std::vector<Viewer> TerrainScatter3D::find_viewers() const {
	std::vector<Viewer> result;
	const auto add = [this, &result](const Node3D *node, int64_t place) {
		if (node != nullptr && node->is_inside_tree()) {
			const Vector3 at = node->get_global_position();
			if (std::isfinite(at.x) && std::isfinite(at.z)) {
				const glm::dvec3 world = world_offset_ + glm::dvec3(at.x, std::isfinite(at.y) ? at.y : 0.0, at.z);
				const double scale = place < viewer_radius_scales_.size() ? viewer_radius_scales_.ptr()[place] : 1.0;
				result.push_back({{world.x, world.z}, scale, world.y});
			}
		}
	};
	for (int64_t viewer = 0; viewer < viewers_.size(); ++viewer) {
		add(Object::cast_to<Node3D>(get_node_or_null(viewers_[viewer])), viewer);
	}
	if (viewers_.is_empty()) {
		add(active_camera(), 0);
	}
	return result;
}

void TerrainScatter3D::set_viewer_radius_scales(const PackedFloat32Array &p_scales) {
	for (int64_t viewer = 0; viewer < p_scales.size(); ++viewer) {
		const String name = "viewer_radius_scales[" + String::num_int64(viewer) + "]";
		if (!accept_number(class_name, name.utf8().get_data(), p_scales.ptr()[viewer], 0.0, 1e6)) {
			return;
		}
	}
	viewer_radius_scales_ = p_scales;
}

void TerrainScatter3D::set_world_offset(const Vector3 &p_offset) {
	for (const real_t meters : {p_offset.x, p_offset.y, p_offset.z}) {
		if (!accept_number(class_name, "world_offset", meters, -1e12, 1e12)) {
			return;
		}
	}
	const glm::dvec3 offset{p_offset.x, p_offset.y, p_offset.z};
	if (offset == world_offset_) {
		return;
	}
	world_offset_ = offset;
	recentered_ = true;
	stream_.display().set_world_offset(offset);
	for (NearRing *ring : rings_) {
		ring->set_world_offset(offset);
	}
	if (terrain_.is_valid()) {
		terrain_->set_world_offset(offset);
	}
	if (regions_.mark_all()) {
		mark_edited(); // Those that have not moved with the scene are somewhere else in the world.
	}
}

Vector3 TerrainScatter3D::get_world_offset() const { return to_engine(world_offset_, glm::dvec3(0.0)); }

} // namespace thicket
