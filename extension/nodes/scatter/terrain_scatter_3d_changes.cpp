// This file applies changes to settings, layers, ground and regions of a TerrainScatter3D, starting
// in the next frame.

#include "nodes/scatter/terrain_scatter_3d.hpp"

#include "core/base/tile_grid.hpp"
#include "nodes/common/editor.hpp"
#include "nodes/layer/layer_reference.hpp"
#include "nodes/workers/build_at_once.hpp"
#include "nodes/workers/shared_builder.hpp"

#include <glm/common.hpp>

#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

/// The distance in meters around a ground change within which slopes may change. It exceeds the
/// distance over which slopes compare heights.
constexpr double slope_margin = 1.0;

/// Expands a single changed position by this many meters, because an empty rectangle means no
/// change.
constexpr double point_margin = 1e-3;

/// Converts a rectangle. Returns the whole world if it is empty or not finite.
Rect world_rect(const Rect2 &p_rect) {
	constexpr double infinity = std::numeric_limits<double>::infinity();
	const glm::dvec2 corner{p_rect.position.x, p_rect.position.y};
	const glm::dvec2 other = corner + glm::dvec2{p_rect.size.x, p_rect.size.y};
	const Rect rect{glm::min(corner, other), glm::max(corner, other)};
	return rect.empty() || !rect.finite() ? Rect{glm::dvec2(-infinity), glm::dvec2(infinity)} : rect;
}

/// Adds a TileOrder for each tile whose layer exists. Returns, for each order, the index of its
/// tile in `tiles`.
std::vector<std::size_t> order_tiles(
		std::span<const SharedSnapshot> layers, std::span<const WorldTile> tiles, std::vector<TileOrder> &r_orders) {
	std::vector<std::size_t> tile_indices;
	for (std::size_t i = 0; i < tiles.size(); ++i) {
		const SharedSnapshot layer = tiles[i].layer < layers.size() ? layers[tiles[i].layer] : nullptr;
		if (layer != nullptr) {
			r_orders.push_back({layer->settings, tile_space(layer->range.tile_size, tiles[i].tile, tiles[i].slab)});
			tile_indices.push_back(i);
		}
	}
	return tile_indices;
}

} // namespace

void TerrainScatter3D::mark_edited() {
	is_dirty_ = true;
	was_settled_ = false;
}

/// Records an area in which a layer's instances have changed, so that layers that grow on their
/// models are regenerated there. Does nothing if no layer grows on them.
void TerrainScatter3D::mark_instances_changed(std::uint32_t layer, const Rect &area) {
	if (layer_list_.is_host(layer)) {
		state_edits_.areas[layer].add(area, point_margin);
		mark_edited();
	}
}

void TerrainScatter3D::mark_all_instances_changed() {
	if (layer_list_.has_hosts()) {
		state_edits_.everywhere = true;
		mark_edited();
	}
}

/// Schedules an update after a change to the settings or the list of layers. Assigns missing layer IDs.
void TerrainScatter3D::mark_dirty() {
	const std::shared_ptr<ScatterGameplay> gameplay = gameplay_;
	const std::shared_ptr<LayerWatch> watch = layer_watch_;
	const TypedArray<ScatterLayer> layers = all_layers();
	// Undo may keep a node outside the tree. Such a node must not assign IDs to layers that other
	// nodes share.
	const bool may_assign_ids = is_inside_tree() || !was_inside_;
	// Assigning an ID emits a signal, so scripts may free this node.
	watch->update(layers, node_layers_.own_count(), may_assign_ids);
	const std::vector<LayerRename> renames = gameplay->alive() ? watch->follow_names() : std::vector<LayerRename>();
	if (!gameplay->alive()) {
		return;
	}
	for (const LayerRename &rename : renames) {
		change_references(renaming_layer(rename.from, rename.to));
		if (!gameplay->alive()) {
			return;
		}
	}
	mark_edited();
	use_resources();
	update_configuration_warnings();
	PackedStringArray names;
	const TypedArray<ScatterLayer> current_layers = all_layers();
	for (int64_t index = 0; index < current_layers.size(); ++index) {
		const Ref<ScatterLayer> layer = current_layers[index];
		names.push_back(layer.is_valid() ? layer->get_name() : String());
	}
	if (!(names == layer_names_)) {
		layer_names_ = names;
		regions_.update_warnings(); // Their warnings may contain layer names.
	}
}

/// Changes references in layers and regions. Emits signals, so scripts may free the node.
void TerrainScatter3D::change_references(const ReferenceChange &change) {
	const std::shared_ptr<ScatterGameplay> gameplay = gameplay_;
	const std::shared_ptr<LayerWatch> watch = layer_watch_;
	watch->change_references(change);
	if (gameplay->alive()) {
		regions_.change_references(change);
	}
}

