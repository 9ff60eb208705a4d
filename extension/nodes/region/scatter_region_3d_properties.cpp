// This file contains the properties of ScatterRegion3D: their validation, binding, and visibility
// in the inspector.

#include "nodes/region/scatter_region_3d.hpp"

#include "nodes/common/engine_arrays.hpp"
#include "nodes/layer/layer_reference.hpp"

#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/error_macros.hpp>

#include <cstdint>

using namespace godot;

namespace thicket {

namespace {

/// The limits of all lengths, in meters.
constexpr double min_side = 1e-3;
constexpr double max_side = 1e6;

using Number = NumberProperty<RegionSizes, double>;

constexpr Number falloff{
		"falloff", &RegionSizes::falloff, 0.0, max_side, PROPERTY_HINT_RANGE, "0,100,0.01,or_greater,suffix:m"};
constexpr Number radius{"radius", &RegionSizes::radius, min_side, max_side, PROPERTY_HINT_RANGE,
		"0.01,1000,0.01,or_less,or_greater,suffix:m"};
constexpr Number height{"height", &RegionSizes::height, min_side, max_side, PROPERTY_HINT_RANGE,
		"0.01,1000,0.01,or_less,or_greater,suffix:m"};
constexpr Number width{"width", &RegionSizes::width, min_side, max_side, PROPERTY_HINT_RANGE,
		"0.01,200,0.01,or_less,or_greater,suffix:m"};

} // namespace

void ScatterRegion3D::set_shape(Shape p_shape) {
	if (accept_number(class_name, "shape", p_shape, SHAPE_BOX, SHAPE_PATH) && shape_ != p_shape) {
		shape_ = p_shape;
		notify_property_list_changed();
		notify_change();
	}
}

void ScatterRegion3D::set_exclude(bool p_exclude) {
	exclude_ = p_exclude;
	notify_change();
}

void ScatterRegion3D::set_layers(const Array &p_layers) {
	Array references;
	for (int64_t i = 0; i < p_layers.size(); ++i) {
		append(references, stored_reference(p_layers[i]));
		if (references[i].get_type() == Variant::NIL) {
			ERR_PRINT("ScatterRegion3D.layers: " + no_reference(p_layers[i]));
			return;
		}
	}
	layers_ = references;
	notify_change();
}

Array ScatterRegion3D::get_layers() const { return current_references(layers_); }

void ScatterRegion3D::change_references(const ReferenceChange &change) {
	const auto changed_layer = [&](const Variant &p_reference) {
		return change("ScatterRegion3D.layers", p_reference);
	};
	if (const auto references = changed_references(layers_, changed_layer)) {
		set_layers(*references);
	}
}

void ScatterRegion3D::set_ignore_height(bool p_ignore) {
	ignore_height_ = p_ignore;
	notify_change();
}

void ScatterRegion3D::set_size(const Vector3 &p_size) {
	for (const real_t side : {p_size.x, p_size.y, p_size.z}) {
		if (!accept_number(class_name, "size", side, min_side, max_side)) {
			return;
		}
	}
	size_ = p_size;
	notify_change();
}

void ScatterRegion3D::set_polygon(const PackedVector2Array &p_polygon) {
	if (p_polygon.size() > static_cast<int64_t>(max_outline_points)) {
		report(class_name,
				Status::out_of_range(
						"polygon", p_polygon.size(), at_most(max_outline_points, "points"), "Simplify the outline"));
		return;
	}
	for (const Vector2 &corner : p_polygon) {
		for (const real_t coordinate : {corner.x, corner.y}) {
			if (!accept_number(class_name, "polygon", coordinate, -max_shape_coordinate, max_shape_coordinate)) {
				return;
			}
		}
	}
	polygon_ = p_polygon;
	notify_change();
}

void ScatterRegion3D::set_path_node(const NodePath &p_path) {
	path_ = p_path;
	notify_change();
}

template <const Number &property>
void ScatterRegion3D::set_number(double p_value) {
	if (accept_number(class_name, property.name, p_value, property.min, property.max) &&
			numbers_.*property.member != p_value) {
		numbers_.*property.member = p_value;
		notify_change();
	}
}

template <const Number &property>
double ScatterRegion3D::get_number() const {
	return numbers_.*property.member;
}

template <const Number &property>
void ScatterRegion3D::bind_number() {
	const String name = property.name;
	const String setter = "set_" + name;
	const String getter = "get_" + name;
	bind_guarded<&ScatterRegion3D::set_number<property>>(D_METHOD(StringName(setter), "value"));
	bind_guarded<&ScatterRegion3D::get_number<property>>(D_METHOD(StringName(getter)));
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, name, property.hint, property.hint_string), setter, getter);
}

