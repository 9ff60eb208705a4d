// This file registers the methods, properties and signals of TerrainScatter3D in ClassDB.

#include "nodes/scatter/terrain_scatter_3d.hpp"

#include <godot_cpp/core/class_db.hpp>

#include <type_traits>

using namespace godot;

namespace thicket {

namespace {

constexpr ThreadRule answered_by_snapshot{
		ThreadUse::main, "Use a ScatterSnapshot from make_snapshot(), or request_rect() and request_sphere()."};
constexpr ThreadRule frame{
		ThreadUse::main, "Set process_thread_group of the node and its parents to Inherit or Main Thread."};

} // namespace

// Completes these types before methods that return them are bound. Otherwise clang 19 for
// WebAssembly declares such a method as returning void, and the linker replaces it with a function
// that traps.
static_assert(std::is_destructible_v<TypedArray<Vector2i>> && std::is_destructible_v<Ref<ScatterTile>> &&
		std::is_destructible_v<TypedArray<ScatterExplanation>>);

void TerrainScatter3D::_bind_methods() {
	bind_streaming();
	bind_places();
	bind_changes();
	bind_queries();
	bind_signals();
}

void TerrainScatter3D::bind_streaming() {
	using Self = TerrainScatter3D;
	bind_guarded<&Self::set_biomes>(D_METHOD("set_biomes", "biomes"));
	bind_guarded<&Self::get_biomes>(D_METHOD("get_biomes"));
	bind_guarded<&Self::set_seed>(D_METHOD("set_seed", "seed"));
	bind_guarded<&Self::get_seed>(D_METHOD("get_seed"));
	bind_guarded<&Self::set_ground>(D_METHOD("set_ground", "ground"));
	bind_guarded<&Self::get_ground>(D_METHOD("get_ground"));
	bind_guarded<&Self::set_layers>(D_METHOD("set_layers", "layers"));
	bind_guarded<&Self::get_layers>(D_METHOD("get_layers"));
	bind_guarded<&Self::set_viewers>(D_METHOD("set_viewers", "viewers"));
	bind_guarded<&Self::get_viewers>(D_METHOD("get_viewers"));
	bind_guarded<&Self::set_viewer_distance_scales>(D_METHOD("set_viewer_distance_scales", "scales"));
	bind_guarded<&Self::get_viewer_distance_scales>(D_METHOD("get_viewer_distance_scales"));
	bind_guarded<&Self::set_world_offset>(D_METHOD("set_world_offset", "meters"));
	bind_guarded<&Self::get_world_offset>(D_METHOD("get_world_offset"));
	bind_guarded<&Self::set_local_coords>(D_METHOD("set_local_coords", "local"));
	bind_guarded<&Self::is_local_coords>(D_METHOD("is_local_coords"));
	bind_guarded<&Self::set_frame_budget_usec>(D_METHOD("set_frame_budget_usec", "microseconds"));
	bind_guarded<&Self::get_frame_budget_usec>(D_METHOD("get_frame_budget_usec"));
	bind_guarded<&Self::set_quality>(D_METHOD("set_quality", "quality"));
	bind_guarded<&Self::get_quality>(D_METHOD("get_quality"));
	bind_guarded<&Self::set_preview_instances>(D_METHOD("set_preview_instances", "count"));
	bind_guarded<&Self::get_preview_instances>(D_METHOD("get_preview_instances"));
	bind_guarded<&Self::set_max_multimeshes>(D_METHOD("set_max_multimeshes", "count"));
	bind_guarded<&Self::get_max_multimeshes>(D_METHOD("get_max_multimeshes"));
	bind_guarded<&Self::mark_dirty>(ThreadUse::relayed, D_METHOD("_mark_dirty"));
	bind_guarded<&Self::mark_ground_dirty>(ThreadUse::relayed, D_METHOD("_mark_ground_dirty"));
	bind_guarded<&Self::mark_ground_edited>(ThreadUse::relayed, D_METHOD("_mark_ground_edited", "rect"));
	bind_guarded<&Self::mark_area_edited>(ThreadUse::relayed, D_METHOD("_mark_area_edited", "rect"));
	bind_guarded<&Self::patch_now>(ThreadUse::main, D_METHOD("_patch"));
	bind_guarded<&Self::process_frame>(frame, D_METHOD("_process_frame"));
	bind_guarded<&Self::parse_navigation>(ThreadUse::main, D_METHOD("_parse_navigation", "mesh", "geometry", "node"));
	bind_guarded<&Self::set_preview_hidden>(ThreadUse::main, D_METHOD("_set_preview_hidden", "layers"));
	bind_guarded<&Self::set_preview_stand_in>(ThreadUse::main, D_METHOD("_set_preview_stand_in", "layer", "stand_in"));
	bind_guarded<&Self::regenerate>(ThreadUse::main, D_METHOD("regenerate"));
	bind_guarded<&Self::refresh_ground>(ThreadUse::main, D_METHOD("refresh_ground"));
	bind_guarded<&Self::is_settled>(ThreadUse::main, D_METHOD("is_settled"));
	bind_guarded<&Self::get_stats>(ThreadUse::main, D_METHOD("get_stats"));
	bind_guarded<&Self::get_draw_stats>(ThreadUse::main, D_METHOD("get_draw_stats", "camera"), DEFVAL(Variant()));
	bind_guarded<&Self::get_problems>(ThreadUse::main, D_METHOD("get_problems"));
	bind_guarded<&Self::get_shown_tiles>(ThreadUse::main, D_METHOD("get_shown_tiles", "layer"));
	bind_guarded<&Self::get_shown_count>(ThreadUse::main, D_METHOD("get_shown_count", "layer"));
	bind_guarded<&Self::get_tile>(ThreadUse::main, D_METHOD("get_tile", "layer", "tile"));
	bind_guarded<&Self::build_rect>(answered_by_snapshot, D_METHOD("build_rect", "layer", "rect"));
	bind_guarded<&Self::build_tile>(
			answered_by_snapshot, D_METHOD("build_tile", "layer", "tile", "rect"), DEFVAL(Rect2()));
	ADD_PROPERTY(PropertyInfo(Variant::INT, "seed"), "set_seed", "get_seed");
	ADD_PROPERTY(PropertyInfo(Variant::OBJECT, "ground", PROPERTY_HINT_RESOURCE_TYPE, "ScatterGround"), "set_ground",
			"get_ground");
	ADD_PROPERTY(PropertyInfo(Variant::ARRAY, "layers", PROPERTY_HINT_ARRAY_TYPE,
						 vformat("%d/%d:ScatterLayer", Variant::OBJECT, PROPERTY_HINT_RESOURCE_TYPE)),
			"set_layers", "get_layers");
	ADD_PROPERTY(PropertyInfo(Variant::OBJECT, "biomes", PROPERTY_HINT_RESOURCE_TYPE, "ScatterBiomeMap"), "set_biomes",
			"get_biomes");
	ADD_PROPERTY(PropertyInfo(Variant::ARRAY, "viewers", PROPERTY_HINT_ARRAY_TYPE,
						 vformat("%d/%d:Node3D", Variant::NODE_PATH, PROPERTY_HINT_NODE_PATH_VALID_TYPES)),
			"set_viewers", "get_viewers");
	ADD_PROPERTY(PropertyInfo(Variant::PACKED_FLOAT32_ARRAY, "viewer_distance_scales"), "set_viewer_distance_scales",
			"get_viewer_distance_scales");
	ADD_PROPERTY(PropertyInfo(Variant::VECTOR3, "world_offset", PROPERTY_HINT_NONE, "suffix:m"), "set_world_offset",
			"get_world_offset");
	ADD_PROPERTY(PropertyInfo(Variant::BOOL, "local_coords"), "set_local_coords", "is_local_coords");
	ADD_PROPERTY(PropertyInfo(Variant::INT, "frame_budget_usec", PROPERTY_HINT_RANGE,
						 "50,5000,10,or_less,or_greater,suffix:µs"),
			"set_frame_budget_usec", "get_frame_budget_usec");
	ADD_PROPERTY(
			PropertyInfo(Variant::FLOAT, "quality", PROPERTY_HINT_RANGE, "0,1,0.01"), "set_quality", "get_quality");
	ADD_PROPERTY(PropertyInfo(Variant::INT, "preview_instances", PROPERTY_HINT_RANGE, "0,2000000,1000,or_greater"),
			"set_preview_instances", "get_preview_instances");
	ADD_PROPERTY(PropertyInfo(Variant::INT, "max_multimeshes", PROPERTY_HINT_RANGE, "0,65536,1,or_greater"),
			"set_max_multimeshes", "get_max_multimeshes");
}

void TerrainScatter3D::bind_places() {
	using Self = TerrainScatter3D;
	bind_guarded<&Self::get_all_layers>(ThreadUse::main, D_METHOD("get_all_layers"));
	bind_guarded<&Self::set_water_enabled>(D_METHOD("set_water_enabled", "enabled"));
	bind_guarded<&Self::is_water_enabled>(D_METHOD("is_water_enabled"));
	bind_guarded<&Self::set_water_level>(D_METHOD("set_water_level", "level"));
	bind_guarded<&Self::get_water_level>(D_METHOD("get_water_level"));
	ADD_GROUP("Water", "water_");
	ADD_PROPERTY(PropertyInfo(Variant::BOOL, "water_enabled"), "set_water_enabled", "is_water_enabled");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "water_level", PROPERTY_HINT_RANGE,
						 "-1000,9000,0.01,or_less,or_greater,suffix:m"),
			"set_water_level", "get_water_level");
}

