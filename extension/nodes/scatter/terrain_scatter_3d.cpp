#include "nodes/scatter/terrain_scatter_3d.hpp"

#include "nodes/common/watch.hpp"
#include "nodes/layer/layer_reference.hpp"
#include "nodes/gameplay/instance_answers.hpp"

#include <godot_cpp/classes/engine.hpp>
#include <godot_cpp/classes/scene_tree.hpp>
#include <godot_cpp/classes/world3d.hpp>
#include <godot_cpp/core/class_db.hpp>

#include <glm/common.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

constexpr const char *class_name = "TerrainScatter3D";

/// Meters around a change of the ground in which slopes may be others: heights are compared over less than that.
constexpr double slope_margin = 1.0;

/// A rectangle of the engine; all of the world for one without an area, or that is not finite.
Rect world_rect(const Rect2 &p_rect) {
	constexpr double infinity = std::numeric_limits<double>::infinity();
	const glm::dvec2 corner{p_rect.position.x, p_rect.position.y};
	const glm::dvec2 other = corner + glm::dvec2{p_rect.size.x, p_rect.size.y};
	const Rect rect{glm::min(corner, other), glm::max(corner, other)};
	return rect.empty() || !rect.finite() ? Rect{glm::dvec2(-infinity), glm::dvec2(infinity)} : rect;
}

} // namespace

TerrainScatter3D::TerrainScatter3D() { stream_.set_rings({&collision_}); }

TerrainScatter3D::~TerrainScatter3D() {
	stop();
	set_state(nullptr);
}