/// Hides the properties that the current shape does not use. Hidden properties are still saved, so
/// switching shapes loses no values.
void ScatterRegion3D::_validate_property(PropertyInfo &p_property) const {
	struct PropertyUse {
		const char *property;
		unsigned shapes; ///< A bit mask of the shapes that use the property.
	};
	constexpr unsigned box = 1U << SHAPE_BOX;
	constexpr unsigned sphere = 1U << SHAPE_SPHERE;
	constexpr unsigned cylinder = 1U << SHAPE_CYLINDER;
	constexpr unsigned polygon = 1U << SHAPE_POLYGON;
	constexpr unsigned path = 1U << SHAPE_PATH;
	static constexpr PropertyUse uses[] = {
			{"ignore_height", box | sphere | cylinder},
			{"size", box},
			{"radius", sphere | cylinder},
			{"height", cylinder},
			{"polygon", polygon},
			{"path", path},
			{"width", path},
	};
	for (const PropertyUse &use : uses) {
		if (((use.shapes >> shape_) & 1U) == 0 && p_property.name == StringName(use.property)) {
			p_property.usage &= ~static_cast<uint32_t>(PROPERTY_USAGE_EDITOR);
		}
	}
}

void ScatterRegion3D::_bind_methods() {
	using Self = ScatterRegion3D;
	bind_guarded<&Self::set_shape>(D_METHOD("set_shape", "shape"));
	bind_guarded<&Self::get_shape>(D_METHOD("get_shape"));
	bind_guarded<&Self::set_exclude>(D_METHOD("set_exclude", "exclude"));
	bind_guarded<&Self::is_excluding>(D_METHOD("is_excluding"));
	bind_guarded<&Self::set_layers>(D_METHOD("set_layers", "layers"));
	bind_guarded<&Self::get_layers>(D_METHOD("get_layers"));
	bind_guarded<&Self::set_ignore_height>(D_METHOD("set_ignore_height", "ignore"));
	bind_guarded<&Self::is_ignoring_height>(D_METHOD("is_ignoring_height"));
	bind_guarded<&Self::set_size>(D_METHOD("set_size", "size"));
	bind_guarded<&Self::get_size>(D_METHOD("get_size"));
	bind_guarded<&Self::set_polygon>(D_METHOD("set_polygon", "polygon"));
	bind_guarded<&Self::get_polygon>(D_METHOD("get_polygon"));
	bind_guarded<&Self::set_path_node>(D_METHOD("set_path_node", "path"));
	bind_guarded<&Self::get_path_node>(D_METHOD("get_path_node"));
	bind_guarded<&Self::get_problems>(D_METHOD("get_problems"));
	bind_guarded<&Self::to_planet_map>(D_METHOD("_to_planet_map", "positions"));
	bind_guarded<&Self::from_planet_map>(D_METHOD("_from_planet_map", "places"));
	ADD_PROPERTY(PropertyInfo(Variant::INT, "shape", PROPERTY_HINT_ENUM, "Box,Sphere,Cylinder,Polygon,Path"),
			"set_shape", "get_shape");
	ADD_PROPERTY(PropertyInfo(Variant::BOOL, "exclude"), "set_exclude", "is_excluding");
	ADD_PROPERTY(PropertyInfo(Variant::ARRAY, "layers"), "set_layers", "get_layers");
	bind_number<falloff>();
	ADD_PROPERTY(PropertyInfo(Variant::BOOL, "ignore_height"), "set_ignore_height", "is_ignoring_height");
	ADD_GROUP("Box", "");
	ADD_PROPERTY(PropertyInfo(Variant::VECTOR3, "size", PROPERTY_HINT_NONE, "suffix:m"), "set_size", "get_size");
	ADD_GROUP("Sphere and Cylinder", "");
	bind_number<radius>();
	bind_number<height>();
	ADD_GROUP("Polygon", "");
	ADD_PROPERTY(PropertyInfo(Variant::PACKED_VECTOR2_ARRAY, "polygon", PROPERTY_HINT_NONE, "suffix:m"), "set_polygon",
			"get_polygon");
	ADD_GROUP("Path", "");
	ADD_PROPERTY(PropertyInfo(Variant::NODE_PATH, "path", PROPERTY_HINT_NODE_PATH_VALID_TYPES, "Path3D"),
			"set_path_node", "get_path_node");
	bind_number<width>();
	BIND_ENUM_CONSTANT(SHAPE_BOX);
	BIND_ENUM_CONSTANT(SHAPE_SPHERE);
	BIND_ENUM_CONSTANT(SHAPE_CYLINDER);
	BIND_ENUM_CONSTANT(SHAPE_POLYGON);
	BIND_ENUM_CONSTANT(SHAPE_PATH);
}

} // namespace thicket
