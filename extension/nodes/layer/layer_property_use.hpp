#pragma once

#include <godot_cpp/core/property_info.hpp>
#include <godot_cpp/variant/string_name.hpp>

#include <cstdint>

namespace thicket {

/// What a property of a ScatterLayer decides.
enum class PropertyUse : std::uint8_t {
	placement, ///< Which instances there are, where, and all else that ScatterTile.get_rows returns of them.
	drawing,   ///< How they are drawn.
	gameplay,  ///< How a game meets them.
};

/// ClassDB::add_property for ScatterLayer, whose properties are all added by this: it also keeps the use.
void add_layer_property(PropertyUse use, const godot::PropertyInfo &p_info, const godot::StringName &p_setter,
		const godot::StringName &p_getter);

/// The use of a property; placement for a name that is none, as of a variable of a script.
PropertyUse layer_property_use(const godot::StringName &p_property);

} // namespace thicket
