// This file contains the life cycle of TerrainScatter3D and its work in each frame.

#include "nodes/scatter/terrain_scatter_3d.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/common/editor.hpp"
#include "nodes/common/threads.hpp"
#include "nodes/layer/layer_reference.hpp"
#include "nodes/scatter/scatter_problems.hpp"

#include <godot_cpp/classes/engine.hpp>
#include <godot_cpp/classes/viewport.hpp>
#include <godot_cpp/classes/world3d.hpp>
#include <godot_cpp/core/class_db.hpp>

#include <algorithm>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

using Clock = std::chrono::steady_clock;

/// Detects, after scripts have run, whether a node was freed or has left its world. Accesses only
/// objects that outlive the node.
class Presence {
public:
	explicit Presence(const std::shared_ptr<ScatterGameplay> &gameplay) : gameplay_(gameplay), run_(gameplay->run()) {}
	explicit operator bool() const { return gameplay_->alive() && gameplay_->run() == run_; }

private:
	std::shared_ptr<ScatterGameplay> gameplay_;
	std::uint64_t run_;
};

} // namespace

TerrainScatter3D::TerrainScatter3D() {
	stream_->set_rings({&gameplay_->collision()});
	set_notify_transform(true);
}

TerrainScatter3D::~TerrainScatter3D() {
	stop();
	gameplay()->detach();
}

void TerrainScatter3D::_notification(int p_what) {
	guarded_call("TerrainScatter3D._notification", [this, p_what] { handle_notification(p_what); });
}

void TerrainScatter3D::handle_notification(int p_what) {
	switch (p_what) {
		case NOTIFICATION_ENTER_WORLD: start(); break;
		case NOTIFICATION_EXIT_WORLD: stop(); break;
		case NOTIFICATION_TRANSFORM_CHANGED: check_transform(); break;
		case NOTIFICATION_VISIBILITY_CHANGED: display().set_visible(is_visible_in_tree()); break;
		case NOTIFICATION_CHILD_ORDER_CHANGED: gameplay()->scenes().children_changed(); break;
		// Deferred, because a script that runs in it may free the node. The engine accesses a node
		// after a notification, but not after a deferred call. Deferred calls run in the same
		// frame.
		case NOTIFICATION_INTERNAL_PROCESS: call_deferred("_process_frame"); break;
		case NOTIFICATION_INTERNAL_PHYSICS_PROCESS: {
			if (!on_main_thread()) {
				break; // The node is in a process thread group. `_process_frame` prints the error.
			}
			const std::shared_ptr<ScatterGameplay> gameplay = gameplay_;
			const std::shared_ptr<ScatterStream> stream = stream_;
			stream->physics_frame();
			break;
		}
		case NOTIFICATION_EXTENSION_RELOADED:
			if (is_inside_tree()) {
				start();
			}
			break;
		default: break;
	}
}

/// Starts streaming when the node enters its world.
void TerrainScatter3D::start() {
	display().set_scenario(get_world_3d()->get_scenario(), get_instance_id());
	display().set_visible(is_visible_in_tree());
	gameplay()->start(in_editor() ? RID() : get_world_3d()->get_space(), get_instance_id());
	navigation_.start(this, "_parse_navigation");
	set_process_internal(true);
	was_inside_ = true;
	move_world();
	if (!std::exchange(is_running_, true)) {
		thread_guard().enter_scene();
		if (ground_.is_valid()) {
			ground_->enter(this, frame_);
		}
	}
	check_transform();
	state_edits_.everywhere = true; // The state may have changed while the node was outside the tree.
	mark_ground_dirty();
}

/// Updates the warning that the node's transform has no effect.
void TerrainScatter3D::check_transform() {
	const bool is_now_displaced = !local_coords_ && is_displaced(*this, world_offset_);
	if (std::exchange(is_displaced_, is_now_displaced) != is_now_displaced) {
		update_configuration_warnings();
	}
}