/// Marks resources as used while the node is in the tree. The main thread reads these resources
/// every frame, so other threads may not modify them.
void TerrainScatter3D::use_resources() {
	if (!is_running_) {
		return;
	}
	SceneUse::List used_resources;
	if (ground_.is_valid()) {
		ground_->add_used(used_resources);
	}
	used_resources.add(get_state());
	used_resources.add(biomes_);
	if (biomes_.is_valid()) {
		biomes_->add_used(used_resources);
	}
	const TypedArray<ScatterLayer> &layers = all_layers();
	for (int64_t index = 0; index < layers.size(); ++index) {
		if (const Ref<ScatterLayer> layer = layers[index]; layer.is_valid()) {
			used_resources.add(layer);
			layer->add_used(used_resources);
		}
	}
	scene_use_.replace(std::move(used_resources));
}

/// Checks for changes that scripts have made to the shared lists of layers and biomes without
/// calling a setter.
void TerrainScatter3D::check_layers() {
	const std::shared_ptr<ScatterGameplay> gameplay = gameplay_;
	if (const Ref<ScatterBiomeMap> biomes = biomes_; biomes.is_valid()) {
		biomes->detect_changes(); // Emits signals, so scripts may free this node.
	}
	if (gameplay->alive() && layer_watch_->differs(all_layers())) {
		mark_dirty();
	}
}

void TerrainScatter3D::mark_ground_dirty() {
	ground_change_.everywhere = true;
	mark_dirty();
}

void TerrainScatter3D::regenerate() {
	if (ground_.is_valid()) {
		ground_->search_again();
	}
	const TypedArray<ScatterLayer> layers = all_layers();
	for (int64_t index = 0; index < layers.size(); ++index) {
		if (const Ref<ScatterLayer> layer = layers[index]; layer.is_valid()) {
			layer->distrust_density_rules();
		}
	}
	mark_ground_dirty();
}

void TerrainScatter3D::refresh_ground() {
	if (ground_.is_null() || !ground_->reread()) {
		regenerate();
	}
}

void TerrainScatter3D::mark_ground_edited(const Rect2 &p_rect) {
	if (ground_.is_valid()) {
		ground_->search_again();
	}
	const Rect rect = world_rect(p_rect);
	ground_change_.everywhere = ground_change_.everywhere || !rect.finite();
	ground_change_.add(rect, slope_margin);
	mark_edited();
}

/// Regenerates the tile where a re-check has found a change. Other tiles have their own re-checks.
void TerrainScatter3D::mark_ground_changed(glm::dvec2 position) {
	ground_change_.add({position, position}, point_margin);
	mark_edited();
}

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

/// Applies all changes since the last call. If that fails, all tiles are regenerated later.
void TerrainScatter3D::refresh() {
	const std::shared_ptr<ScatterGameplay> gameplay = gameplay_;
	is_dirty_ = false;
	try {
		apply_changes();
	} catch (...) {
		// The changed areas may be lost, so let the next frame regenerate all tiles.
		if (gameplay->alive()) {
			ground_change_.everywhere = true;
			state_edits_.everywhere = true;
			mark_edited();
		}
		throw;
	}
}

/// Passes the changed layers, ground and regions to the stream and the gameplay. Runs scripts.
void TerrainScatter3D::apply_changes() {
	const std::shared_ptr<ScatterGameplay> gameplay = gameplay_;
	const std::shared_ptr<ScatterStream> stream = stream_;
	const Ref<ScatterGround> ground = ground_;
	set_physics_process_internal(ground.is_valid() && ground->needs_physics_frames());
	const bool is_pending = ground.is_valid() && ground->is_pending(get_instance_id());
	const EditedArea ground_change = is_pending ? EditedArea() : std::exchange(ground_change_, {});
	std::shared_ptr<const Terrain> former_terrain;
	if (!ground_change.empty() && ground.is_valid()) {
		// This call and `change_references` below may run scripts, so check afterward that the node
		// still exists.
		std::shared_ptr<const Terrain> terrain = ground->snapshot(get_instance_id());
		if (!gameplay->alive() || !(ground == ground_)) {
			return;
		}
		former_terrain = std::exchange(ground_snapshot_, std::move(terrain));
	}
	change_references(naming_layers(all_layers()));
	if (!gameplay->alive()) {
		return;
	}
	const bool has_ground = ground.is_valid() && (ground_snapshot_ != nullptr || ground->is_main_thread_only());
	if (!gameplay->alive() || !(ground == ground_)) {
		return;
	}
	if (const Planet current_planet = planet(); std::exchange(region_planet_, current_planet) != current_planet) {
		regions_.mark_all();
	}
	const bool was_recentered = std::exchange(was_recentered_, false);
	regions_.update(was_recentered);
	warn_of_stripped();
	if (!gameplay->alive()) {
		return;
	}
	if (!has_ground || all_layers().is_empty()) {
		layer_list_.clear();
		gameplay->retire();
		stream->retire();
		return;
	}
	const StateEdits state_edits = std::exchange(state_edits_, {});
	row_paths_.begin_update(*this, *this, was_recentered);
	const std::vector<EditedArea> outdated_areas =
			layer_list_.update(node_layers_, layer_world(state_edits), ground_change);
	row_paths_.end_update();
	if (former_layers_ == nullptr) {
		former_layers_ = gameplay->listed_layers();
	}
	gameplay->set_layers(std::make_shared<const ListedLayers>(node_layers_.by_index()), layer_list_.snapshots(),
			outdated_areas, tile_maker());
	stream->set_layers(layer_list_.snapshots(), outdated_areas, {ground_snapshot_, {ground_, get_instance_id()}});
	fade_viewers_.set_layers(layer_list_.snapshots());
	wind_time_.set_layers(layer_list_.snapshots());
	instance_load_.forget();
	check_load();
	if (former_terrain != nullptr && former_terrain != ground_snapshot_) {
		stream->free_on_worker(std::move(former_terrain));
	}
}

