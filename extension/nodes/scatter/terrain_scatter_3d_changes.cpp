// What a TerrainScatter3D is told has changed: settings, layers, ground, regions. It counts from the next frame on.

#include "nodes/scatter/terrain_scatter_3d.hpp"

#include <glm/common.hpp>

#include <limits>
#include <memory>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

/// Meters around a change of the ground in which slopes may be others: heights are compared over less than that.
constexpr double slope_margin = 1.0;

/// Meters around a single position that stand for it, since a rectangle without an area is no change.
constexpr double point_margin = 1e-3;

/// A rectangle of the engine; all of the world for one without an area, or that is not finite.
Rect world_rect(const Rect2 &p_rect) {
	constexpr double infinity = std::numeric_limits<double>::infinity();
	const glm::dvec2 corner{p_rect.position.x, p_rect.position.y};
	const glm::dvec2 other = corner + glm::dvec2{p_rect.size.x, p_rect.size.y};
	const Rect rect{glm::min(corner, other), glm::max(corner, other)};
	return rect.empty() || !rect.finite() ? Rect{glm::dvec2(-infinity), glm::dvec2(infinity)} : rect;
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
	// One that was taken out of the tree, as undo does, leaves layers that others share as they are.
	const bool gives = is_inside_tree() || !was_inside_;
	// Layers that get an id tell scripts, which may free this node.
	watch->look(layers, node_layers_.own_count(), gives);
	const std::vector<LayerRename> renames = gameplay->alive() ? watch->follow_names() : std::vector<LayerRename>();
	if (!gameplay->alive()) {
		return;
	}
	for (const LayerRename &rename : renames) {
		regions_.rename_layer(rename.from, rename.to);
	}
	mark_edited();
	update_configuration_warnings();
	PackedStringArray names;
	const TypedArray<ScatterLayer> named = all_layers();
	for (int64_t index = 0; index < named.size(); ++index) {
		const Ref<ScatterLayer> layer = named[index];
		names.push_back(layer.is_valid() ? layer->get_name() : String());
	}
	if (!(names == layer_names_)) {
		layer_names_ = names;
		regions_.update_warnings(); // They may name layers.
	}
}

/// Scripts share the lists of layers and biomes, and may change them without a setter.
void TerrainScatter3D::notice_layers() {
	const std::shared_ptr<ScatterGameplay> gameplay = gameplay_;
	if (const Ref<ScatterBiomeMap> biomes = biomes_; biomes.is_valid()) {
		biomes->notice(); // Tells scripts, which may free this node.
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
	if (terrain_.is_valid()) {
		terrain_->look_again();
	}
	mark_ground_dirty();
}

void TerrainScatter3D::refresh_ground() {
	if (terrain_.is_null() || !terrain_->read_again()) {
		regenerate();
	}
}

void TerrainScatter3D::mark_ground_edited(const Rect2 &p_rect) {
	if (terrain_.is_valid()) {
		terrain_->look_again();
	}
	const Rect rect = world_rect(p_rect);
	ground_change_.everywhere = ground_change_.everywhere || !rect.finite();
	ground_change_.add(rect, slope_margin);
	mark_edited();
}

/// Found by a re-check. The tile there is regenerated; whether others differ, their own heights tell.
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

} // namespace thicket
