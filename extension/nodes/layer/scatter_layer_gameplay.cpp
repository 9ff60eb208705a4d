// This file contains the properties of ScatterLayer in the group Gameplay. None of them affects
// placement.

#include "nodes/layer/scatter_layer_properties.hpp"

#include <algorithm>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

constexpr double min_side = 1e-3; ///< The minimum radius and height of an instance, in meters.
constexpr double max_side = 1e4;
constexpr double farthest_body = 1e4;
constexpr double longest_regrowth = 1e9; ///< The maximum regrowth time in seconds, about 32 years.
constexpr int64_t all_physics_layers = 0xffffffff;

constexpr NumberProperty instance_radius{"instance_radius", &LayerGameplay::instance_radius, min_side, max_side,
		PROPERTY_HINT_RANGE, "0.01,10,0.001,or_less,or_greater,exp,suffix:m"};
constexpr NumberProperty instance_height{"instance_height", &LayerGameplay::instance_height, min_side, max_side,
		PROPERTY_HINT_RANGE, "0.01,50,0.001,or_less,or_greater,exp,suffix:m"};
constexpr NumberProperty regrowth_time{"regrowth_time", &LayerGameplay::regrowth_time, 0.0, longest_regrowth,
		PROPERTY_HINT_RANGE, "0,86400,0.1,or_greater,exp,suffix:s"};
constexpr NumberProperty collision_distance{"collision_distance", &LayerCollision::distance, 0.0, farthest_body,
		PROPERTY_HINT_RANGE, "0,200,0.1,or_greater,exp,suffix:m"};
constexpr NumberProperty scene_distance{"scene_distance", &LayerScene::distance, 0.0, farthest_body,
		PROPERTY_HINT_RANGE, "0,200,0.1,or_greater,exp,suffix:m"};

constexpr NumberProperty collision_layer{
		"collision_layer", &LayerCollision::layer, 0, all_physics_layers, PROPERTY_HINT_LAYERS_3D_PHYSICS};
constexpr NumberProperty collision_mask{
		"collision_mask", &LayerCollision::mask, 0, all_physics_layers, PROPERTY_HINT_LAYERS_3D_PHYSICS};

constexpr SwitchProperty affect_navigation_mesh{
		"affect_navigation_mesh", "get_affect_navigation_mesh", &LayerCollision::affects_navigation};

} // namespace

void ScatterLayer::set_collision_shape(CollisionShape p_shape) {
	if (accept_number(ScatterLayer::class_name, "collision_shape", static_cast<double>(p_shape), COLLISION_NONE,
				COLLISION_MODEL) &&
			get_collision_shape() != p_shape) {
		gameplay_.collision.shape = static_cast<BodyShape>(p_shape);
		mark_changed();
	}
}

ScatterLayer::CollisionShape ScatterLayer::get_collision_shape() const {
	return static_cast<CollisionShape>(gameplay_.collision.shape);
}

// Watches the new material, because bodies copy its values.
void ScatterLayer::set_physics_material(const Ref<PhysicsMaterial> &p_material) {
	if (physics_material_ == p_material) {
		return;
	}
	watch(physics_material_.ptr(), "changed", this, "emit_changed", false);
	physics_material_ = p_material;
	watch(physics_material_.ptr(), "changed", this, "emit_changed", true);
	mark_changed();
}

Ref<PhysicsMaterial> ScatterLayer::get_physics_material() const { return physics_material_; }

void ScatterLayer::set_scene(const Ref<PackedScene> &p_scene) {
	if (scene_ != p_scene) {
		scene_ = p_scene;
		mark_changed();
	}
}

Ref<PackedScene> ScatterLayer::get_scene() const { return scene_; }