void TerrainScatter3D::bind_changes() {
	using Self = TerrainScatter3D;
	bind_guarded<&Self::set_state>(D_METHOD("set_state", "state"));
	bind_guarded<&Self::get_state>(D_METHOD("get_state"));
	bind_guarded<&Self::set_interaction_group>(D_METHOD("set_interaction_group", "group"));
	bind_guarded<&Self::get_interaction_group>(D_METHOD("get_interaction_group"));
	bind_guarded<&Self::remove_instance>(ThreadUse::main, D_METHOD("remove_instance", "id"));
	bind_guarded<&Self::restore_instance>(ThreadUse::main, D_METHOD("restore_instance", "id"));
	bind_guarded<&Self::remove_in_sphere>(ThreadUse::main,
			D_METHOD("remove_in_sphere", "center", "radius", "layers", "predicate"), DEFVAL(Array()),
			DEFVAL(Callable()));
	bind_guarded<&Self::add_instance>(
			ThreadUse::main, D_METHOD("add_instance", "layer", "transform", "mesh"), DEFVAL(0));
	bind_guarded<&Self::add_instances>(
			ThreadUse::main, D_METHOD("add_instances", "layer", "transforms", "meshes"), DEFVAL(PackedInt32Array()));
	bind_guarded<&Self::remove_instances>(ThreadUse::main, D_METHOD("remove_instances", "ids"));
	bind_guarded<&Self::set_instance_transform>(ThreadUse::main, D_METHOD("set_instance_transform", "id", "transform"));
	bind_guarded<&Self::set_instance_data>(ThreadUse::main, D_METHOD("set_instance_data", "id", "data"));
	bind_guarded<&Self::get_instance_data>(ThreadUse::main, D_METHOD("get_instance_data", "id"));
	bind_guarded<&Self::get_scene>(ThreadUse::main, D_METHOD("get_scene", "id"));
	bind_guarded<&Self::take_scene>(ThreadUse::main, D_METHOD("take_scene", "id"));
	bind_guarded<&Self::recycle_scenes>(ThreadUse::main, D_METHOD("_recycle_scenes"));
	ADD_GROUP("Gameplay", "");
	ADD_PROPERTY(PropertyInfo(Variant::OBJECT, "state", PROPERTY_HINT_RESOURCE_TYPE, "ScatterState"), "set_state",
			"get_state");
	ADD_PROPERTY(
			PropertyInfo(Variant::STRING_NAME, "interaction_group"), "set_interaction_group", "get_interaction_group");
}

