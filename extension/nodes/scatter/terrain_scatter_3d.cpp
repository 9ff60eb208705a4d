#include "nodes/scatter/terrain_scatter_3d.hpp"

#include "nodes/common/watch.hpp"
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
		case NOTIFICATION_VISIBILITY_CHANGED: stream_.stage().set_visible(is_visible_in_tree()); break;
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
	stream_.stage().set_place(get_world_3d()->get_scenario(), get_instance_id());
	stream_.stage().set_visible(is_visible_in_tree());
	if (!Engine::get_singleton()->is_editor_hint()) {
		collision_.set_place(get_world_3d()->get_space(), get_instance_id());
	}
	set_process_internal(true);
	if (!std::exchange(running_, true) && terrain_.is_valid()) {
		terrain_->enter(this, world_offset_);
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
	if (dirty_) {
		refresh();
	}
	if (terrain_.is_valid() && !plans_.streamed().empty()) {
		if (state_.is_valid() && !Engine::get_singleton()->is_editor_hint()) {
			state_->advance(get_process_delta_time());
		}
		const std::uint64_t spent = look_around_near();
		const auto budget = static_cast<std::uint64_t>(upload_budget_usec_);
		stream_.stage().set_limits(draw_limits());
		stream_.frame(find_viewers(), budget - std::min(spent, budget));
		answer_requests();
		if (!step_scenes(start + std::chrono::microseconds(upload_budget_usec_))) {
			return; // This node is no more.
		}
		stream_.stage().patch();
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

bool TerrainScatter3D::has_layer_named(const String &p_name) const {
	return !p_name.is_empty() && layer_names_.has(p_name);
}

void TerrainScatter3D::refresh() {
	dirty_ = false;
	set_physics_process_internal(terrain_.is_valid() && terrain_->needs_physics_frames());
	ScatterGround ground{static_cast<std::uint64_t>(seed_), nullptr, std::exchange(ground_change_, {})};
	if (!ground.changed.empty() && terrain_.is_valid()) {
		ground_ = terrain_->snapshot(get_instance_id());
	}
	ground.terrain = ground_;
	const bool grounded = terrain_.is_valid() && (ground_ != nullptr || terrain_->is_main_thread_only());
	regions_.update(std::exchange(recentered_, false));
	if (!grounded || layers_.is_empty()) {
		scenes_.clear();
		stream_.stop();
		plans_.clear();
		return;
	}
	const std::vector<EditedArea> outdated = plans_.update(layers_, ground, regions_);
	update_world(outdated);
	stream_.set_layers(plans_.streamed(), outdated, {terrain_, get_instance_id()});
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

Ref<ScatterLayer> TerrainScatter3D::layer_at(int64_t p_place) const { return layers_[p_place]; }

void TerrainScatter3D::set_seed(int64_t p_seed) {
	if (seed_ != p_seed) {
		seed_ = p_seed;
		mark_dirty();
	}
}

int64_t TerrainScatter3D::get_seed() const { return seed_; }

void TerrainScatter3D::watch_layers(bool p_watch) {
	for (int64_t place = 0; place < layers_.size(); ++place) {
		watch(layer_at(place).ptr(), "changed", this, "_mark_dirty", p_watch);
		watch(layer_at(place).ptr(), "area_changed", this, "_mark_area_edited", p_watch);
	}
}

void TerrainScatter3D::watch_terrain(bool p_watch) {
	watch(terrain_.ptr(), "changed", this, "_mark_ground_dirty", p_watch);
	watch(terrain_.ptr(), "terrain_changed", this, "_mark_ground_edited", p_watch);
}

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
		terrain_->enter(this, world_offset_);
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
	return !dirty_ && (plans_.streamed().empty() || (stream_.idle() && scenes_.settled()));
}

} // namespace thicket
