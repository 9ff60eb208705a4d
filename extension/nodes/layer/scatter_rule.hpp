#pragma once

#include "core/placement/layer.hpp"
#include "core/rules/density_rule.hpp"
#include "nodes/common/guard.hpp"

#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/core/gdvirtual.gen.inc>
#include <godot_cpp/variant/aabb.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/packed_vector3_array.hpp>
#include <godot_cpp/variant/string.hpp>
#include <godot_cpp/variant/vector2.hpp>

#include <string>

namespace thicket {

// In godot-cpp 4.4, GDVIRTUAL0RC and similar macros use these names without a namespace.
using godot::METHOD_FLAG_CONST;
using godot::METHOD_FLAG_VIRTUAL;

/// A density rule of a ScatterLayer, implemented by a script. The script must emit `changed` when
/// the densities may have changed.
class ScatterRule : public godot::Resource {
	GDCLASS(ScatterRule, godot::Resource)

public:
	static constexpr const char *class_name = "ScatterRule";

	/// Returns a rule that calls the script, for snapshots of a layer. Returns null if the script has
	/// no `_get_densities`. Runs the script. Main thread only.
	SharedDensityRule make_rule();

	/// Returns the name for explanations: that of the resource, its script or its class.
	std::string display_name();

	/// Returns a message that explains why this rule has no effect; empty if it has one.
	godot::String problem() const;

	GDVIRTUAL4RC(godot::PackedFloat32Array, _get_densities, godot::PackedVector3Array, godot::PackedVector3Array,
			godot::PackedFloat32Array, godot::PackedFloat32Array)
	GDVIRTUAL1RC(godot::Vector2, _get_density_bounds, godot::AABB)
	GDVIRTUAL0RC(bool, _is_thread_safe)

protected:
	static void _bind_methods();
};

/// Returns a message about the density rule that caused the error `status` of a layer, or of a layer
/// on which it depends; empty if none did. Any thread may call this function.
std::string density_rule_problem(const LayerSettings &layer, const Status &status);

} // namespace thicket