void ScatterLayer::add_gameplay_problems(PackedStringArray &r_problems) const {
	if (scene_.is_valid() && gameplay_.scene.distance <= 0.0) {
		r_problems.push_back(
				"ScatterLayer.scene is not used: scene_distance is 0. Increase scene_distance, or clear scene.");
	}
	if (gameplay_.collision.shape == BodyShape::none) {
		if (physics_material_.is_valid()) {
			r_problems.push_back("ScatterLayer.physics_material is not used: collision_shape is None. Choose a shape, "
								 "or clear physics_material.");
		}
		return;
	}
	if (gameplay_.collision.distance <= 0.0 && !gameplay_.collision.affects_navigation) {
		r_problems.push_back(
				"ScatterLayer.collision_shape is not used: collision_distance is 0. Increase collision_distance.");
	}
	if (gameplay_.collision.layer == 0 && gameplay_.collision.mask == 0) {
		r_problems.push_back(
				"ScatterLayer.collision_shape collides with nothing: set collision_layer or collision_mask.");
	}
	if (gameplay_.collision.shape == BodyShape::capsule &&
			gameplay_.instance_height < 2.0 * gameplay_.instance_radius) {
		r_problems.push_back("ScatterLayer.instance_height is below two times instance_radius, the minimum height of a "
							 "capsule. Increase instance_height.");
	}
	if (gameplay_.collision.shape == BodyShape::convex) {
		if (!meshes_.has_mesh()) {
			r_problems.push_back("ScatterLayer.collision_shape is Convex, but the layer has no mesh to build a hull "
								 "from. Add a mesh.");
		}
	}
	const std::vector<std::vector<BodyPart>> bodies = meshes_.bodies();
	if (gameplay_.collision.shape == BodyShape::model && std::ranges::all_of(bodies, &std::vector<BodyPart>::empty)) {
		r_problems.push_back(
				"ScatterLayer.collision_shape is Model, but no model in meshes has shapes. Choose another shape.");
	}
}

void ScatterLayer::bind_gameplay() {
	ADD_GROUP("Gameplay", "");
	bind_number<instance_radius>();
	bind_number<instance_height>();
	bind_number<regrowth_time>();
	ADD_SUBGROUP("Collision", "");
	bind_guarded<&ScatterLayer::set_collision_shape>(D_METHOD("set_collision_shape", "shape"));
	bind_guarded<&ScatterLayer::get_collision_shape>(D_METHOD("get_collision_shape"));
	add_layer_property(PropertyUse::gameplay,
			PropertyInfo(Variant::INT, "collision_shape", PROPERTY_HINT_ENUM, "None,Capsule,Cylinder,Box,Convex,Model"),
			"set_collision_shape", "get_collision_shape");
	bind_number<collision_distance>();
	bind_integer<collision_layer>();
	bind_integer<collision_mask>();
	bind_guarded<&ScatterLayer::set_physics_material>(D_METHOD("set_physics_material", "material"));
	bind_guarded<&ScatterLayer::get_physics_material>(D_METHOD("get_physics_material"));
	add_layer_property(PropertyUse::gameplay,
			PropertyInfo(Variant::OBJECT, "physics_material", PROPERTY_HINT_RESOURCE_TYPE, "PhysicsMaterial"),
			"set_physics_material", "get_physics_material");
	bind_switch<affect_navigation_mesh>();
	ADD_SUBGROUP("Scene", "");
	bind_guarded<&ScatterLayer::set_scene>(D_METHOD("set_scene", "scene"));
	bind_guarded<&ScatterLayer::get_scene>(D_METHOD("get_scene"));
	add_layer_property(PropertyUse::gameplay,
			PropertyInfo(Variant::OBJECT, "scene", PROPERTY_HINT_RESOURCE_TYPE, "PackedScene"), "set_scene",
			"get_scene");
	bind_number<scene_distance>();
	BIND_ENUM_CONSTANT(COLLISION_NONE);
	BIND_ENUM_CONSTANT(COLLISION_CAPSULE);
	BIND_ENUM_CONSTANT(COLLISION_CYLINDER);
	BIND_ENUM_CONSTANT(COLLISION_BOX);
	BIND_ENUM_CONSTANT(COLLISION_CONVEX);
	BIND_ENUM_CONSTANT(COLLISION_MODEL);
}

} // namespace thicket
