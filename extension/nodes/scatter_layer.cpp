#include "nodes/scatter_layer.hpp"

#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/variant/packed_string_array.hpp>

#include <cmath>

using namespace godot;

namespace thicket {

namespace {

constexpr const char *class_name = "ScatterLayer";

using Number = NumberProperty<LayerNumbers, double>;
using Integer = NumberProperty<LayerIntegers, int64_t>;

constexpr double far = 1e6; // Metres; farther than any view.

constexpr Number radius{"radius", &LayerNumbers::radius, min_radius, max_radius, PROPERTY_HINT_RANGE,
		"0.05,50,0.001,or_less,or_greater,suffix:m"};
constexpr Number tile_size{
		"tile_size", &LayerNumbers::tile_size, 0.1, 1e5, PROPERTY_HINT_RANGE, "8,512,0.1,or_less,or_greater,suffix:m"};
constexpr Number view_distance{
		"view_distance", &LayerNumbers::view_distance, 0.0, far, PROPERTY_HINT_RANGE, "0,4096,0.1,or_greater,suffix:m"};
constexpr Number density{"density", &LayerNumbers::density, 0.0, 1.0, PROPERTY_HINT_RANGE, "0,1,0.001"};
constexpr Number min_slope_degrees{
		"min_slope_degrees", &LayerNumbers::min_slope_degrees, 0.0, 90.0, PROPERTY_HINT_RANGE, "0,90,0.1,degrees"};
constexpr Number max_slope_degrees{
		"max_slope_degrees", &LayerNumbers::max_slope_degrees, 0.0, 90.0, PROPERTY_HINT_RANGE, "0,90,0.1,degrees"};
constexpr Number slope_falloff{
		"slope_falloff", &LayerNumbers::slope_falloff, 0.0, 90.0, PROPERTY_HINT_RANGE, "0,90,0.1,degrees"};
constexpr Number min_height{"min_height", &LayerNumbers::min_height, -unlimited_height, unlimited_height,
		PROPERTY_HINT_RANGE, "-1000,9000,0.1,or_less,or_greater,suffix:m"};
constexpr Number max_height{"max_height", &LayerNumbers::max_height, -unlimited_height, unlimited_height,
		PROPERTY_HINT_RANGE, "-1000,9000,0.1,or_less,or_greater,suffix:m"};
constexpr Number height_falloff{"height_falloff", &LayerNumbers::height_falloff, 0.0, unlimited_height,
		PROPERTY_HINT_RANGE, "0,1000,0.1,or_greater,suffix:m"};
constexpr Number min_yaw_degrees{
		"min_yaw_degrees", &LayerNumbers::min_yaw_degrees, -360.0, 360.0, PROPERTY_HINT_RANGE, "-360,360,0.1,degrees"};
constexpr Number max_yaw_degrees{
		"max_yaw_degrees", &LayerNumbers::max_yaw_degrees, -360.0, 360.0, PROPERTY_HINT_RANGE, "-360,360,0.1,degrees"};
constexpr Number min_scale{
		"min_scale", &LayerNumbers::min_scale, 1e-4, 1e4, PROPERTY_HINT_RANGE, "0.01,10,0.001,or_less,or_greater"};
constexpr Number max_scale{
		"max_scale", &LayerNumbers::max_scale, 1e-4, 1e4, PROPERTY_HINT_RANGE, "0.01,10,0.001,or_less,or_greater"};
constexpr Number align_to_normal{
		"align_to_normal", &LayerNumbers::align_to_normal, 0.0, 1.0, PROPERTY_HINT_RANGE, "0,1,0.01"};
constexpr Number height_offset{"height_offset", &LayerNumbers::height_offset, -1e4, 1e4, PROPERTY_HINT_RANGE,
		"-10,10,0.001,or_less,or_greater,suffix:m"};
constexpr Number lod_bias{"lod_bias", &LayerNumbers::lod_bias, 1e-3, 128.0, PROPERTY_HINT_RANGE, "0.001,128,0.001"};
constexpr Number extra_cull_margin{"extra_cull_margin", &LayerNumbers::extra_cull_margin, 0.0, 16384.0,
		PROPERTY_HINT_RANGE, "0,16384,0.01,suffix:m"};
constexpr Number visibility_range_begin{"visibility_range_begin", &LayerNumbers::visibility_range_begin, 0.0, far,
		PROPERTY_HINT_RANGE, "0,4096,0.01,or_greater,suffix:m"};
constexpr Number visibility_range_begin_margin{"visibility_range_begin_margin",
		&LayerNumbers::visibility_range_begin_margin, 0.0, far, PROPERTY_HINT_RANGE, "0,4096,0.01,or_greater,suffix:m"};
constexpr Number visibility_range_end{"visibility_range_end", &LayerNumbers::visibility_range_end, 0.0, far,
		PROPERTY_HINT_RANGE, "0,4096,0.01,or_greater,suffix:m"};
constexpr Number visibility_range_end_margin{"visibility_range_end_margin", &LayerNumbers::visibility_range_end_margin,
		0.0, far, PROPERTY_HINT_RANGE, "0,4096,0.01,or_greater,suffix:m"};

constexpr Integer layer_id{"layer_id", &LayerIntegers::layer_id, -1, 65535, PROPERTY_HINT_RANGE, "-1,65535,1"};
constexpr Integer levels{"levels", &LayerIntegers::levels, 1, max_levels, PROPERTY_HINT_RANGE, "1,8,1"};
constexpr Integer cast_shadow{
		"cast_shadow", &LayerIntegers::cast_shadow, 0, 3, PROPERTY_HINT_ENUM, "Off,On,Double-Sided,Shadows Only"};
constexpr Integer gi_mode{"gi_mode", &LayerIntegers::gi_mode, 0, 2, PROPERTY_HINT_ENUM, "Disabled,Static,Dynamic"};
constexpr Integer layers{"layers", &LayerIntegers::layers, 0, (1 << 20) - 1, PROPERTY_HINT_LAYERS_3D_RENDER};
constexpr Integer visibility_range_fade_mode{"visibility_range_fade_mode", &LayerIntegers::visibility_range_fade_mode,
		0, 2, PROPERTY_HINT_ENUM, "Disabled,Self,Dependencies"};

} // namespace

template <const Number &property>
void ScatterLayer::set_number(double p_value) {
	if (accept_number(class_name, property.name, p_value, property.min, property.max) &&
			numbers_.*property.member != p_value) {
		numbers_.*property.member = p_value;
		emit_changed();
	}
}

template <const Number &property>
double ScatterLayer::get_number() const {
	return numbers_.*property.member;
}

template <const Integer &property>
void ScatterLayer::set_integer(int64_t p_value) {
	if (accept_number(class_name, property.name, static_cast<double>(p_value), static_cast<double>(property.min),
				static_cast<double>(property.max)) &&
			integers_.*property.member != p_value) {
		integers_.*property.member = p_value;
		emit_changed();
	}
}

template <const Integer &property>
int64_t ScatterLayer::get_integer() const {
	return integers_.*property.member;
}

void ScatterLayer::set_meshes(const TypedArray<Mesh> &p_meshes) {
	if (p_meshes.size() > static_cast<int64_t>(max_meshes)) {
		report(class_name, {ErrorCode::out_of_range, "meshes", static_cast<double>(p_meshes.size())});
		return;
	}
	watch_meshes(false);
	meshes_ = p_meshes;
	watch_meshes(true);
	emit_changed();
}

// A mesh that grows needs larger boxes around its tiles.
void ScatterLayer::watch_meshes(bool p_watch) {
	const Callable on_change(this, "emit_changed");
	for (const Ref<Mesh> &mesh : mesh_list()) {
		if (mesh.is_null() || mesh->is_connected("changed", on_change) == p_watch) {
			continue;
		}
		if (p_watch) {
			mesh->connect("changed", on_change);
		} else {
			mesh->disconnect("changed", on_change);
		}
	}
}

TypedArray<Mesh> ScatterLayer::get_meshes() const { return meshes_; }

void ScatterLayer::set_mesh_weights(const PackedFloat32Array &p_weights) {
	for (const float weight : p_weights) {
		if (!accept_number(class_name, "mesh_weights", weight, 0.0, 1e6)) {
			return;
		}
	}
	mesh_weights_ = p_weights;
	emit_changed();
}

PackedFloat32Array ScatterLayer::get_mesh_weights() const { return mesh_weights_; }

void ScatterLayer::set_material_override(const Ref<Material> &p_material) {
	material_override_ = p_material;
	emit_changed();
}

Ref<Material> ScatterLayer::get_material_override() const { return material_override_; }

Rules ScatterLayer::core_rules() const {
	Rules rules;
	rules.density = numbers_.density;
	rules.min_slope_degrees = numbers_.min_slope_degrees;
	rules.max_slope_degrees = numbers_.max_slope_degrees;
	rules.slope_falloff = numbers_.slope_falloff;
	rules.min_height = numbers_.min_height;
	rules.max_height = numbers_.max_height;
	rules.height_falloff = numbers_.height_falloff;
	return rules;
}

LayerSettings ScatterLayer::settings(std::uint64_t seed, std::size_t place) const {
	LayerSettings result;
	const bool own_id = integers_.layer_id >= 0;
	result.set.seed = seed;
	result.set.radius = numbers_.radius;
	result.set.levels = static_cast<std::uint32_t>(integers_.levels);
	result.set.layer = static_cast<std::uint16_t>(own_id ? static_cast<std::size_t>(integers_.layer_id) : place);
	result.rules = core_rules();
	result.placement = {numbers_.min_yaw_degrees, numbers_.max_yaw_degrees, numbers_.min_scale, numbers_.max_scale,
			numbers_.align_to_normal, numbers_.height_offset};
	for (int64_t mesh = 0; mesh < meshes_.size(); ++mesh) {
		result.mesh_weights.push_back(mesh < mesh_weights_.size() ? mesh_weights_[mesh] : 1.0F);
	}
	return result;
}

StreamLayer ScatterLayer::streaming() const { return {numbers_.tile_size, numbers_.view_distance}; }

std::vector<Ref<Mesh>> ScatterLayer::mesh_list() const {
	std::vector<Ref<Mesh>> result;
	for (int64_t mesh = 0; mesh < meshes_.size(); ++mesh) {
		result.emplace_back(meshes_[mesh]);
	}
	return result;
}

Status ScatterLayer::check() const {
	const LayerSettings whole = settings(0, 0);
	const Status status = validate(whole);
	if (!status.ok()) {
		return status;
	}
	if (point_density(whole.set) * numbers_.tile_size * numbers_.tile_size > max_tile_points) {
		return {ErrorCode::too_many_points, "tile_size", numbers_.tile_size};
	}
	if (numbers_.view_distance > max_view_tiles * numbers_.tile_size) {
		return {ErrorCode::out_of_range, "view_distance", numbers_.view_distance};
	}
	return {};
}

PackedStringArray ScatterLayer::problems() const {
	PackedStringArray result;
	const Status status = check();
	if (!status.ok()) {
		result.push_back(sentence(class_name, status));
	}
	bool any_mesh = false;
	for (const Ref<Mesh> &mesh : mesh_list()) {
		any_mesh = any_mesh || mesh.is_valid();
	}
	if (!any_mesh) {
		result.push_back("ScatterLayer.meshes has no mesh: the layer draws nothing.");
	}
	if (mesh_weights_.size() > meshes_.size()) {
		result.push_back("ScatterLayer.mesh_weights has more entries than meshes; the rest is not used.");
	}
	return result;
}

template <const Number &property>
void ScatterLayer::bind_number() {
	const String name = property.name;
	const String setter = "set_" + name;
	const String getter = "get_" + name;
	ClassDB::bind_method(D_METHOD(StringName(setter), "value"), &ScatterLayer::set_number<property>);
	ClassDB::bind_method(D_METHOD(StringName(getter)), &ScatterLayer::get_number<property>);
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, name, property.hint, property.hint_string), setter, getter);
}

