#pragma once

#include <godot_cpp/variant/variant.hpp>

#include <functional>
#include <optional>

namespace thicket {

/// A change of the references to layers that properties store. Called with the name of the property and one reference,
/// in the form of stored_reference. Returns the new reference; empty to keep the old one.
using ReferenceChange =
		std::function<std::optional<godot::Variant>(const char *p_property, const godot::Variant &p_stored)>;

} // namespace thicket
