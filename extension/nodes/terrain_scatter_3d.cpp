#include "nodes/terrain_scatter_3d.hpp"

#include <godot_cpp/classes/camera3d.hpp>
#include <godot_cpp/classes/editor_interface.hpp>
#include <godot_cpp/classes/engine.hpp>
#include <godot_cpp/classes/sub_viewport.hpp>
#include <godot_cpp/classes/viewport.hpp>
#include <godot_cpp/classes/world3d.hpp>
#include <godot_cpp/core/class_db.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

constexpr const char *class_name = "TerrainScatter3D";

/// Metres from a mesh's origin to the farthest corner of its box.
float reach_of(const Ref<Mesh> &mesh) {
	if (mesh.is_null()) {
		return 0.0F;
	}
	const AABB box = mesh->get_aabb();
	const Vector3 far_corner = box.position.abs().max((box.position + box.size).abs());
	return static_cast<float>(far_corner.length());
}

/// The reach of each mesh of a layer, at any distance.
std::vector<float> reaches_of(const LayerLook &look) {
	std::vector<float> reaches;
	for (const Ref<Mesh> &mesh : look.meshes) {
		reaches.push_back(reach_of(mesh));
	}
	for (std::size_t at = 0; at < look.lod_meshes.size(); ++at) {
		float &reach = reaches[at % reaches.size()];
		reach = std::max(reach, reach_of(look.lod_meshes[at]));
	}
	for (float &reach : reaches) {
		reach *= static_cast<float>(compensating_scale(look.detail, look.detail.thin_density));
	}
	return reaches;
}

/// Shows nothing, and asks for as few tiles as there can be.
StreamedLayer absent_layer() {
	LayerPlan plan;
	plan.wanted = false;
	return {std::make_shared<LayerPlan>(std::move(plan)), {1e6, 0.0}, {}};
}

bool same_tiles(const StreamedLayer &a, const StreamedLayer &b) {
	return a.plan->settings == b.plan->settings && a.plan->wanted == b.plan->wanted &&
			a.plan->terrain == b.plan->terrain && a.plan->mesh_reach == b.plan->mesh_reach &&
			a.look.meshes == b.look.meshes && a.look.lod_meshes == b.look.lod_meshes;
}

} // namespace

TerrainScatter3D::TerrainScatter3D() = default;

TerrainScatter3D::~TerrainScatter3D() { stop(); }

void TerrainScatter3D::_notification(int p_what) {
	switch (p_what) {
		case NOTIFICATION_ENTER_WORLD: start(); break;
		case NOTIFICATION_EXIT_WORLD: stop(); break;
		case NOTIFICATION_VISIBILITY_CHANGED: stream_.stage().set_visible(is_visible_in_tree()); break;
		case NOTIFICATION_INTERNAL_PROCESS: process_frame(); break;
		case NOTIFICATION_INTERNAL_PHYSICS_PROCESS: stream_.physics_frame(); break;
		case NOTIFICATION_EXTENSION_RELOADED:
			if (is_inside_tree()) {
				start();
			}
			break;
		default: break;
	}
}

void TerrainScatter3D::start() {
	stream_.stage().set_place(get_world_3d()->get_scenario(), get_instance_id());
	stream_.stage().set_visible(is_visible_in_tree());
	set_process_internal(true);
	if (!std::exchange(running_, true) && terrain_.is_valid()) {
		terrain_->enter(this);
	}
	mark_ground_dirty();
}

void TerrainScatter3D::stop() {
	if (running_) {
		running_ = false;
		if (terrain_.is_valid()) {
			terrain_->leave(this);
		}
		stream_.stop();
		stream_.take_events();
	}
}

void TerrainScatter3D::process_frame() {
	if (dirty_) {
		refresh();
	}
	if (terrain_.is_valid() && !streamed_.empty()) {
		const std::vector<Viewer> viewers = find_viewers();
		if (!viewers.empty()) {
			stream_.stage().set_limits(draw_limits());
			stream_.frame(viewers, static_cast<std::uint64_t>(upload_budget_usec_));
		}
	}
	emit_events();
}