/// Returns true if a pending ground change can now be applied, because the ground has been read.
bool TerrainScatter3D::waits_for_ground() const {
	return !ground_change_.empty() && ground_.is_valid() && !ground_->is_pending(get_instance_id());
}

LayerWorld TerrainScatter3D::layer_world(const StateEdits &state_edits) {
	static const LayerPreviews no_previews;
	const Planet planet = this->planet();
	const GroundShell shell =
			planet.exists() ? ground_->shell(get_instance_id(), planet).widened() : GroundShell::everywhere();
	return {static_cast<std::uint64_t>(seed_), water_enabled_ ? water_level_ : no_water, biomes_, regions_, row_paths_,
			in_editor() ? previews_ : no_previews, planet, shell, state_edits, get_state()};
}

/// Returns a function that generates tiles synchronously. Captures by value, so that scripts that
/// sample the ground cannot change its data.
TileMaker TerrainScatter3D::tile_maker() const {
	return [layers = layer_list_.snapshots(), terrain = ground_snapshot_, builder = synchronous_builder_,
				   ground = HostedGround{ground_, get_instance_id()}](std::span<const WorldTile> tiles,
				   std::vector<std::shared_ptr<const CompactTile>> &r_tiles) -> Status {
		r_tiles.assign(tiles.size(), nullptr);
		if (!ground.is_available()) {
			return {};
		}
		std::vector<TileOrder> orders;
		const std::vector<std::size_t> tile_indices = order_tiles(layers, tiles, orders);
		std::vector<std::shared_ptr<const CompactTile>> generated;
		const Status status = builder->build_all(orders, terrain.get(), ground, generated);
		for (std::size_t i = 0; i < generated.size(); ++i) {
			r_tiles[tile_indices[i]] = std::move(generated[i]);
		}
		return status;
	};
}

/// Returns a function that generates tiles on any thread, without reading the scene. Runs only
/// thread-safe ground scripts.
TileMaker TerrainScatter3D::worker_tile_maker() const {
	return [layers = layer_list_.snapshots(), terrain = ground_snapshot_, builder = std::make_shared<SharedBuilder>(),
				   is_available = ground_.is_valid() && ground_->is_available()](std::span<const WorldTile> tiles,
				   std::vector<std::shared_ptr<const CompactTile>> &r_tiles) -> Status {
		r_tiles.assign(tiles.size(), nullptr);
		if (!is_available) {
			return {};
		}
		if (terrain == nullptr) {
			return Status::missing("thread_safe_ground",
					"The ground can only be sampled on the main thread (a script that is not thread-safe, or "
					"colliders), so the snapshot contains only the tiles that were loaded when it was created. Use "
					"request_rect() or request_sphere()");
		}
		std::vector<TileOrder> orders;
		const std::vector<std::size_t> tile_indices = order_tiles(layers, tiles, orders);
		Status status;
		if (std::ranges::any_of(orders, [](const TileOrder &order) { return needs_main_thread(*order.layer); })) {
			return Status::missing("thread_safe_rule",
					"A rule in ScatterLayer.density_rules can only be called on the main thread, so the snapshot "
					"contains only the tiles that were loaded when it was created. Let its _is_thread_safe() return "
					"true, or use request_rect() or request_sphere()");
		}
		for (std::size_t i = 0; status.ok() && i < orders.size(); ++i) {
			status = builder->build(orders[i], *terrain, r_tiles[tile_indices[i]]);
		}
		return status;
	};
}

} // namespace thicket
