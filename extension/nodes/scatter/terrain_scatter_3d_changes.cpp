// How a TerrainScatter3D follows changes of settings, layers, ground and regions, from the next frame on.

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

/// Meters around a change of the ground in which slopes may change, because slopes compare heights over a smaller
/// distance.
constexpr double slope_margin = 1.0;

/// Meters around a single position that represent it, because a rectangle without an area is no change.
constexpr double point_margin = 1e-3;

/// A rectangle of the engine; the whole world for one without an area, or that is not finite.
Rect world_rect(const Rect2 &p_rect) {
	constexpr double infinity = std::numeric_limits<double>::infinity();
	const glm::dvec2 corner{p_rect.position.x, p_rect.position.y};
	const glm::dvec2 other = corner + glm::dvec2{p_rect.size.x, p_rect.size.y};
	const Rect rect{glm::min(corner, other), glm::max(corner, other)};
	return rect.empty() || !rect.finite() ? Rect{glm::dvec2(-infinity), glm::dvec2(infinity)} : rect;
}

/// Adds an order for each tile of an existing layer. Returns the tile index of each order.
std::vector<std::size_t> order_tiles(
		std::span<const SharedSnapshot> layers, std::span<const WorldTile> tiles, std::vector<TileOrder> &r_orders) {
	std::vector<std::size_t> ordered;
	for (std::size_t i = 0; i < tiles.size(); ++i) {
		const SharedSnapshot layer = tiles[i].layer < layers.size() ? layers[tiles[i].layer] : nullptr;
		if (layer != nullptr) {
			r_orders.push_back({layer->settings, tile_rect(layer->range.tile_size, tiles[i].tile)});
			ordered.push_back(i);
		}
	}
	return ordered;
}

} // namespace

void TerrainScatter3D::mark_edited() {
	dirty_ = true;
	was_settled_ = false;
}

void TerrainScatter3D::mark_dirty() {
	const std::shared_ptr<ScatterGameplay> gameplay = gameplay_;
	const std::shared_ptr<LayerWatch> watch = layer_watch_;
	const TypedArray<ScatterLayer> layers = all_layers();
	// A node that was taken out of the tree, as undo does, does not change layers that others share.
	const bool gives = is_inside_tree() || !was_inside_;
	// Layers that get an ID emit a signal to scripts, which may free this node.
	watch->look(layers, node_layers_.own_count(), gives);
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
	const TypedArray<ScatterLayer> named = all_layers();
	for (int64_t index = 0; index < named.size(); ++index) {
		const Ref<ScatterLayer> layer = named[index];
		names.push_back(layer.is_valid() ? layer->get_name() : String());
	}
	if (!(names == layer_names_)) {
		layer_names_ = names;
		regions_.update_warnings(); // Warnings may name layers.
	}
}

/// In the layers and in the regions. Scripts that hear of it may free the node.
void TerrainScatter3D::change_references(const ReferenceChange &change) {
	const std::shared_ptr<ScatterGameplay> gameplay = gameplay_;
	const std::shared_ptr<LayerWatch> watch = layer_watch_;
	watch->change_references(change);
	if (gameplay->alive()) {
		regions_.change_references(change);
	}
}

/// While the node is in the tree, only the main thread may change the resources that it reads in its frames.
void TerrainScatter3D::use_resources() {
	if (!running_) {
		return;
	}
	SceneUse::List used;
	used.add(ground_);
	used.add(get_state());
	used.add(biomes_);
	if (biomes_.is_valid()) {
		biomes_->add_used(used);
	}
	const TypedArray<ScatterLayer> &layers = all_layers();
	for (int64_t index = 0; index < layers.size(); ++index) {
		if (const Ref<ScatterLayer> layer = layers[index]; layer.is_valid()) {
			used.add(layer);
			layer->add_used(used);
		}
	}
	used_.replace(std::move(used));
}

/// Scripts share the lists of layers and biomes, and may change them without a setter.
void TerrainScatter3D::notice_layers() {
	const std::shared_ptr<ScatterGameplay> gameplay = gameplay_;
	if (const Ref<ScatterBiomeMap> biomes = biomes_; biomes.is_valid()) {
		biomes->notice(); // Notifies scripts, which may free this node.
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
		ground_->look_again();
	}
	mark_ground_dirty();
}

void TerrainScatter3D::refresh_ground() {
	if (ground_.is_null() || !ground_->read_again()) {
		regenerate();
	}
}

void TerrainScatter3D::mark_ground_edited(const Rect2 &p_rect) {
	if (ground_.is_valid()) {
		ground_->look_again();
	}
	const Rect rect = world_rect(p_rect);
	ground_change_.everywhere = ground_change_.everywhere || !rect.finite();
	ground_change_.add(rect, slope_margin);
	mark_edited();
}

/// Found by a re-check. The tile there is regenerated; other tiles have their own heights to compare.
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

void TerrainScatter3D::refresh() {
	const std::shared_ptr<ScatterGameplay> gameplay = gameplay_;
	dirty_ = false;
	try {
		apply_changes();
	} catch (...) {
		// The areas that have changed may be lost by now, so the next frame regenerates all tiles.
		if (gameplay->alive()) {
			ground_change_.everywhere = true;
			mark_edited();
		}
		throw;
	}
}

