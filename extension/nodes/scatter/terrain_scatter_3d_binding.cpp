// What the engine is told of TerrainScatter3D: methods, properties and signals.

#include "nodes/scatter/terrain_scatter_3d.hpp"

#include <godot_cpp/core/class_db.hpp>

using namespace godot;

namespace thicket {

void TerrainScatter3D::_bind_methods() {
	bind_streaming();
	bind_changes();
	bind_queries();
	bind_signals();
}

void TerrainScatter3D::bind_streaming() {
	using Self = TerrainScatter3D;
	ClassDB::bind_method(D_METHOD("set_seed", "seed"), &Self::set_seed);
	ClassDB::bind_method(D_METHOD("get_seed"), &Self::get_seed);
	ClassDB::bind_method(D_METHOD("set_terrain", "terrain"), &Self::set_terrain);
	ClassDB::bind_method(D_METHOD("get_terrain"), &Self::get_terrain);
	ClassDB::bind_method(D_METHOD("set_layers", "layers"), &Self::set_layers);
	ClassDB::bind_method(D_METHOD("get_layers"), &Self::get_layers);
	ClassDB::bind_method(D_METHOD("set_viewers", "viewers"), &Self::set_viewers);
	ClassDB::bind_method(D_METHOD("get_viewers"), &Self::get_viewers);
	ClassDB::bind_method(D_METHOD("set_viewer_distance_scales", "scales"), &Self::set_viewer_distance_scales);
	ClassDB::bind_method(D_METHOD("get_viewer_distance_scales"), &Self::get_viewer_distance_scales);
	ClassDB::bind_method(D_METHOD("set_world_offset", "meters"), &Self::set_world_offset);
	ClassDB::bind_method(D_METHOD("get_world_offset"), &Self::get_world_offset);
	ClassDB::bind_method(D_METHOD("set_frame_budget_usec", "microseconds"), &Self::set_frame_budget_usec);
	ClassDB::bind_method(D_METHOD("get_frame_budget_usec"), &Self::get_frame_budget_usec);
	ClassDB::bind_method(D_METHOD("set_quality", "quality"), &Self::set_quality);
	ClassDB::bind_method(D_METHOD("get_quality"), &Self::get_quality);
	ClassDB::bind_method(D_METHOD("set_preview_instances", "count"), &Self::set_preview_instances);
	ClassDB::bind_method(D_METHOD("get_preview_instances"), &Self::get_preview_instances);
	ClassDB::bind_method(D_METHOD("_mark_dirty"), &Self::mark_dirty);
	ClassDB::bind_method(D_METHOD("_mark_ground_dirty"), &Self::mark_ground_dirty);
	ClassDB::bind_method(D_METHOD("_mark_ground_edited", "rect"), &Self::mark_ground_edited);
	ClassDB::bind_method(D_METHOD("_mark_area_edited", "rect"), &Self::mark_area_edited);
	ClassDB::bind_method(D_METHOD("_patch"), &Self::patch_now);
	ClassDB::bind_method(D_METHOD("regenerate"), &Self::regenerate);
	ClassDB::bind_method(D_METHOD("is_settled"), &Self::is_settled);
	ClassDB::bind_method(D_METHOD("get_stats"), &Self::get_stats);
	ClassDB::bind_method(D_METHOD("get_problems"), &Self::get_problems);
	ClassDB::bind_method(D_METHOD("get_shown_tiles", "layer"), &Self::get_shown_tiles);
	ClassDB::bind_method(D_METHOD("get_tile", "layer", "tile"), &Self::get_tile);
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
	ADD_PROPERTY(PropertyInfo(Variant::PACKED_FLOAT32_ARRAY, "viewer_distance_scales"), "set_viewer_distance_scales",
			"get_viewer_distance_scales");
	ADD_PROPERTY(PropertyInfo(Variant::VECTOR3, "world_offset", PROPERTY_HINT_NONE, "suffix:m"), "set_world_offset",
			"get_world_offset");
	ADD_PROPERTY(PropertyInfo(Variant::INT, "frame_budget_usec", PROPERTY_HINT_RANGE,
						 "50,5000,10,or_less,or_greater,suffix:µs"),
			"set_frame_budget_usec", "get_frame_budget_usec");
	ADD_PROPERTY(
			PropertyInfo(Variant::FLOAT, "quality", PROPERTY_HINT_RANGE, "0,1,0.01"), "set_quality", "get_quality");
	ADD_PROPERTY(PropertyInfo(Variant::INT, "preview_instances", PROPERTY_HINT_RANGE, "0,2000000,1000,or_greater"),
			"set_preview_instances", "get_preview_instances");
}

void TerrainScatter3D::bind_changes() {
	using Self = TerrainScatter3D;
	ClassDB::bind_method(D_METHOD("set_state", "state"), &Self::set_state);
	ClassDB::bind_method(D_METHOD("get_state"), &Self::get_state);
	ClassDB::bind_method(D_METHOD("set_interaction_group", "group"), &Self::set_interaction_group);
	ClassDB::bind_method(D_METHOD("get_interaction_group"), &Self::get_interaction_group);
	ClassDB::bind_method(D_METHOD("remove_instance", "id"), &Self::remove_instance);
	ClassDB::bind_method(D_METHOD("restore_instance", "id"), &Self::restore_instance);
	ClassDB::bind_method(D_METHOD("remove_in_sphere", "center", "radius", "layers", "predicate"),
			&Self::remove_in_sphere, DEFVAL(Array()), DEFVAL(Callable()));
	ClassDB::bind_method(D_METHOD("add_instance", "layer", "transform", "mesh"), &Self::add_instance, DEFVAL(0));
	ClassDB::bind_method(D_METHOD("set_instance_data", "id", "data"), &Self::set_instance_data);
	ClassDB::bind_method(D_METHOD("get_instance_data", "id"), &Self::get_instance_data);
	ClassDB::bind_method(D_METHOD("get_scene", "id"), &Self::get_scene);
	ClassDB::bind_method(D_METHOD("take_scene", "id"), &Self::take_scene);
	ClassDB::bind_method(D_METHOD("_recycle_scenes"), &Self::recycle_scenes);
	ADD_GROUP("Gameplay", "");
	ADD_PROPERTY(PropertyInfo(Variant::OBJECT, "state", PROPERTY_HINT_RESOURCE_TYPE, "ScatterState"), "set_state",
			"get_state");
	ADD_PROPERTY(PropertyInfo(Variant::STRING_NAME, "interaction_group"), "set_interaction_group",
			"get_interaction_group");
}

void TerrainScatter3D::bind_queries() {
	using Self = TerrainScatter3D;
	ClassDB::bind_method(D_METHOD("query_rect", "rect", "layers", "predicate"), &Self::query_rect, DEFVAL(Array()),
			DEFVAL(Callable()));
	ClassDB::bind_method(D_METHOD("query_sphere", "center", "radius", "layers", "predicate"), &Self::query_sphere,
			DEFVAL(Array()), DEFVAL(Callable()));
	ClassDB::bind_method(D_METHOD("query_ray", "from", "to", "layers", "predicate"), &Self::query_ray, DEFVAL(Array()),
			DEFVAL(Callable()));
	ClassDB::bind_method(D_METHOD("query_nearest", "position", "max_distance", "layers", "predicate"),
			&Self::query_nearest, DEFVAL(Array()), DEFVAL(Callable()));
	ClassDB::bind_method(D_METHOD("get_instance", "id"), &Self::get_instance);
	ClassDB::bind_method(D_METHOD("has_instance", "id"), &Self::has_instance);
	ClassDB::bind_method(D_METHOD("get_body_instance", "body"), &Self::get_body_instance);
	ClassDB::bind_method(D_METHOD("request_rect", "rect", "layers"), &Self::request_rect, DEFVAL(Array()));
	ClassDB::bind_method(
			D_METHOD("request_sphere", "center", "radius", "layers"), &Self::request_sphere, DEFVAL(Array()));
}

void TerrainScatter3D::bind_signals() {
	for (const char *name : {"tile_shown", "tile_hidden"}) {
		ADD_SIGNAL(MethodInfo(name, PropertyInfo(Variant::INT, "layer"), PropertyInfo(Variant::VECTOR2I, "tile")));
	}
	ADD_SIGNAL(MethodInfo("settled"));
	for (const char *name : {"instance_removed", "instance_restored", "instance_added", "instance_data_changed"}) {
		ADD_SIGNAL(MethodInfo(name, PropertyInfo(Variant::INT, "id"), PropertyInfo(Variant::INT, "layer"),
				PropertyInfo(Variant::TRANSFORM3D, "transform")));
	}
	for (const char *name : {"scene_shown", "scene_hidden"}) {
		ADD_SIGNAL(MethodInfo(name, PropertyInfo(Variant::INT, "id"),
				PropertyInfo(Variant::OBJECT, "scene", PROPERTY_HINT_NONE, "", PROPERTY_USAGE_DEFAULT, "Node3D")));
	}
}

} // namespace thicket