/// Stops streaming when the node leaves its world, and removes everything that is displayed.
void TerrainScatter3D::stop() {
	if (!std::exchange(is_running_, false)) {
		return;
	}
	thread_guard().leave_scene();
	navigation_.stop();
	if (ground_.is_valid()) {
		ground_->leave(this);
	}
	const std::shared_ptr<ScatterStream> stream = stream_;
	gameplay()->stop();
	stream->stop();
	stream->take_events();
	fade_viewers_.clear();
	wind_time_.set_layers({});
	scene_use_.replace({});
}

/// Does the work of one frame. Scripts that it runs may free the node, so it checks after each of them
/// that the node still exists.
void TerrainScatter3D::process_frame() {
	if (!is_running_) {
		return;
	}
	const auto start = Clock::now();
	const std::shared_ptr<ScatterStream> stream = stream_;
	stream->times().begin();
	const Presence presence(gameplay_);
	move_world();
	make_main_thread_calls();
	if (presence) {
		gameplay()->take_requests();
	}
	if (!presence) {
		return;
	}
	if (ground_.is_valid()) {
		ground_->follow_scene(start + std::chrono::microseconds(frame_budget_usec_));
		if (!presence) {
			return;
		}
		// A script of the ground may have replaced it.
		for (const Rect &area :
				ground_.is_valid() ? ground_->take_removed_areas(get_instance_id()) : std::vector<Rect>()) {
			stream->drop_unseen(area);
		}
		is_dirty_ = is_dirty_ || waits_for_ground();
	}
	if (regions_.paths_changed()) {
		mark_edited();
	}
	if (row_paths_.have_changed(*this, *this)) {
		mark_edited();
		update_configuration_warnings();
	}
	check_layers();
	if (presence && is_dirty_ && models_are_read(start + std::chrono::microseconds(frame_budget_usec_)) && presence) {
		refresh();
	}
	stream->times().add_time(FramePart::follow);
	const bool has_content = ground_.is_valid() && !layer_list_.snapshots().empty();
	if (presence && has_content) {
		work(start);
	} else if (presence) {
		dissolve(start);
	}
	if (presence) {
		frame_time_ = Clock::now() - start;
		emit_events();
		stream->times().add_time(FramePart::signals);
	}
}

/// Streams tiles, bodies and scenes around the current viewers, within the frame budget.
void TerrainScatter3D::work(Clock::time_point start) {
	const std::shared_ptr<ScatterGameplay> gameplay = gameplay_;
	const std::shared_ptr<ScatterStream> stream = stream_;
	const Presence presence(gameplay);
	const std::chrono::microseconds budget(frame_budget_usec_);
	if (!in_editor()) {
		wind_time_.advance(get_process_delta_time(), Engine::get_singleton()->get_process_frames());
		gameplay->advance(get_process_delta_time(), Engine::get_singleton()->get_process_frames());
		if (!presence) {
			return;
		}
	}
	const CurrentViewers viewers = current_viewers();
	const DrawLimits limits = draw_limits();
	was_settled_ = was_settled_ && stream->follows(viewers.viewers, limits);
	set_fade_viewers(viewers);
	if (!in_editor()) {
		const std::vector<glm::dvec3> centers = near_centers(viewers);
		was_settled_ = was_settled_ && gameplay->follows(centers);
		gameplay->find_changes(centers);
	}
	stream->times().add_time(FramePart::gameplay);
	const auto remaining = std::chrono::duration_cast<std::chrono::microseconds>(start + budget - Clock::now());
	stream->display().set_limits(limits);
	if (!stream->frame(viewers.viewers, static_cast<std::uint64_t>(std::max<std::int64_t>(remaining.count(), 0))) ||
			!presence) {
		return;
	}
	if (stream->take_failures_changed()) {
		update_configuration_warnings();
	}
	for (const glm::dvec2 position : stream->take_ground_changes()) {
		mark_ground_changed(position);
	}
	gameplay->answer_requests();
	gameplay->work_until(start + budget);
	stream->times().add_time(FramePart::reports);
	if (presence) {
		patch_in_steps(start + budget);
		stream->display().patch();
		stream->times().add_time(FramePart::patches);
	}
}

