#pragma once

#include "nodes/common/guard.hpp"
#include "nodes/layer/scatter_layer.hpp"

#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/variant/color.hpp>
#include <godot_cpp/variant/typed_array.hpp>

#include <cstdint>

namespace thicket {

/// The layers that grow in one kind of terrain, such as a meadow, a forest or a swamp. Contains
/// settings only; a ScatterBiomeMap defines where the biome is.
///
/// Setters emit `changed`. Scripts share the array of layers and may modify it in place.
class ScatterBiome : public godot::Resource, public ThreadGuarded {
	GDCLASS(ScatterBiome, godot::Resource)
	THICKET_GUARDED_METHODS(owner)

public:
	static constexpr const char *class_name = "ScatterBiome";

	/// The source of the biome's water level.
	enum WaterMode : std::int64_t {
		WATER_MODE_INHERIT, ///< The node's water level, if it has water.
		WATER_MODE_OWN,     ///< The biome's `water_level`.
		WATER_MODE_NONE,    ///< No water.
	};

	/// Sets the layers of the biome. Null entries are ignored. A layer may belong to several
	/// biomes.
	void set_layers(const godot::TypedArray<ScatterLayer> &p_layers);
	godot::TypedArray<ScatterLayer> get_layers() const { return layers_; }

	/// Sets the color of the map pixels that represent this biome.
	void set_color(const godot::Color &p_color);
	godot::Color get_color() const { return color_; }

	/// Sets a density factor for all layers in this biome, 0 to 1.
	void set_density(double p_density);
	double get_density() const { return density_; }

	void set_water_mode(WaterMode p_mode);
	WaterMode get_water_mode() const { return water_mode_; }

	/// Sets the water level in world meters, from -max_water_level to max_water_level. The level is
	/// used only with WATER_MODE_OWN.
	void set_water_level(double p_level);
	double get_water_level() const { return water_level_; }

	static constexpr double max_water_level = 1e6;

protected:
	static void _bind_methods();
	void _validate_property(godot::PropertyInfo &p_property) const;

private:
	godot::TypedArray<ScatterLayer> layers_;
	godot::Color color_{1.0F, 1.0F, 1.0F};
	double density_ = 1.0;
	WaterMode water_mode_ = WATER_MODE_INHERIT;
	double water_level_ = 0.0;
};

} // namespace thicket

VARIANT_ENUM_CAST(thicket::ScatterBiome::WaterMode)