void TerrainScatter3D::apply_changes() {
	const std::shared_ptr<ScatterGameplay> gameplay = gameplay_;
	const std::shared_ptr<ScatterStream> stream = stream_;
	const Ref<ScatterGround> ground = ground_;
	set_physics_process_internal(ground.is_valid() && ground->needs_physics_frames());
	const bool pending = ground.is_valid() && ground->is_pending(get_instance_id());
	const EditedArea ground_change = pending ? EditedArea() : std::exchange(ground_change_, {});
	std::shared_ptr<const Terrain> former;
	if (!ground_change.empty() && ground.is_valid()) {
		std::shared_ptr<const Terrain> terrain =
				ground->snapshot(get_instance_id()); // Calls scripts, and so does the next call.
		if (!gameplay->alive() || !(ground == ground_)) {
			return;
		}
		former = std::exchange(ground_snapshot_, std::move(terrain));
	}
	change_references(naming_layers(all_layers()));
	if (!gameplay->alive()) {
		return;
	}
	const bool grounded = ground.is_valid() && (ground_snapshot_ != nullptr || ground->is_main_thread_only());
	if (!gameplay->alive() || !(ground == ground_)) {
		return;
	}
	regions_.update(std::exchange(recentered_, false));
	warn_of_stripped();
	if (!gameplay->alive()) {
		return;
	}
	if (!grounded || all_layers().is_empty()) {
		layer_list_.clear();
		gameplay->retire();
		stream->retire();
		return;
	}
	const std::vector<EditedArea> outdated = layer_list_.update(node_layers_, layer_world(), ground_change);
	if (former_layers_ == nullptr) {
		former_layers_ = gameplay->listed_layers();
	}
	gameplay->set_layers(std::make_shared<const ListedLayers>(node_layers_.by_index()), layer_list_.snapshots(),
			outdated, tile_maker());
	stream->set_layers(layer_list_.snapshots(), outdated, {ground_snapshot_, {ground_, get_instance_id()}});
	fade_viewers_.set_layers(layer_list_.snapshots());
	wind_time_.set_layers(layer_list_.snapshots());
	instance_load_.forget();
	notice_load();
	if (former != nullptr && former != ground_snapshot_) {
		stream->let_go(std::move(former));
	}
}

/// Whether ground that was still being read is now available.
bool TerrainScatter3D::waits_for_ground() const {
	return !ground_change_.empty() && ground_.is_valid() && !ground_->is_pending(get_instance_id());
}

LayerWorld TerrainScatter3D::layer_world() {
	static const LayerPreviews none;
	return {static_cast<std::uint64_t>(seed_), water_enabled_ ? water_level_ : no_water, biomes_, regions_,
			in_editor() ? previews_ : none};
}

/// Generates tiles for callers that cannot wait. Captures by value, so that scripts that are called for the ground cannot affect it.
TileMaker TerrainScatter3D::tile_maker() const {
	return [layers = layer_list_.snapshots(), terrain = ground_snapshot_, builder = at_once_,
				   ground = HostedGround{ground_, get_instance_id()}](std::span<const WorldTile> tiles,
				   std::vector<std::shared_ptr<const CompactTile>> &r_tiles) -> Status {
		r_tiles.assign(tiles.size(), nullptr);
		if (!ground.is_available()) {
			return {};
		}
		std::vector<TileOrder> orders;
		const std::vector<std::size_t> ordered = order_tiles(layers, tiles, orders);
		std::vector<std::shared_ptr<const CompactTile>> made;
		const Status status = builder->build_all(orders, terrain.get(), ground, made);
		for (std::size_t i = 0; i < made.size(); ++i) {
			r_tiles[ordered[i]] = std::move(made[i]);
		}
		return status;
	};
}

/// Generates tiles on other threads: calls no script and reads nothing of the scene.
TileMaker TerrainScatter3D::worker_tile_maker() const {
	return [layers = layer_list_.snapshots(), terrain = ground_snapshot_, builder = std::make_shared<SharedBuilder>(),
				   available = ground_.is_valid() && ground_->is_available()](std::span<const WorldTile> tiles,
				   std::vector<std::shared_ptr<const CompactTile>> &r_tiles) -> Status {
		r_tiles.assign(tiles.size(), nullptr);
		if (!available) {
			return {};
		}
		if (terrain == nullptr) {
			return Status::missing("thread_safe_ground",
					"The ground can be sampled on the main thread only (a script that is not thread-safe, or "
					"colliders), so the snapshot has only the tiles that were loaded when it was made. Use "
					"request_rect() or request_sphere()");
		}
		std::vector<TileOrder> orders;
		const std::vector<std::size_t> ordered = order_tiles(layers, tiles, orders);
		Status status;
		for (std::size_t i = 0; status.ok() && i < orders.size(); ++i) {
			status = builder->build(orders[i], *terrain, r_tiles[ordered[i]]);
		}
		return status;
	};
}

} // namespace thicket