void TerrainScatter3D::_notification(int p_what) {
	switch (p_what) {
		case NOTIFICATION_ENTER_WORLD: start(); break;
		case NOTIFICATION_EXIT_WORLD: stop(); break;
		case NOTIFICATION_VISIBILITY_CHANGED: stream_.display().set_visible(is_visible_in_tree()); break;
		case NOTIFICATION_CHILD_ORDER_CHANGED: scenes_.children_changed(); break;
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
	stream_.display().set_scenario(get_world_3d()->get_scenario(), get_instance_id());
	stream_.display().set_visible(is_visible_in_tree());
	if (!Engine::get_singleton()->is_editor_hint()) {
		collision_.set_place(get_world_3d()->get_space(), get_instance_id());
	}
	set_process_internal(true);
	if (!std::exchange(running_, true) && terrain_.is_valid()) {
		terrain_->enter(this);
	}
	if (state_.is_valid()) {
		state_->add_listener(&state_watch_);
	}
	mark_ground_dirty();
}

void TerrainScatter3D::stop() {
	if (running_) {
		running_ = false;
		if (terrain_.is_valid()) {
			terrain_->leave(this);
		}
		scenes_.clear();
		stream_.stop();
		stream_.take_events();
	}
}

void TerrainScatter3D::process_frame() {
	const auto start = std::chrono::steady_clock::now();
	if (regions_.paths_changed()) {
		mark_edited();
	}
	notice_layers();
	if (dirty_) {
		refresh();
	}
	if (terrain_.is_valid() && !layer_list_.snapshots().empty()) {
		if (state_.is_valid() && !Engine::get_singleton()->is_editor_hint()) {
			state_->advance(get_process_delta_time());
		}
		const std::uint64_t spent = look_around_near();
		const auto budget = static_cast<std::uint64_t>(upload_budget_usec_);
		stream_.display().set_limits(draw_limits());
		if (!stream_.frame(find_viewers(), budget - std::min(spent, budget))) {
			return; // This node is no more.
		}
		answer_requests();
		if (!step_scenes(start + std::chrono::microseconds(upload_budget_usec_))) {
			return; // This node is no more.
		}
		stream_.display().patch();
	}
	frame_time_ = std::chrono::steady_clock::now() - start;
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
	for (const auto &[request, answer] : std::exchange(answers_, {})) {
		emit_signal("query_finished", request, answer);
	}
	const bool idle = is_idle();
	if (idle && !std::exchange(was_idle_, idle)) {
		emit_signal("idle");
	}
	was_idle_ = idle;
}

void TerrainScatter3D::mark_edited() {
	dirty_ = true;
	was_idle_ = false;
}

void TerrainScatter3D::mark_dirty() {
	layer_watch_.look(layers_);
	for (const LayerRename &rename : layer_watch_.follow_names()) {
		regions_.rename_layer(rename.from, rename.to);
	}
	mark_edited();
	update_configuration_warnings();
	PackedStringArray names;
	for (int64_t place = 0; place < layers_.size(); ++place) {
		const Ref<ScatterLayer> layer = layer_at(place);
		names.push_back(layer.is_valid() ? layer->get_name() : String());
	}
	if (!(names == layer_names_)) {
		layer_names_ = names;
		regions_.update_warnings(); // They may name layers.
	}
}

void TerrainScatter3D::mark_ground_dirty() {
	ground_change_.everywhere = true;
	mark_dirty();
}

void TerrainScatter3D::mark_ground_edited(const Rect2 &p_rect) {
	const Rect rect = world_rect(p_rect);
	ground_change_.everywhere = ground_change_.everywhere || !rect.finite();
	ground_change_.add(rect, slope_margin);
	mark_edited();
}

void TerrainScatter3D::mark_area_edited(const Rect2 &) { mark_edited(); }

void TerrainScatter3D::add_region(ScatterRegion3D *p_region) {
	regions_.add(p_region);
	mark_edited();
}

void TerrainScatter3D::remove_region(ScatterRegion3D *p_region) {
	regions_.remove(p_region);
	mark_edited();
}

void TerrainScatter3D::region_changed(const ScatterRegion3D *p_region) {
	regions_.mark(p_region);
	mark_edited();
}

String TerrainScatter3D::layer_problem(const Variant &p_reference) const {
	std::uint32_t index = 0;
	return find_layer(layers_, p_reference, index);
}

void TerrainScatter3D::refresh() {
	dirty_ = false;
	set_physics_process_internal(terrain_.is_valid() && terrain_->needs_physics_frames());
	const EditedArea ground_change = std::exchange(ground_change_, {});
	if (!ground_change.empty() && terrain_.is_valid()) {
		ground_ = terrain_->snapshot();
	}
	const bool grounded = terrain_.is_valid() && (ground_ != nullptr || terrain_->main_thread_only());
	regions_.update(std::exchange(recentered_, false));
	if (!grounded || layers_.is_empty()) {
		scenes_.clear();
		stream_.stop();
		layer_list_.clear();
		return;
	}
	const std::vector<EditedArea> outdated =
			layer_list_.update(layers_, static_cast<std::uint64_t>(seed_), ground_change, regions_);
	update_world(outdated);
	stream_.set_layers(layer_list_.snapshots(), outdated, {ground_, terrain_});
	update_scenes();
}

/// Tells the rings where bodies and scenes are wanted: around viewers, and around the nodes of a group. Returns the microseconds that
/// it took, which are a part of the frame's budget.
std::uint64_t TerrainScatter3D::look_around_near() {
	if (rings_.empty() || Engine::get_singleton()->is_editor_hint()) {
		return 0;
	}
	const auto start = std::chrono::steady_clock::now();
	std::vector<glm::dvec3> centers;
	for (const Viewer &viewer : find_viewers()) {
		centers.emplace_back(viewer.position.x, viewer.height, viewer.position.y);
	}
	if (!(body_group_ == StringName())) {
		const TypedArray<Node> bodies = get_tree()->get_nodes_in_group(body_group_);
		for (int64_t i = 0; i < bodies.size(); ++i) {
			const Node3D *body = Object::cast_to<Node3D>(bodies[i]);
			const Vector3 at = body != nullptr ? body->get_global_position() : Vector3();
			if (body != nullptr && std::isfinite(at.x) && std::isfinite(at.y) && std::isfinite(at.z)) {
				centers.push_back(to_world(at, world_offset_));
			}
		}
	}
	for (NearRing *ring : rings_) {
		ring->look_around(centers, *world_);
	}
	const auto spent = std::chrono::steady_clock::now() - start;
	return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::microseconds>(spent).count());
}

Ref<ScatterLayer> TerrainScatter3D::layer_at(int64_t p_place) const {
	return p_place < layers_.size() ? Ref<ScatterLayer>(layers_[p_place]) : Ref<ScatterLayer>();
}

void TerrainScatter3D::set_seed(int64_t p_seed) {
	if (seed_ != p_seed) {
		seed_ = p_seed;
		mark_dirty();
	}
}

int64_t TerrainScatter3D::get_seed() const { return seed_; }

/// Scripts share the list, and may change it without its setter.
void TerrainScatter3D::notice_layers() {
	if (layer_watch_.differs(layers_)) {
		mark_dirty();
	}
}

void TerrainScatter3D::watch_terrain(bool p_watch) {
	watch(terrain_.ptr(), "changed", this, "_mark_ground_dirty", p_watch);
	watch(terrain_.ptr(), "terrain_changed", this, "_mark_ground_edited", p_watch);
}

void TerrainScatter3D::set_layers(const TypedArray<ScatterLayer> &p_layers) {
	layers_ = p_layers;
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
	if (terrain_.is_valid()) {
		terrain_->set_world_offset(world_offset_);
	}
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

bool TerrainScatter3D::is_idle() const {
	return !dirty_ && !layer_watch_.differs(layers_) &&
			(layer_list_.snapshots().empty() || (stream_.idle() && scenes_.settled()));
}

} // namespace thicket
