#pragma once

#include <godot_cpp/variant/variant.hpp>

#include <functional>
#include <optional>

namespace thicket {

/// A function that changes the references to layers that properties store. Receives the name of the
/// property and one stored reference (see stored_reference). Returns the new reference; empty to
/// keep the old one.
using ReferenceChange =
		std::function<std::optional<godot::Variant>(const char *p_property, const godot::Variant &p_stored)>;

} // namespace thicket
