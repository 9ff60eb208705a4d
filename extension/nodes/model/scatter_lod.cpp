#include "nodes/model/scatter_lod.hpp"

#include "nodes/common/property_check.hpp"
#include "nodes/common/watch.hpp"

#include <godot_cpp/core/class_db.hpp>

using namespace godot;

namespace thicket {

namespace {

constexpr double max_distance = 1e6; ///< The maximum distance in meters. Equals max_lod_distance.

} // namespace

/// Replaces a mesh and watches the new one instead of the old one. The old mesh stays watched if
/// the other mesh property still uses it.
void ScatterLod::replace(Ref<Mesh> &r_mesh, const Ref<Mesh> &p_mesh) {
	if (r_mesh == p_mesh) {
		return;
	}
	const Ref<Mesh> before = r_mesh;
	r_mesh = p_mesh;
	if (!(before == mesh_) && !(before == shadow_mesh_)) {
		watch(before.ptr(), "changed", this, "emit_changed", false);
	}
	watch(p_mesh.ptr(), "changed", this, "emit_changed", true);
	emit_changed();
}

void ScatterLod::set_mesh(const Ref<Mesh> &p_mesh) { replace(mesh_, p_mesh); }

void ScatterLod::set_shadow_mesh(const Ref<Mesh> &p_mesh) { replace(shadow_mesh_, p_mesh); }

void ScatterLod::set_distance(double p_distance) {
	if (accept_number(class_name, "distance", p_distance, 0.0, max_distance) && distance_ != p_distance) {
		distance_ = p_distance;
		emit_changed();
	}
}

void ScatterLod::set_density(double p_density) {
	if (accept_number(class_name, "density", p_density, 0.0, 1.0) && appearance_.density != p_density) {
		appearance_.density = p_density;
		emit_changed();
	}
}

void ScatterLod::set_transparency(double p_transparency) {
	if (accept_number(class_name, "transparency", p_transparency, 0.0, 1.0) &&
			appearance_.transparency != p_transparency) {
		appearance_.transparency = p_transparency;
		emit_changed();
	}
}

void ScatterLod::set_instance_shader_parameters(const Dictionary &p_parameters) {
	ShaderParameters parameters;
	const Array names = p_parameters.keys();
	for (int64_t index = 0; index < names.size(); ++index) {
		parameters.emplace_back(StringName(static_cast<String>(names[index])), p_parameters[names[index]]);
	}
	appearance_.parameters =
			parameters.empty() ? nullptr : std::make_shared<const ShaderParameters>(std::move(parameters));
	emit_changed();
}

void ScatterLod::set_appearance(const LodAppearance &appearance) {
	if (!(appearance == appearance_)) {
		appearance_ = appearance;
		emit_changed();
	}
}

Dictionary ScatterLod::get_instance_shader_parameters() const {
	Dictionary result;
	for (const auto &[name, value] : appearance_.parameters != nullptr ? *appearance_.parameters : ShaderParameters()) {
		result[name] = value;
	}
	return result;
}

void ScatterLod::set_cast_shadow(CastShadow p_setting) {
	if (accept_number(class_name, "cast_shadow", static_cast<double>(p_setting), CAST_SHADOW_LAYER,
				CAST_SHADOW_SHADOWS_ONLY) &&
			cast_shadow_ != p_setting) {
		cast_shadow_ = p_setting;
		emit_changed();
	}
}

void ScatterLod::_bind_methods() {
	using Self = ScatterLod;
	bind_guarded<&Self::set_mesh>(D_METHOD("set_mesh", "mesh"));
	bind_guarded<&Self::get_mesh>(D_METHOD("get_mesh"));
	bind_guarded<&Self::set_distance>(D_METHOD("set_distance", "distance"));
	bind_guarded<&Self::get_distance>(D_METHOD("get_distance"));
	bind_guarded<&Self::set_density>(D_METHOD("set_density", "density"));
	bind_guarded<&Self::get_density>(D_METHOD("get_density"));
	bind_guarded<&Self::set_cast_shadow>(D_METHOD("set_cast_shadow", "setting"));
	bind_guarded<&Self::get_cast_shadow>(D_METHOD("get_cast_shadow"));
	bind_guarded<&Self::set_shadow_mesh>(D_METHOD("set_shadow_mesh", "mesh"));
	bind_guarded<&Self::get_shadow_mesh>(D_METHOD("get_shadow_mesh"));
	ADD_PROPERTY(PropertyInfo(Variant::OBJECT, "mesh", PROPERTY_HINT_RESOURCE_TYPE, "Mesh"), "set_mesh", "get_mesh");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "distance", PROPERTY_HINT_RANGE, "0,4096,0.1,or_greater,exp,suffix:m"),
			"set_distance", "get_distance");
	ADD_PROPERTY(
			PropertyInfo(Variant::FLOAT, "density", PROPERTY_HINT_RANGE, "0,1,0.001"), "set_density", "get_density");
	ADD_PROPERTY(PropertyInfo(Variant::INT, "cast_shadow", PROPERTY_HINT_ENUM,
						 "As the Layer:-1,Off:0,On:1,Double-Sided:2,Shadows Only:3"),
			"set_cast_shadow", "get_cast_shadow");
	bind_guarded<&Self::set_transparency>(D_METHOD("set_transparency", "transparency"));
	bind_guarded<&Self::get_transparency>(D_METHOD("get_transparency"));
	bind_guarded<&Self::set_instance_shader_parameters>(D_METHOD("set_instance_shader_parameters", "parameters"));
	bind_guarded<&Self::get_instance_shader_parameters>(D_METHOD("get_instance_shader_parameters"));
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "transparency", PROPERTY_HINT_RANGE, "0,1,0.01"), "set_transparency",
			"get_transparency");
	ADD_PROPERTY(PropertyInfo(Variant::DICTIONARY, "instance_shader_parameters"), "set_instance_shader_parameters",
			"get_instance_shader_parameters");
	ADD_PROPERTY(PropertyInfo(Variant::OBJECT, "shadow_mesh", PROPERTY_HINT_RESOURCE_TYPE, "Mesh"), "set_shadow_mesh",
			"get_shadow_mesh");
	BIND_ENUM_CONSTANT(CAST_SHADOW_LAYER);
	BIND_ENUM_CONSTANT(CAST_SHADOW_OFF);
	BIND_ENUM_CONSTANT(CAST_SHADOW_ON);
	BIND_ENUM_CONSTANT(CAST_SHADOW_DOUBLE_SIDED);
	BIND_ENUM_CONSTANT(CAST_SHADOW_SHADOWS_ONLY);
}

} // namespace thicket