/// Removes existing instances within the budget when there are no layers or no ground.
void TerrainScatter3D::dissolve(Clock::time_point start) {
	const std::shared_ptr<ScatterGameplay> gameplay = gameplay_;
	const std::shared_ptr<ScatterStream> stream = stream_;
	if (gameplay->settled() && stream->display().leaving_count() == 0) {
		return;
	}
	const Presence presence(gameplay);
	const Clock::time_point deadline = start + std::chrono::microseconds(frame_budget_usec_);
	if (!in_editor()) {
		gameplay->find_changes(near_centers(current_viewers()));
	}
	stream->dissolve_until(deadline);
	if (presence) {
		gameplay->work_until(deadline);
	}
}

void TerrainScatter3D::patch_in_steps(Clock::time_point deadline) {
	while (display().patch_step() && Clock::now() < deadline) {}
}

/// Emits the signals of tiles that were shown or hidden, completes requests, and emits `settled`.
void TerrainScatter3D::emit_events() {
	const std::shared_ptr<ScatterGameplay> gameplay = gameplay_;
	const Presence presence(gameplay);
	const SharedLayers layers = gameplay->listed_layers();
	const SharedLayers former_layers = std::exchange(former_layers_, nullptr);
	for (const TileEvent &event : stream_->take_events()) {
		Ref<ScatterLayer> layer = layers->at(event.layer);
		if (layer.is_null() && former_layers != nullptr) {
			layer = former_layers->at(event.layer);
		}
		if (presence) {
			emit_signal(event.is_shown ? "tile_shown" : "tile_hidden", layer, Vector2i(event.tile.x, event.tile.y));
		}
	}
	gameplay->complete_requests();
	if (!presence) {
		return;
	}
	const bool is_now_settled = is_settled();
	if (is_now_settled && !std::exchange(was_settled_, is_now_settled)) {
		instance_load_.measure(display(), layer_list_.snapshots());
		check_load();
		emit_signal("settled");
	} else {
		was_settled_ = is_now_settled;
	}
}

DrawLimits TerrainScatter3D::draw_limits() const {
	DrawLimits limits;
	limits.quality = quality_;
	limits.max_multimeshes = static_cast<std::uint64_t>(max_multimeshes_);
	if (in_editor()) {
		limits.max_instances = static_cast<std::uint64_t>(preview_instances_);
		limits.hidden_layers = previews_.hidden_flags(all_layers());
	}
	return limits;
}

bool TerrainScatter3D::is_settled() const {
	const bool is_input_outdated =
			(ground_.is_valid() && ground_->has_unapplied_changes()) || (biomes_.is_valid() && biomes_->differs());
	return !is_dirty_ && ground_change_.empty() && !is_input_outdated && !layer_watch_->differs(all_layers()) &&
			(layer_list_.snapshots().empty() || (stream_->idle() && !display().has_patches() && follows())) &&
			gameplay_->settled();
}

/// Returns true if moved viewers and changed limits would not make the next frame request or redraw
/// tiles, or create bodies and scenes.
bool TerrainScatter3D::follows() const {
	if (!is_inside_tree()) {
		return true;
	}
	const CurrentViewers viewers = current_viewers();
	return stream_->follows(viewers.viewers, draw_limits()) &&
			(in_editor() || gameplay_->follows(near_centers(viewers)));
}

CurrentViewers TerrainScatter3D::current_viewers() const {
	// Does not sample the ground of a script, because the script may free the node.
	const bool by_script = ground_.is_valid() && ground_->calls_script();
	return find_viewers(*this, viewers_, frame_,
			{by_script ? nullptr : ground_snapshot_.get(), [this] { return display().average_height(); }});
}

std::vector<glm::dvec3> TerrainScatter3D::near_centers(const CurrentViewers &viewers) const {
	return find_near_centers(*this, viewers, interaction_group_, frame_);
}

