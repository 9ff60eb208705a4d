// What a TerrainScatter3D tells: its tiles, figures and warnings, and its entry in ClassDB.

#include "nodes/gameplay/instance_answers.hpp"
#include "nodes/scatter/terrain_scatter_3d.hpp"

#include <godot_cpp/core/class_db.hpp>

#include <algorithm>
#include <limits>
#include <optional>
#include <set>
#include <string>

using namespace godot;

namespace thicket {

namespace {

PackedFloat32Array buffer_of(const DisplayedTile::Part &part) {
	return part.visual ? part.visual->read_back() : packed_floats(part.shown->buffer);
}

} // namespace

// What is read back is what is drawn: what is marked has to be drawn anew first.
const DisplayedTile *TerrainScatter3D::tile_at(int64_t p_layer, const Vector2i &p_tile) {
	if (p_layer < 0 || p_layer > std::numeric_limits<std::uint16_t>::max()) {
		return nullptr;
	}
	stream_.display().patch();
	return stream_.display().find(static_cast<std::uint32_t>(p_layer), {p_tile.x, p_tile.y});
}

Array TerrainScatter3D::get_shown_tiles(int64_t p_layer) const {
	Array result;
	if (p_layer >= 0 && p_layer < layers_.size()) {
		for (const glm::ivec2 &tile : stream_.display().tiles(static_cast<std::uint32_t>(p_layer))) {
			result.push_back(Vector2i(tile.x, tile.y));
		}
	}
	return result;
}

Vector3 TerrainScatter3D::get_tile_origin(int64_t p_layer, const Vector2i &p_tile) {
	const DisplayedTile *tile = tile_at(p_layer, p_tile);
	if (tile == nullptr) {
		return {};
	}
	return to_engine(tile->tile->origin, world_offset_);
}

Array TerrainScatter3D::get_tile_buffers(int64_t p_layer, const Vector2i &p_tile) {
	Array result;
	if (const DisplayedTile *tile = tile_at(p_layer, p_tile)) {
		for (const DisplayedTile::Part &part : tile->parts) {
			result.push_back(buffer_of(part));
		}
	}
	return result;
}

Array TerrainScatter3D::get_tile_multimeshes(int64_t p_layer, const Vector2i &p_tile) {
	Array result;
	if (const DisplayedTile *tile = tile_at(p_layer, p_tile)) {
		for (const DisplayedTile::Part &part : tile->parts) {
			result.push_back(part.visual ? part.visual->multimesh() : RID());
		}
	}
	return result;
}

Array TerrainScatter3D::get_tile_ids(int64_t p_layer, const Vector2i &p_tile) {
	Array result;
	if (const DisplayedTile *tile = tile_at(p_layer, p_tile)) {
		for (const DisplayedTile::Part &part : tile->parts) {
			result.push_back(packed_ids(part.shown->ids));
		}
	}
	return result;
}

int64_t TerrainScatter3D::get_tile_digest(int64_t p_layer, const Vector2i &p_tile) {
	const DisplayedTile *tile = tile_at(p_layer, p_tile);
	if (tile == nullptr) {
		return 0;
	}
	TileInstances instances;
	instances.origin = tile->tile->origin;
	instances.counts = tile->tile->counts;
	for (const DisplayedTile::Part &part : tile->parts) {
		const PackedFloat32Array buffer = buffer_of(part);
		MeshInstances mesh;
		mesh.buffer.assign(buffer.ptr(), buffer.ptr() + buffer.size());
		mesh.ids = part.shown->ids;
		mesh.ranks = part.shown->ranks;
		instances.meshes.push_back(std::move(mesh));
	}
	return static_cast<int64_t>(digest(instances));
}

Dictionary TerrainScatter3D::get_stats() const {
	const StreamCounts counts = stream_.counts();
	const StreamFigures &figures = stream_.figures();
	const auto number = [](std::uint64_t value) {
		return static_cast<int64_t>(value);
	};
	Dictionary stats;
	stats["tiles"] = number(stream_.display().tile_count());
	stats["instances"] = number(stream_.display().instance_count());
	stats["drawn"] = number(stream_.display().drawn_count());
	stats["uploads"] = number(stream_.display().upload_count());
	stats["redrawn"] = number(stream_.display().redrawn_count());
	stats["waiting"] = number(counts.waiting);
	stats["pending"] = number(counts.pending);
	stats["uploading"] = number(stream_.upload_queue_size());
	stats["scenes"] = number(scenes_.shown_count());
	stats["scenes_pooled"] = number(scenes_.idle_count());
	stats["frame_usec"] =
			static_cast<int64_t>(std::chrono::duration_cast<std::chrono::microseconds>(frame_time_).count());
	stats["bodies"] = number(collision_.body_count());
	stats["bodies_pooled"] = number(collision_.pooled_count());
	stats["tiles_made"] = number(figures.tiles_made);
	stats["points_sampled"] = number(figures.points_sampled);
	stats["worker_usec"] = number(figures.worker_microseconds);
	return stats;
}

void TerrainScatter3D::add_layer_problems(PackedStringArray &r_problems) const {
	std::vector<std::optional<LayerLinks>> links;
	for (int64_t place = 0; place < layers_.size(); ++place) {
		const Ref<ScatterLayer> layer = layer_at(place);
		links.push_back(layer.is_valid() ? std::optional(layer->links()) : std::nullopt);
	}
	std::vector<const LayerLinks *> names;
	for (const std::optional<LayerLinks> &layer : links) {
		names.push_back(layer ? &*layer : nullptr);
	}
	std::set<int64_t> ids;
	for (int64_t place = 0; place < layers_.size(); ++place) {
		const String where = "Layer " + String::num_int64(place) + ": ";
		const Ref<ScatterLayer> layer = layer_at(place);
		if (layer.is_null()) {
			r_problems.push_back(where + String("empty, shows nothing."));
			continue;
		}
		for (const String &problem : layer->problems()) {
			r_problems.push_back(where + problem);
		}
		if (layer->get_ground_textures().size() > 0 && terrain_.is_valid() && terrain_->problem().is_empty() &&
				!terrain_->has_textures()) {
			r_problems.push_back(
					where + String("ScatterLayer.ground_textures has no effect: the terrain has no textures."));
		}
		for (const std::string &problem : name_problems(names, static_cast<std::size_t>(place))) {
			r_problems.push_back(where + String::utf8(problem.c_str()));
		}
		const int64_t id = layer->own_id();
		if (!ids.insert(id >= 0 ? id : place).second) {
			r_problems.push_back(
					where + String("has the same layer_id as another: both use the same random numbers and ids. Set it "
								   "to -1 for an id of its own."));
		}
	}
}

PackedStringArray TerrainScatter3D::get_problems() const {
	PackedStringArray warnings;
	if (terrain_.is_null()) {
		warnings.push_back("No terrain: set TerrainScatter3D.terrain to a ScatterTerrain to show anything.");
	} else if (const String problem = terrain_->problem(); !problem.is_empty()) {
		warnings.push_back(problem);
	}
	if (layers_.is_empty()) {
		warnings.push_back("No layers: add a ScatterLayer to TerrainScatter3D.layers.");
	}
	add_layer_problems(warnings);
	if (state_.is_valid()) {
		if (const Status status = check_state(*state_.ptr()); !status.ok()) {
			warnings.push_back(
					sentence("TerrainScatter3D", status) + String(": what it has removed are other instances."));
		}
	}
	for (int64_t viewer = 0; is_inside_tree() && viewer < viewers_.size(); ++viewer) {
		if (Object::cast_to<Node3D>(get_node_or_null(viewers_[viewer])) == nullptr) {
			warnings.push_back("Viewer " + String::num_int64(viewer) + " is no Node3D in this scene.");
		}
	}
	return warnings;
}

void TerrainScatter3D::_bind_methods() {
	using Self = TerrainScatter3D;
	ClassDB::bind_method(D_METHOD("set_seed", "seed"), &Self::set_seed);
	ClassDB::bind_method(D_METHOD("get_seed"), &Self::get_seed);
	ClassDB::bind_method(D_METHOD("set_terrain", "terrain"), &Self::set_terrain);
	ClassDB::bind_method(D_METHOD("get_terrain"), &Self::get_terrain);
	ClassDB::bind_method(D_METHOD("set_layers", "layers"), &Self::set_layers);
	ClassDB::bind_method(D_METHOD("get_layers"), &Self::get_layers);
	ClassDB::bind_method(D_METHOD("set_viewers", "viewers"), &Self::set_viewers);
	ClassDB::bind_method(D_METHOD("get_viewers"), &Self::get_viewers);
	ClassDB::bind_method(D_METHOD("set_viewer_radius_scales", "scales"), &Self::set_viewer_radius_scales);
	ClassDB::bind_method(D_METHOD("get_viewer_radius_scales"), &Self::get_viewer_radius_scales);
	ClassDB::bind_method(D_METHOD("set_world_offset", "meters"), &Self::set_world_offset);
	ClassDB::bind_method(D_METHOD("get_world_offset"), &Self::get_world_offset);
	ClassDB::bind_method(D_METHOD("set_upload_budget_usec", "microseconds"), &Self::set_upload_budget_usec);
	ClassDB::bind_method(D_METHOD("get_upload_budget_usec"), &Self::get_upload_budget_usec);
	ClassDB::bind_method(D_METHOD("set_quality", "quality"), &Self::set_quality);
	ClassDB::bind_method(D_METHOD("get_quality"), &Self::get_quality);
	ClassDB::bind_method(D_METHOD("set_preview_instances", "count"), &Self::set_preview_instances);
	ClassDB::bind_method(D_METHOD("get_preview_instances"), &Self::get_preview_instances);
	ClassDB::bind_method(D_METHOD("_mark_dirty"), &Self::mark_dirty);
	ClassDB::bind_method(D_METHOD("_mark_ground_dirty"), &Self::mark_ground_dirty);
	ClassDB::bind_method(D_METHOD("_mark_ground_edited", "rect"), &Self::mark_ground_edited);
	ClassDB::bind_method(D_METHOD("_mark_area_edited", "rect"), &Self::mark_area_edited);
	ClassDB::bind_method(D_METHOD("regenerate"), &Self::regenerate);
	ClassDB::bind_method(D_METHOD("is_idle"), &Self::is_idle);
	ClassDB::bind_method(D_METHOD("get_stats"), &Self::get_stats);
	ClassDB::bind_method(D_METHOD("get_problems"), &Self::get_problems);
	ClassDB::bind_method(D_METHOD("get_shown_tiles", "layer"), &Self::get_shown_tiles);
	ClassDB::bind_method(D_METHOD("get_tile_origin", "layer", "tile"), &Self::get_tile_origin);
	ClassDB::bind_method(D_METHOD("get_tile_buffers", "layer", "tile"), &Self::get_tile_buffers);
	ClassDB::bind_method(D_METHOD("get_tile_multimeshes", "layer", "tile"), &Self::get_tile_multimeshes);
	ClassDB::bind_method(D_METHOD("get_tile_ids", "layer", "tile"), &Self::get_tile_ids);
	ClassDB::bind_method(D_METHOD("get_tile_digest", "layer", "tile"), &Self::get_tile_digest);
	ClassDB::bind_method(D_METHOD("build_rect", "layer", "rect"), &Self::build_rect);
	ADD_PROPERTY(PropertyInfo(Variant::INT, "seed"), "set_seed", "get_seed");
	ADD_PROPERTY(PropertyInfo(Variant::OBJECT, "terrain", PROPERTY_HINT_RESOURCE_TYPE, "ScatterTerrain"), "set_terrain",
			"get_terrain");
	ADD_PROPERTY(PropertyInfo(Variant::ARRAY, "layers", PROPERTY_HINT_ARRAY_TYPE,
						 vformat("%d/%d:ScatterLayer", Variant::OBJECT, PROPERTY_HINT_RESOURCE_TYPE)),
			"set_layers", "get_layers");
	ADD_PROPERTY(PropertyInfo(Variant::ARRAY, "viewers", PROPERTY_HINT_ARRAY_TYPE,
						 vformat("%d/%d:Node3D", Variant::NODE_PATH, PROPERTY_HINT_NODE_PATH_VALID_TYPES)),
			"set_viewers", "get_viewers");
	ADD_PROPERTY(PropertyInfo(Variant::PACKED_FLOAT32_ARRAY, "viewer_radius_scales"), "set_viewer_radius_scales",
			"get_viewer_radius_scales");
	ADD_PROPERTY(PropertyInfo(Variant::VECTOR3, "world_offset", PROPERTY_HINT_NONE, "suffix:m"), "set_world_offset",
			"get_world_offset");
	ADD_PROPERTY(PropertyInfo(Variant::INT, "upload_budget_usec", PROPERTY_HINT_RANGE,
						 "50,5000,10,or_less,or_greater,suffix:µs"),
			"set_upload_budget_usec", "get_upload_budget_usec");
	ADD_PROPERTY(
			PropertyInfo(Variant::FLOAT, "quality", PROPERTY_HINT_RANGE, "0,1,0.01"), "set_quality", "get_quality");
	ADD_PROPERTY(PropertyInfo(Variant::INT, "preview_instances", PROPERTY_HINT_RANGE, "0,2000000,1000,or_greater"),
			"set_preview_instances", "get_preview_instances");
	ADD_SIGNAL(MethodInfo("tile_shown", PropertyInfo(Variant::INT, "layer"), PropertyInfo(Variant::VECTOR2I, "tile")));
	ADD_SIGNAL(MethodInfo("tile_hidden", PropertyInfo(Variant::INT, "layer"), PropertyInfo(Variant::VECTOR2I, "tile")));
	ADD_SIGNAL(MethodInfo("idle"));
	bind_changes();
	bind_scenes();
	bind_queries();
}

} // namespace thicket
