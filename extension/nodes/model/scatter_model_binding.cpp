// This file binds the methods and properties of ScatterModel for scripts.

#include "nodes/model/scatter_model.hpp"

#include <godot_cpp/core/class_db.hpp>

using namespace godot;

namespace thicket {

void ScatterModel::_bind_methods() {
	using Self = ScatterModel;
	bind_guarded<&Self::set_scene>(D_METHOD("set_scene", "scene"));
	bind_guarded<&Self::get_scene>(D_METHOD("get_scene"));
	bind_guarded<&Self::set_scene_part>(D_METHOD("set_scene_part", "path"));
	bind_guarded<&Self::get_scene_part>(D_METHOD("get_scene_part"));
	bind_guarded<&Self::set_replacement_materials>(D_METHOD("set_replacement_materials", "materials"));
	bind_guarded<&Self::get_replacement_materials>(D_METHOD("get_replacement_materials"));
	bind_guarded<&Self::get_material_name>(D_METHOD("get_material_name", "material"));
	bind_guarded<&Self::set_lods>(D_METHOD("set_lods", "lods"));
	bind_guarded<&Self::get_lods>(D_METHOD("get_lods"));
	bind_guarded<&Self::set_far_lods>(D_METHOD("set_far_lods", "lods"));
	bind_guarded<&Self::get_far_lods>(D_METHOD("get_far_lods"));
	bind_guarded<&Self::set_shapes>(D_METHOD("set_shapes", "shapes"));
	bind_guarded<&Self::get_shapes>(D_METHOD("get_shapes"));
	bind_guarded<&Self::set_shape_transforms>(D_METHOD("set_shape_transforms", "transforms"));
	bind_guarded<&Self::get_shape_transforms>(D_METHOD("get_shape_transforms"));
	bind_guarded<&Self::reload>(D_METHOD("reload"));
	bind_guarded<&Self::get_mesh>(D_METHOD("get_mesh", "lod"), DEFVAL(0));
	bind_guarded<&Self::get_aabb>(D_METHOD("get_aabb"));
	bind_guarded<&Self::get_problems>(D_METHOD("get_problems"));
	ADD_PROPERTY(PropertyInfo(Variant::OBJECT, "scene", PROPERTY_HINT_RESOURCE_TYPE, "PackedScene"), "set_scene",
			"get_scene");
	ADD_PROPERTY(PropertyInfo(Variant::STRING, "scene_part"), "set_scene_part", "get_scene_part");
	ADD_PROPERTY(PropertyInfo(Variant::DICTIONARY, "replacement_materials"), "set_replacement_materials",
			"get_replacement_materials");
	ADD_PROPERTY(PropertyInfo(Variant::ARRAY, "lods", PROPERTY_HINT_ARRAY_TYPE,
						 vformat("%d/%d:ScatterLod", Variant::OBJECT, PROPERTY_HINT_RESOURCE_TYPE)),
			"set_lods", "get_lods");
	ADD_PROPERTY(PropertyInfo(Variant::ARRAY, "far_lods", PROPERTY_HINT_ARRAY_TYPE,
						 vformat("%d/%d:ScatterLod", Variant::OBJECT, PROPERTY_HINT_RESOURCE_TYPE)),
			"set_far_lods", "get_far_lods");
	ADD_GROUP("Collision", "");
	ADD_PROPERTY(PropertyInfo(Variant::ARRAY, "shapes", PROPERTY_HINT_ARRAY_TYPE,
						 vformat("%d/%d:Shape3D", Variant::OBJECT, PROPERTY_HINT_RESOURCE_TYPE)),
			"set_shapes", "get_shapes");
	ADD_PROPERTY(PropertyInfo(Variant::ARRAY, "shape_transforms", PROPERTY_HINT_ARRAY_TYPE, "Transform3D"),
			"set_shape_transforms", "get_shape_transforms");
}

} // namespace thicket
