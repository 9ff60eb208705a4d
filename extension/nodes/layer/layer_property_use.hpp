#pragma once

#include <godot_cpp/core/property_info.hpp>
#include <godot_cpp/variant/string_name.hpp>

#include <cstdint>

namespace thicket {

/// The aspect of a layer that a property of ScatterLayer affects.
enum class PropertyUse : std::uint8_t {
	placement, ///< The set of instances, and all their values that ScatterTile.get_rows returns.
	drawing,   ///< How instances are drawn.
	gameplay,  ///< How a game interacts with instances.
};

/// Adds a property of ScatterLayer, as ClassDB::add_property does, and records its use. All properties of ScatterLayer
/// are added through this function.
void add_layer_property(PropertyUse use, const godot::PropertyInfo &p_info, const godot::StringName &p_setter,
		const godot::StringName &p_getter);

/// The use of a property. `placement` for unknown names, such as a script's variables.
PropertyUse layer_property_use(const godot::StringName &p_property);

} // namespace thicket