DrawLimits TerrainScatter3D::draw_limits() const {
	DrawLimits limits;
	limits.quality = quality_;
	if (Engine::get_singleton()->is_editor_hint()) {
		limits.max_instances = static_cast<std::uint64_t>(preview_instances_);
	}
	return limits;
}

void TerrainScatter3D::emit_events() {
	for (const TileEvent &event : stream_.take_events()) {
		emit_signal(event.shown ? "tile_shown" : "tile_hidden", static_cast<int64_t>(event.layer),
				Vector2i(event.tile.x, event.tile.y));
	}
	const bool idle = is_idle();
	if (idle && !std::exchange(was_idle_, idle)) {
		emit_signal("idle");
	}
	was_idle_ = idle;
}

void TerrainScatter3D::mark_dirty() {
	dirty_ = true;
	was_idle_ = false;
	update_configuration_warnings();
}

void TerrainScatter3D::mark_ground_dirty() {
	ground_dirty_ = true;
	mark_dirty();
}

StreamedLayer TerrainScatter3D::streamed_layer(std::size_t p_place, const Ref<ScatterLayer> &p_layer) {
	if (p_layer.is_null()) {
		return absent_layer();
	}
	const Status status = p_layer->check();
	report(("layers[" + std::to_string(p_place) + "]: ScatterLayer").c_str(), status);
	if (!status.ok()) {
		return p_place < streamed_.size() ? streamed_[p_place] : absent_layer();
	}
	StreamedLayer streamed;
	streamed.look = {{p_layer->numbers(), p_layer->integers(), p_layer->get_material_override()}, p_layer->mesh_list(),
			p_layer->lod_mesh_list(), p_layer->detail()};
	streamed.range = p_layer->streaming();
	LayerPlan plan;
	plan.settings = p_layer->settings(static_cast<std::uint64_t>(seed_), p_place);
	plan.terrain = ground_;
	plan.mesh_reach = reaches_of(streamed.look);
	streamed.plan = std::make_shared<LayerPlan>(std::move(plan));
	return streamed;
}

void TerrainScatter3D::refresh() {
	dirty_ = false;
	set_physics_process_internal(terrain_.is_valid() && terrain_->needs_physics_frames());
	const bool new_ground = std::exchange(ground_dirty_, false);
	if (new_ground && terrain_.is_valid()) {
		ground_ = terrain_->snapshot();
	}
	const bool grounded = terrain_.is_valid() && (ground_ != nullptr || terrain_->main_thread_only());
	if (!grounded || layers_.is_empty()) {
		stream_.stop();
		streamed_.clear();
		return;
	}
	std::vector<StreamedLayer> next;
	std::vector<bool> changed;
	for (int64_t place = 0; place < layers_.size(); ++place) {
		const auto index = static_cast<std::size_t>(place);
		next.push_back(streamed_layer(index, layer_at(place)));
		const bool same = index < streamed_.size() && same_tiles(streamed_[index], next.back());
		if (same) {
			next.back().plan = streamed_[index].plan;
		}
		changed.push_back(!same || new_ground);
	}
	streamed_ = next;
	stream_.set_layers(std::move(next), changed, terrain_);
}

Node3D *TerrainScatter3D::active_camera() const {
	if (Engine::get_singleton()->is_editor_hint()) {
		return EditorInterface::get_singleton()->get_editor_viewport_3d(0)->get_camera_3d();
	}
	return get_viewport()->get_camera_3d();
}