void TerrainScatter3D::bind_queries() {
	using Self = TerrainScatter3D;
	bind_guarded<&Self::query_rect>(answered_by_snapshot, D_METHOD("query_rect", "rect", "layers", "predicate"),
			DEFVAL(Array()), DEFVAL(Callable()));
	bind_guarded<&Self::query_sphere>(answered_by_snapshot,
			D_METHOD("query_sphere", "center", "radius", "layers", "predicate"), DEFVAL(Array()), DEFVAL(Callable()));
	bind_guarded<&Self::query_ray>(answered_by_snapshot, D_METHOD("query_ray", "from", "to", "layers", "predicate"),
			DEFVAL(Array()), DEFVAL(Callable()));
	bind_guarded<&Self::query_nearest>(answered_by_snapshot,
			D_METHOD("query_nearest", "position", "max_distance", "layers", "predicate"), DEFVAL(Array()),
			DEFVAL(Callable()));
	bind_guarded<&Self::up_at>(ThreadUse::main, D_METHOD("_up_at", "position"));
	bind_guarded<&Self::hit_surface>(ThreadUse::main, D_METHOD("_hit_surface", "from", "to"));
	bind_guarded<&Self::get_planet>(ThreadUse::main, D_METHOD("_get_planet"));
	bind_guarded<&Self::to_planet>(ThreadUse::main, D_METHOD("_to_planet", "positions"));
	bind_guarded<&Self::planet_ground>(ThreadUse::main, D_METHOD("_planet_ground", "middle", "places"));
	bind_guarded<&Self::densities_at>(ThreadUse::main, D_METHOD("_densities_at", "layer", "positions"));
	bind_guarded<&Self::slopes_at>(ThreadUse::main, D_METHOD("_slopes_at", "positions"));
	bind_guarded<&Self::explain_position>(
			ThreadUse::main, D_METHOD("explain_position", "position", "layers"), DEFVAL(Array()));
	bind_guarded<&Self::get_density_map>(ThreadUse::main, D_METHOD("get_density_map", "layer", "rect", "size"));
	bind_guarded<&Self::get_slope_map>(ThreadUse::main, D_METHOD("get_slope_map", "rect", "size"));
	bind_guarded<&Self::get_rank_map>(ThreadUse::main, D_METHOD("get_rank_map", "layer", "rect", "size"));
	bind_guarded<&Self::get_instance>(answered_by_snapshot, D_METHOD("get_instance", "id"));
	bind_guarded<&Self::has_instance>(answered_by_snapshot, D_METHOD("has_instance", "id"));
	bind_guarded<&Self::get_body_instance>(ThreadUse::main, D_METHOD("get_body_instance", "body"));
	bind_guarded<&Self::make_snapshot>(ThreadUse::main, D_METHOD("make_snapshot"));
	bind_guarded<&Self::request_rect>(ThreadUse::any, D_METHOD("request_rect", "rect", "layers", "predicate"),
			DEFVAL(Array()), DEFVAL(Callable()));
	bind_guarded<&Self::request_sphere>(ThreadUse::any,
			D_METHOD("request_sphere", "center", "radius", "layers", "predicate"), DEFVAL(Array()), DEFVAL(Callable()));
}

void TerrainScatter3D::bind_signals() {
	const PropertyInfo layer(Variant::OBJECT, "layer", PROPERTY_HINT_RESOURCE_TYPE, "ScatterLayer");
	for (const char *name : {"tile_shown", "tile_hidden"}) {
		ADD_SIGNAL(MethodInfo(name, layer, PropertyInfo(Variant::VECTOR2I, "tile")));
	}
	ADD_SIGNAL(MethodInfo("settled"));
	for (const char *name :
			{"instance_removed", "instance_restored", "instance_added", "instance_moved", "instance_data_changed"}) {
		ADD_SIGNAL(MethodInfo(
				name, PropertyInfo(Variant::INT, "id"), layer, PropertyInfo(Variant::TRANSFORM3D, "transform")));
	}
	for (const char *name : {"scene_shown", "scene_hidden"}) {
		ADD_SIGNAL(MethodInfo(name, PropertyInfo(Variant::INT, "id"),
				PropertyInfo(Variant::OBJECT, "scene", PROPERTY_HINT_NONE, "", PROPERTY_USAGE_DEFAULT, "Node3D")));
	}
}

} // namespace thicket