void TerrainScatter3D::set_fade_viewers(const CurrentViewers &viewers) {
	std::vector<FadeViewer> fade_viewers;
	for (std::size_t index = 0; index < viewers.viewers.size(); ++index) {
		const Viewer &viewer = viewers.viewers[index];
		const glm::dvec3 engine_position = frame_.to_engine({viewer.position.x, viewer.height, viewer.position.y});
		fade_viewers.push_back({viewers.ids[index], glm::vec4(glm::dvec4(engine_position, viewer.radius_scale - 1.0))});
	}
	const Camera3D *camera = get_viewport()->get_camera_3d();
	const Vector3 camera_position = camera != nullptr ? camera->get_global_position() : Vector3();
	fade_viewers_.set_viewers(fade_viewers, glm::vec3(to_core(camera_position)));
}

String TerrainScatter3D::layer_problem(const Variant &p_reference) const {
	std::uint32_t index = 0;
	return find_stored_layer(all_layers(), p_reference, index);
}

/// Applies settings that changed in this frame. Returns an error if there is nothing to query. Runs
/// scripts.
Status TerrainScatter3D::prepare() {
	const std::shared_ptr<ScatterGameplay> gameplay = gameplay_;
	move_world();
	if (const Ref<ScatterGround> ground = ground_; ground.is_valid()) {
		ground->finish_reading(); // Emits signals, so scripts may free this node.
	}
	if (gameplay->alive()) {
		check_layers();
	}
	if (gameplay->alive() && (is_dirty_ || waits_for_ground()) && models_are_read(Clock::time_point::max())) {
		refresh();
	}
	if (!gameplay->alive()) {
		return {ErrorCode::cancelled};
	}
	if (!layer_list_.snapshots().empty()) {
		return {};
	}
	return ground_.is_null()
			? Status::missing("ground", "Set TerrainScatter3D.ground")
			: Status::missing("layers", "Add a layer, or fix the problems that get_problems() returns");
}

/// Adds instances to a navigation mesh. The engine calls this function for each node that it parses
/// to bake the mesh.
void TerrainScatter3D::parse_navigation(
		const Ref<NavigationMesh> &p_mesh, const Ref<NavigationMeshSourceGeometryData3D> &p_geometry, Node *p_node) {
	NavigationBake bake;
	if (!navigation_.visit(p_mesh, p_geometry, p_node, this, bake)) {
		return;
	}
	const std::shared_ptr<ScatterGameplay> gameplay = gameplay_;
	navigation_.set_busy(true);
	gameplay->add_obstructions(bake);
	if (gameplay->alive()) {
		navigation_.set_busy(false);
	}
}

void TerrainScatter3D::Host::redraw(std::uint32_t layer, const Rect &area) {
	node_.mark_instances_changed(layer, area);
	node_.display().mark(layer, area);
	node_.schedule_patch();
}

void TerrainScatter3D::Host::redraw_later(std::uint32_t layer, const Rect &area) {
	node_.mark_instances_changed(layer, area);
	node_.display().mark_later(layer, area);
}

void TerrainScatter3D::Host::redraw_all_later() {
	node_.mark_all_instances_changed();
	node_.display().mark_all_later();
}

void TerrainScatter3D::Host::redraw_all() {
	node_.mark_all_instances_changed();
	node_.display().mark_all();
	node_.schedule_patch();
}

void TerrainScatter3D::Host::set_hidden(std::uint32_t layer, std::uint64_t id, const Rect &area, bool hidden) {
	node_.display().set_hidden(layer, id, area, hidden);
	node_.schedule_patch();
}

/// Updates the display once for all changes of this frame, before the frame is drawn.
void TerrainScatter3D::schedule_patch() {
	if (is_running_ && !std::exchange(patch_scheduled_, true)) {
		call_deferred("_patch");
	}
}

void TerrainScatter3D::patch_now() {
	patch_scheduled_ = false;
	display().patch();
}

} // namespace thicket