std::vector<Viewer> TerrainScatter3D::find_viewers() const {
	std::vector<Viewer> result;
	const auto add = [&result](const Node3D *node) {
		if (node != nullptr && node->is_inside_tree()) {
			const Vector3 at = node->get_global_position();
			if (std::isfinite(at.x) && std::isfinite(at.z)) {
				result.push_back({{at.x, at.z}, 1.0, std::isfinite(at.y) ? at.y : 0.0});
			}
		}
	};
	for (int64_t viewer = 0; viewer < viewers_.size(); ++viewer) {
		add(Object::cast_to<Node3D>(get_node_or_null(viewers_[viewer])));
	}
	if (viewers_.is_empty()) {
		add(active_camera());
	}
	return result;
}

Ref<ScatterLayer> TerrainScatter3D::layer_at(int64_t p_place) const { return layers_[p_place]; }

void TerrainScatter3D::set_seed(int64_t p_seed) {
	if (seed_ != p_seed) {
		seed_ = p_seed;
		mark_dirty();
	}
}

int64_t TerrainScatter3D::get_seed() const { return seed_; }

// Connects to methods by their names: the connection outlives this C++ object when the extension is loaded anew.
void TerrainScatter3D::watch(Resource *p_resource, const StringName &p_method, bool p_watch) {
	const Callable on_change(this, p_method);
	if (p_resource == nullptr || p_resource->is_connected("changed", on_change) == p_watch) {
		return;
	}
	if (p_watch) {
		p_resource->connect("changed", on_change);
	} else {
		p_resource->disconnect("changed", on_change);
	}
}

void TerrainScatter3D::watch_layers(bool p_watch) {
	for (int64_t place = 0; place < layers_.size(); ++place) {
		watch(layer_at(place).ptr(), "_mark_dirty", p_watch);
	}
}

void TerrainScatter3D::watch_terrain(bool p_watch) { watch(terrain_.ptr(), "_mark_ground_dirty", p_watch); }

void TerrainScatter3D::set_layers(const TypedArray<ScatterLayer> &p_layers) {
	watch_layers(false);
	layers_ = p_layers;
	watch_layers(true);
	mark_dirty();
}

TypedArray<ScatterLayer> TerrainScatter3D::get_layers() const { return layers_; }

void TerrainScatter3D::set_terrain(const Ref<ScatterTerrain> &p_terrain) {
	if (terrain_ == p_terrain) {
		return;
	}
	watch_terrain(false);
	if (running_ && terrain_.is_valid()) {
		terrain_->leave(this);
	}
	terrain_ = p_terrain;
	ground_ = nullptr;
	if (running_ && terrain_.is_valid()) {
		terrain_->enter(this);
	}
	watch_terrain(true);
	mark_ground_dirty();
}

Ref<ScatterTerrain> TerrainScatter3D::get_terrain() const { return terrain_; }

void TerrainScatter3D::set_viewers(const TypedArray<NodePath> &p_viewers) {
	viewers_ = p_viewers;
	update_configuration_warnings();
}

TypedArray<NodePath> TerrainScatter3D::get_viewers() const { return viewers_; }

void TerrainScatter3D::set_upload_budget_usec(int64_t p_budget) {
	if (accept_number(class_name, "upload_budget_usec", static_cast<double>(p_budget), 1.0, 1e6)) {
		upload_budget_usec_ = p_budget;
	}
}

int64_t TerrainScatter3D::get_upload_budget_usec() const { return upload_budget_usec_; }

void TerrainScatter3D::set_quality(double p_quality) {
	if (accept_number(class_name, "quality", p_quality, 0.0, 1.0)) {
		quality_ = p_quality;
	}
}

double TerrainScatter3D::get_quality() const { return quality_; }

void TerrainScatter3D::set_preview_instances(int64_t p_count) {
	if (accept_number(class_name, "preview_instances", static_cast<double>(p_count), 0.0, 1e9)) {
		preview_instances_ = p_count;
	}
}

int64_t TerrainScatter3D::get_preview_instances() const { return preview_instances_; }

void TerrainScatter3D::regenerate() { mark_ground_dirty(); }

bool TerrainScatter3D::is_idle() const { return !dirty_ && (streamed_.empty() || stream_.idle()); }

} // namespace thicket