template <const Integer &property>
void ScatterLayer::bind_integer() {
	const String name = property.name;
	const String setter = "set_" + name;
	const String getter = "get_" + name;
	ClassDB::bind_method(D_METHOD(StringName(setter), "value"), &ScatterLayer::set_integer<property>);
	ClassDB::bind_method(D_METHOD(StringName(getter)), &ScatterLayer::get_integer<property>);
	ADD_PROPERTY(PropertyInfo(Variant::INT, name, property.hint, property.hint_string), setter, getter);
}

void ScatterLayer::bind_placing() {
	bind_number<radius>();
	bind_integer<levels>();
	bind_integer<layer_id>();
	ADD_GROUP("Streaming", "");
	bind_number<tile_size>();
	bind_number<view_distance>();
	ADD_GROUP("Rules", "");
	bind_number<density>();
	bind_number<min_slope_degrees>();
	bind_number<max_slope_degrees>();
	bind_number<slope_falloff>();
	bind_number<min_height>();
	bind_number<max_height>();
	bind_number<height_falloff>();
	ADD_GROUP("Placement", "");
	bind_number<min_scale>();
	bind_number<max_scale>();
	bind_number<min_yaw_degrees>();
	bind_number<max_yaw_degrees>();
	bind_number<align_to_normal>();
	bind_number<height_offset>();
}

