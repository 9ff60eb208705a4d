// This file contains the properties of ScatterLayer in the group Drawing.

#include "nodes/layer/layer_materials.hpp"
#include "nodes/common/engine_arrays.hpp"
#include "nodes/layer/scatter_layer_properties.hpp"

#include <array>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

constexpr NumberProperty extra_cull_margin{"extra_cull_margin", &LayerDrawing::extra_cull_margin, 0.0, max_cull_margin,
		PROPERTY_HINT_RANGE, "0,16384,0.01,exp,suffix:m"};
constexpr NumberProperty cast_shadow{
		"cast_shadow", &LayerDrawing::cast_shadow, 0, 3, PROPERTY_HINT_ENUM, "Off,On,Double-Sided,Shadows Only"};
constexpr NumberProperty gi_mode{
		"gi_mode", &LayerDrawing::gi_mode, 0, 2, PROPERTY_HINT_ENUM, "Disabled,Static,Dynamic"};
constexpr NumberProperty render_layers{
		"render_layers", &LayerDrawing::render_layers, 0, (1 << 20) - 1, PROPERTY_HINT_LAYERS_3D_RENDER};

/// Pairs of a property of ScatterLayer and the corresponding property of GeometryInstance3D.
constexpr std::array geometry_properties{
		std::pair{"material_override", "material_override"},
		std::pair{"cast_shadow", "cast_shadow"},
		std::pair{"gi_mode", "gi_mode"},
		std::pair{"render_layers", "layers"},
		std::pair{"extra_cull_margin", "extra_cull_margin"},
		std::pair{"lod_bias", "lod_bias"},
};

} // namespace

void ScatterLayer::set_material_override(const Ref<Material> &p_material) {
	material_override_ = p_material;
	mark_changed();
}

Ref<Material> ScatterLayer::get_material_override() const { return material_override_; }

TypedArray<Material> ScatterLayer::get_materials() {
	read_models();
	LayerDrawing drawing;
	LodSettings lod;
	drawing.material_override = material_override_;
	meshes_.draw(drawing, lod);
	TypedArray<Material> result;
	for (const Ref<Material> &material : materials_of(drawing)) {
		append(result, material);
	}
	return result;
}

Dictionary ScatterLayer::get_geometry_properties() const {
	Dictionary result;
	for (const auto &[name, geometry_name] : geometry_properties) {
		result[StringName(name)] = StringName(geometry_name);
	}
	return result;
}

void ScatterLayer::bind_drawing() {
	ADD_GROUP("Drawing", "");
	bind_guarded<&ScatterLayer::set_material_override>(D_METHOD("set_material_override", "material"));
	bind_guarded<&ScatterLayer::get_material_override>(D_METHOD("get_material_override"));
	add_layer_property(PropertyUse::drawing,
			PropertyInfo(
					Variant::OBJECT, "material_override", PROPERTY_HINT_RESOURCE_TYPE, "BaseMaterial3D,ShaderMaterial"),
			"set_material_override", "get_material_override");
	bind_guarded<&ScatterLayer::get_materials>(D_METHOD("get_materials"));
	bind_guarded<&ScatterLayer::get_geometry_properties>(D_METHOD("get_geometry_properties"));
	bind_integer<cast_shadow>();
	bind_integer<gi_mode>();
	bind_integer<render_layers>();
	bind_number<extra_cull_margin>();
	bind_sources();
}

} // namespace thicket
