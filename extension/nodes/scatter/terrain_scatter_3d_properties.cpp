// This file contains the properties and simple methods of TerrainScatter3D for scripts.

#include "nodes/scatter/terrain_scatter_3d.hpp"

#include "core/base/tile_grid.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/engine_arrays.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/common/relative_transform.hpp"
#include "nodes/common/watch.hpp"
#include "nodes/gameplay/instance_answers.hpp"
#include "nodes/ground/former_grounds.hpp"
#include "nodes/layer/layer_reference.hpp"
#include "nodes/scatter/scatter_problems.hpp"
#include "nodes/workers/build_at_once.hpp"

#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/memory.hpp>

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <utility>

using namespace godot;

namespace thicket {

void TerrainScatter3D::set_seed(int64_t p_seed) {
	if (std::exchange(seed_, p_seed) != p_seed) {
		mark_dirty();
	}
}

void TerrainScatter3D::set_layers(const TypedArray<ScatterLayer> &p_layers) {
	layers_ = p_layers;
	mark_dirty();
}

void TerrainScatter3D::set_biomes(const Ref<ScatterBiomeMap> &p_biomes) {
	if (biomes_ == p_biomes) {
		// The biomes are unchanged.
		return;
	}
	watch(biomes_.ptr(), "changed", this, "_mark_dirty", false);
	biomes_ = p_biomes;
	watch(biomes_.ptr(), "changed", this, "_mark_dirty", true);
	mark_dirty();
}

void TerrainScatter3D::set_water_enabled(bool p_enabled) {
	if (std::exchange(water_enabled_, p_enabled) != p_enabled) {
		notify_property_list_changed();
		mark_dirty();
	}
}

void TerrainScatter3D::set_water_level(double p_level) {
	constexpr double limit = ScatterBiome::max_water_level;
	if (accept_number(class_name, "water_level", p_level, -limit, limit) &&
			std::exchange(water_level_, p_level) != p_level) {
		mark_dirty();
	}
}

void TerrainScatter3D::watch_ground(bool p_watch) {
	watch(ground_.ptr(), "changed", this, "_mark_ground_dirty", p_watch);
	watch(ground_.ptr(), "ground_changed", this, "_mark_ground_edited", p_watch);
}

void TerrainScatter3D::set_ground(const Ref<ScatterGround> &p_ground) {
	const Ref<ScatterGround> ground = current_ground(p_ground);
	if (ground_ == ground) {
		// The ground is unchanged.
		return;
	}
	watch_ground(false);
	if (is_running_ && ground_.is_valid()) {
		ground_->leave(this);
	}
	ground_ = ground;
	ground_snapshot_ = nullptr;
	if (is_running_ && ground_.is_valid()) {
		ground_->enter(this, frame_);
	}
	watch_ground(true);
	mark_ground_dirty();
}

void TerrainScatter3D::set_state(const Ref<ScatterState> &p_state) {
	const std::shared_ptr<ScatterGameplay> gameplay = gameplay_;
	gameplay->set_state(p_state);
	if (gameplay->alive()) {
		use_resources();
	}
}

void TerrainScatter3D::set_viewers(const TypedArray<NodePath> &p_viewers) {
	viewers_.paths = p_viewers;
	update_configuration_warnings();
}

void TerrainScatter3D::set_viewer_distance_scales(const PackedFloat32Array &p_scales) {
	for (int64_t viewer = 0; viewer < p_scales.size(); ++viewer) {
		const String name = "viewer_distance_scales[" + String::num_int64(viewer) + "]";
		if (!accept_number(class_name, name.utf8().get_data(), p_scales.ptr()[viewer], 0.0, 1e6)) {
			return;
		}
	}
	viewers_.distance_scales = p_scales;
}

void TerrainScatter3D::set_world_offset(const Vector3 &p_offset) {
	for (const real_t meters : {p_offset.x, p_offset.y, p_offset.z}) {
		if (!accept_number(class_name, "world_offset", meters, -1e12, 1e12)) {
			return;
		}
	}
	const glm::dvec3 offset{p_offset.x, p_offset.y, p_offset.z};
	if (offset == world_offset_) {
		// The offset is unchanged.
		return;
	}
	world_offset_ = offset;
	was_recentered_ = !local_coords_;
	check_transform();
	move_world();
	if (!local_coords_ && regions_.mark_all()) {
		// Regions that have not moved with the scene now have another world position.
		mark_edited();
	}
}

Vector3 TerrainScatter3D::get_world_offset() const { return to_engine(world_offset_); }

void TerrainScatter3D::set_local_coords(bool p_local) {
	if (std::exchange(local_coords_, p_local) == p_local) {
		return;
	}
	check_transform();
	move_world();
	update_configuration_warnings();
	regions_.mark_all();
	mark_ground_dirty();
}

Transform3D TerrainScatter3D::transform_of(const Node3D &p_node) const {
	return local_coords_ && is_inside_tree() ? relative_transform(*this, p_node) : p_node.get_global_transform();
}

/// Moves everything that is drawn, and all bodies and scenes, to the current position of the world.
void TerrainScatter3D::move_world() {
	WorldFrame frame{.offset = world_offset_};
	if (local_coords_) {
		const Transform3D transform = is_inside_tree() ? get_global_transform() : Transform3D();
		frame = is_finite(transform) ? WorldFrame::of_local_space(to_core(transform.basis), to_core(transform.origin))
									 : frame_;
	}
	if (frame == frame_) {
		return;
	}
	frame_ = frame;
	display().set_world_frame(frame);
	gameplay()->set_world_frame(frame);
	if (ground_.is_valid()) {
		ground_->set_world_frame(this, frame);
	}
}

void TerrainScatter3D::set_frame_budget_usec(int64_t p_budget) {
	if (accept_number(class_name, "frame_budget_usec", static_cast<double>(p_budget), 1.0, 1e6)) {
		frame_budget_usec_ = p_budget;
	}
}

void TerrainScatter3D::set_quality(double p_quality) {
	if (accept_number(class_name, "quality", p_quality, 0.0, 1.0)) {
		quality_ = p_quality;
	}
}

void TerrainScatter3D::set_preview_instances(int64_t p_count) {
	if (accept_number(class_name, "preview_instances", static_cast<double>(p_count), 0.0, 1e9)) {
		preview_instances_ = p_count;
	}
}

void TerrainScatter3D::set_max_multimeshes(int64_t p_count) {
	if (accept_number(class_name, "max_multimeshes", static_cast<double>(p_count), 0.0, 1e6)) {
		max_multimeshes_ = p_count;
	}
}

int64_t TerrainScatter3D::get_body_instance(const RID &p_body) const {
	return script_id(gameplay_->collision().instance_of(p_body));
}

Node3D *TerrainScatter3D::get_scene(int64_t p_id) const { return gameplay_->scenes().find(core_id(p_id)); }

Node3D *TerrainScatter3D::take_scene(int64_t p_id) { return gameplay()->scenes().take(core_id(p_id)); }

bool TerrainScatter3D::find_layer_index(const char *p_method, const Variant &p_layer, std::uint32_t &r_index) const {
	const String problem = find_layer(all_layers(), p_layer, r_index);
	if (!problem.is_empty()) {
		ERR_PRINT(String(class_name) + String(".") + String(p_method) + String(": ") + problem);
	}
	return problem.is_empty();
}

TypedArray<Vector2i> TerrainScatter3D::get_shown_tiles(const Variant &p_layer) const {
	TypedArray<Vector2i> result;
	std::uint32_t layer = 0;
	if (find_layer_index("get_shown_tiles", p_layer, layer)) {
		for (const glm::ivec2 &tile : display().tiles(layer)) {
			append(result, Vector2i(tile.x, tile.y));
		}
	}
	return result;
}

int64_t TerrainScatter3D::get_shown_count(const Variant &p_layer) const {
	std::uint32_t layer = 0;
	return find_layer_index("get_shown_count", p_layer, layer) ? static_cast<int64_t>(display().instance_count(layer))
															   : 0;
}

void TerrainScatter3D::set_preview_stand_in(const Ref<ScatterLayer> &p_layer, const Ref<ScatterLayer> &p_stand_in) {
	previews_.set_stand_in(p_layer, p_stand_in);
	mark_edited();
}

Ref<ScatterTile> TerrainScatter3D::get_tile(const Variant &p_layer, const Vector2i &p_tile) {
	std::uint32_t layer = 0;
	if (!find_layer_index("get_tile", p_layer, layer)) {
		return memnew(ScatterTile);
	}
	while (display().patch_step()) { // Apply pending changes first: the result is the content as drawn.
	}
	display().patch();
	move_world();
	const std::shared_ptr<const TileDisplay> display(stream_, &stream_->display());
	return ScatterTile::from_display(display, layer, {p_tile.x, p_tile.y}, frame_);
}

Ref<ScatterTile> TerrainScatter3D::build_rect(const Variant &p_layer, const Rect2 &p_rect) {
	return build("build_rect", p_layer, [rect = to_world(p_rect, frame_)](const LayerSnapshot &) { return rect; });
}

Ref<ScatterTile> TerrainScatter3D::build_tile(const Variant &p_layer, const Vector2i &p_tile, const Rect2 &p_rect) {
	return build("build_tile", p_layer, [&](const LayerSnapshot &layer) {
		const Rect square = tile_rect(layer.range.tile_size, {p_tile.x, p_tile.y});
		return p_rect == Rect2() ? square : intersection(square, to_world(p_rect, frame_));
	});
}

/// Generates the instances in the world rectangle that `rect_of` returns for the layer.
Ref<ScatterTile> TerrainScatter3D::build(
		const char *p_method, const Variant &p_layer, const std::function<Rect(const LayerSnapshot &)> &rect_of) {
	const std::shared_ptr<ScatterGameplay> gameplay = gameplay_;
	move_world();
	const WorldFrame frame = frame_;
	std::uint32_t layer = 0;
	if (!find_layer_index(p_method, p_layer, layer)) {
		return memnew(ScatterTile);
	}
	Status status = prepare();
	SharedSnapshot snapshot;
	if (status.ok()) {
		snapshot = layer < layer_list_.snapshots().size() ? layer_list_.snapshots()[layer] : nullptr;
		status = !ground_->is_available() ? Status::missing("ground", "Set TerrainScatter3D.ground")
				: snapshot == nullptr     ? refused_layer()
										  : Status{};
	}
	const Rect rect = status.ok() ? rect_of(*snapshot) : Rect();
	CompactTile tile;
	if (status.ok() && gameplay->alive()) {
		const HostedGround ground{
				ground_, get_instance_id()}; // Use a copy, because a script that samples the ground may free this node.
		const std::shared_ptr<const Terrain> terrain = ground_snapshot_;
		const std::shared_ptr<SynchronousBuilder> builder = synchronous_builder_;
		TileInstances generated;
		status = builder->build(*snapshot->settings, terrain.get(), ground, rect, generated);
		tile = CompactTile(generated, snapshot->settings);
	}
	if (const Ref<ScatterState> state = gameplay->get_state(); status.ok() && state.is_valid()) {
		status = apply_state(*snapshot->settings, rect, state->state(), tile);
	}
	report((std::string("TerrainScatter3D.") + p_method).c_str(), status,
			snapshot != nullptr ? density_rule_problem(*snapshot->settings, status) : "");
	return status.ok() ? ScatterTile::from_tile(std::move(tile), snapshot->drawing.finest_meshes(), frame)
					   : Ref<ScatterTile>(memnew(ScatterTile));
}

/// Returns the microseconds of each part that took any time.
Dictionary TerrainScatter3D::to_dictionary(const FrameTimes &times) {
	constexpr std::array<const char *, static_cast<std::size_t>(FramePart::count)> names{"follow", "gameplay", "made",
			"wanted", "query_ground", "upload", "free", "lod", "divide", "fade", "rings", "recheck", "told", "patched",
			"signals"};
	Dictionary parts;
	for (std::size_t part = 0; part < names.size(); ++part) {
		if (const std::int64_t microseconds = times.microseconds(static_cast<FramePart>(part)); microseconds > 0) {
			parts[names[part]] = microseconds;
		}
	}
	return parts;
}

Dictionary TerrainScatter3D::get_stats() const {
	const StreamCounts counts = stream_->counts();
	const StreamFigures &figures = stream_->figures();
	const auto to_integer = [](std::uint64_t value) {
		return static_cast<int64_t>(value);
	};
	Dictionary stats;
	stats["tiles"] = to_integer(display().tile_count());
	stats["instances"] = to_integer(display().instance_count());
	stats["instance_bytes"] = to_integer(display().instance_bytes());
	stats["drawn"] = to_integer(display().drawn_count());
	stats["multimeshes"] = to_integer(display().multimesh_count());
	stats["multimeshes_leaving"] = to_integer(display().leaving_count());
	stats["uploads"] = to_integer(display().upload_count());
	stats["redrawn"] = to_integer(display().redrawn_count());
	stats["lod_looks"] = to_integer(display().draw_count());
	stats["waiting"] = to_integer(counts.waiting);
	stats["pending"] = to_integer(counts.pending);
	stats["uploading"] = to_integer(stream_->upload_queue_size());
	stats["scenes"] = to_integer(gameplay_->scenes().displayed_count());
	stats["scenes_pooled"] = to_integer(gameplay_->scenes().idle_count());
	stats["frame_usec"] =
			static_cast<int64_t>(std::chrono::duration_cast<std::chrono::microseconds>(frame_time_).count());
	stats["frame_parts"] = to_dictionary(stream_->times());
	stats["bodies"] = to_integer(gameplay_->collision().body_count());
	stats["bodies_pooled"] = to_integer(gameplay_->collision().pooled_count());
	stats["tiles_made"] = to_integer(figures.tiles_made);
	stats["points_sampled"] = to_integer(figures.points_sampled);
	stats["points_computed"] = to_integer(figures.points_computed + synchronous_builder_->points_computed());
	const GroundFigures ground = ground_.is_valid() ? ground_->figures() : GroundFigures();
	stats["ground_checks"] = to_integer(ground.checks);
	stats["ground_reads"] = to_integer(ground.reads);
	stats["ground_rechecks"] = to_integer(figures.heights_rechecked);
	stats["worker_usec"] = to_integer(figures.worker_microseconds);
	stats["worker_frees"] = to_integer(stream_->freed_by_workers());
	stats["buffers_reused"] = to_integer(stream_->buffers_reused());
	return stats;
}

Dictionary TerrainScatter3D::get_draw_stats(Camera3D *p_camera) const {
	std::optional<ViewVolume> view;
	if (p_camera != nullptr) {
		if (!p_camera->is_inside_tree()) {
			ERR_PRINT("TerrainScatter3D.get_draw_stats: camera must be in the scene tree. Add it to the tree first.");
			return Dictionary();
		}
		view = view_of(*p_camera, frame_);
	}
	DrawCounter counter(view);
	display().count_drawn(counter);
	const DrawFigures &figures = counter.figures();
	Dictionary stats;
	stats["multimeshes"] = static_cast<int64_t>(figures.multimeshes);
	stats["instances"] = static_cast<int64_t>(figures.instances);
	stats["triangles"] = static_cast<int64_t>(figures.triangles);
	stats["draw_calls"] = static_cast<int64_t>(figures.draw_calls);
	return stats;
}

PackedStringArray TerrainScatter3D::get_problems() const {
	PackedStringArray problems;
	const std::shared_ptr<ScatterGameplay> gameplay = gameplay_;
	read_models(std::chrono::steady_clock::time_point::max());
	if (!gameplay->alive()) {
		return problems;
	}
	add_ground_problems(ground_, problems);
	for (const String &failure : stream_->failures()) {
		problems.push_back(failure);
	}
	TypedArray<ScatterLayer> layers;
	const TypedArray<ScatterLayer> &by_index = all_layers();
	for (const std::size_t index : node_layers_.order()) {
		append(layers, by_index[static_cast<int64_t>(index)]);
	}
	bool has_water = water_enabled_;
	if (const Ref<ScatterBiomeMap> biomes = biomes_; biomes.is_valid()) {
		has_water = has_water || biomes->has_own_water();
		for (const String &problem : biomes->problems(layers_)) {
			problems.push_back(problem);
		}
	}
	add_layer_problems(layers, ground_, has_water, biomes_.ptr(), problems);
	layer_list_.add_host_problems(problems);
	layer_list_.add_row_problems(row_paths_, problems);
	instance_load_.add_problems(layer_list_.snapshots(), problems);
	add_uniform_problem(display(), layer_list_.snapshots(), problems);
	if (const Ref<ScatterState> state = get_state(); state.is_valid()) {
		if (const Status status = gameplay_->check_state(*state.ptr()); !status.ok()) {
			problems.push_back(
					sentence("TerrainScatter3D", status) + String(". Its removals apply to other instances."));
		}
	}
	add_viewer_problems(*this, viewers_, stream_->viewer_status(), problems);
	if (local_coords_) {
		add_local_problems(*this, ground_, problems);
	} else {
		add_transform_problem(*this, world_offset_, problems);
	}
	return problems;
}

} // namespace thicket