void ScatterLayer::bind_drawing() {
	ADD_GROUP("Drawing", "");
	ClassDB::bind_method(D_METHOD("set_meshes", "meshes"), &ScatterLayer::set_meshes);
	ClassDB::bind_method(D_METHOD("get_meshes"), &ScatterLayer::get_meshes);
	ADD_PROPERTY(PropertyInfo(Variant::ARRAY, "meshes", PROPERTY_HINT_ARRAY_TYPE,
						 vformat("%d/%d:Mesh", Variant::OBJECT, PROPERTY_HINT_RESOURCE_TYPE)),
			"set_meshes", "get_meshes");
	ClassDB::bind_method(D_METHOD("set_mesh_weights", "weights"), &ScatterLayer::set_mesh_weights);
	ClassDB::bind_method(D_METHOD("get_mesh_weights"), &ScatterLayer::get_mesh_weights);
	ADD_PROPERTY(PropertyInfo(Variant::PACKED_FLOAT32_ARRAY, "mesh_weights"), "set_mesh_weights", "get_mesh_weights");
	ClassDB::bind_method(D_METHOD("set_material_override", "material"), &ScatterLayer::set_material_override);
	ClassDB::bind_method(D_METHOD("get_material_override"), &ScatterLayer::get_material_override);
	ADD_PROPERTY(PropertyInfo(Variant::OBJECT, "material_override", PROPERTY_HINT_RESOURCE_TYPE,
						 "BaseMaterial3D,ShaderMaterial"),
			"set_material_override", "get_material_override");
	bind_integer<cast_shadow>();
	bind_integer<gi_mode>();
	bind_integer<layers>();
	bind_number<lod_bias>();
	bind_number<extra_cull_margin>();
	ADD_GROUP("Visibility Range", "visibility_range_");
	bind_number<visibility_range_begin>();
	bind_number<visibility_range_begin_margin>();
	bind_number<visibility_range_end>();
	bind_number<visibility_range_end_margin>();
	bind_integer<visibility_range_fade_mode>();
}

void ScatterLayer::_bind_methods() {
	bind_placing();
	bind_drawing();
}

} // namespace thicket
