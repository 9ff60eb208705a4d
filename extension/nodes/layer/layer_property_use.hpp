#pragma once

#include <godot_cpp/core/property_info.hpp>
#include <godot_cpp/variant/string_name.hpp>

#include <cstdint>

namespace thicket {

/// The aspect of a layer that a property of ScatterLayer affects.
enum class PropertyUse : std::uint8_t {
	placement, ///< The set of instances, and all their values that ScatterTile.get_rows returns.
	drawing,   ///< The drawing of instances.
	gameplay,  ///< How games interact with instances, for example collision.
};

/// Adds a property of ScatterLayer to ClassDB and records its use. All properties of ScatterLayer
/// must be added with this function.
void add_layer_property(PropertyUse use, const godot::PropertyInfo &p_info, const godot::StringName &p_setter,
		const godot::StringName &p_getter);

/// Returns the use of a property; `placement` for unknown names, such as variables of a script.
PropertyUse layer_property_use(const godot::StringName &p_property);

} // namespace thicket
