#include "nodes/biome/scatter_biome.hpp"

#include "nodes/common/property_check.hpp"

#include <godot_cpp/core/class_db.hpp>

#include <utility>

using namespace godot;

namespace thicket {

void ScatterBiome::set_layers(const TypedArray<ScatterLayer> &p_layers) {
	layers_ = p_layers;
	emit_changed();
}

void ScatterBiome::set_color(const Color &p_color) {
	for (const float channel : {p_color.r, p_color.g, p_color.b, p_color.a}) {
		if (!accept_number(class_name, "color", channel, 0.0, 1.0)) {
			return;
		}
	}
	if (!(std::exchange(color_, p_color) == p_color)) {
		emit_changed();
	}
}

void ScatterBiome::set_density(double p_density) {
	if (accept_number(class_name, "density", p_density, 0.0, 1.0) && std::exchange(density_, p_density) != p_density) {
		emit_changed();
	}
}

void ScatterBiome::set_water_mode(WaterMode p_mode) {
	if (accept_number(class_name, "water_mode", static_cast<double>(p_mode), WATER_MODE_INHERIT, WATER_MODE_NONE) &&
			std::exchange(water_mode_, p_mode) != p_mode) {
		notify_property_list_changed();
		emit_changed();
	}
}

void ScatterBiome::set_water_level(double p_level) {
	if (accept_number(class_name, "water_level", p_level, -max_water_level, max_water_level) &&
			std::exchange(water_level_, p_level) != p_level) {
		emit_changed();
	}
}

/// Hides the water level in the inspector unless the biome has its own.
void ScatterBiome::_validate_property(PropertyInfo &p_property) const {
	if (p_property.name == StringName("water_level") && water_mode_ != WATER_MODE_OWN) {
		p_property.usage = PROPERTY_USAGE_NO_EDITOR;
	}
}

void ScatterBiome::_bind_methods() {
	using Self = ScatterBiome;
	bind_guarded<&Self::set_layers>(D_METHOD("set_layers", "layers"));
	bind_guarded<&Self::get_layers>(D_METHOD("get_layers"));
	bind_guarded<&Self::set_color>(D_METHOD("set_color", "color"));
	bind_guarded<&Self::get_color>(D_METHOD("get_color"));
	bind_guarded<&Self::set_density>(D_METHOD("set_density", "density"));
	bind_guarded<&Self::get_density>(D_METHOD("get_density"));
	bind_guarded<&Self::set_water_mode>(D_METHOD("set_water_mode", "mode"));
	bind_guarded<&Self::get_water_mode>(D_METHOD("get_water_mode"));
	bind_guarded<&Self::set_water_level>(D_METHOD("set_water_level", "level"));
	bind_guarded<&Self::get_water_level>(D_METHOD("get_water_level"));
	ADD_PROPERTY(PropertyInfo(Variant::ARRAY, "layers", PROPERTY_HINT_ARRAY_TYPE,
						 vformat("%d/%d:ScatterLayer", Variant::OBJECT, PROPERTY_HINT_RESOURCE_TYPE)),
			"set_layers", "get_layers");
	ADD_PROPERTY(PropertyInfo(Variant::COLOR, "color", PROPERTY_HINT_COLOR_NO_ALPHA), "set_color", "get_color");
	ADD_PROPERTY(
			PropertyInfo(Variant::FLOAT, "density", PROPERTY_HINT_RANGE, "0,1,0.001"), "set_density", "get_density");
	ADD_GROUP("Water", "water_");
	ADD_PROPERTY(PropertyInfo(Variant::INT, "water_mode", PROPERTY_HINT_ENUM, "Inherit,Own,None"), "set_water_mode",
			"get_water_mode");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "water_level", PROPERTY_HINT_RANGE,
						 "-1000,9000,0.01,or_less,or_greater,suffix:m"),
			"set_water_level", "get_water_level");
	BIND_ENUM_CONSTANT(WATER_MODE_INHERIT);
	BIND_ENUM_CONSTANT(WATER_MODE_OWN);
	BIND_ENUM_CONSTANT(WATER_MODE_NONE);
}

} // namespace thicket
