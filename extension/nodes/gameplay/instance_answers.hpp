#pragma once

#include "core/query/instance_query.hpp"
#include "nodes/common/convert.hpp"

#include <godot_cpp/variant/callable.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/packed_int64_array.hpp>
#include <godot_cpp/variant/rect2.hpp>
#include <godot_cpp/variant/transform3d.hpp>
#include <godot_cpp/variant/vector3.hpp>

#include <glm/vec3.hpp>

#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace thicket {

/// Between the world's space and the engine's, as in convert.hpp.
godot::Transform3D to_engine(const PlacedInstance &instance, glm::dvec3 offset);
AddedInstance to_added(const godot::Transform3D &p_transform, glm::dvec3 offset);
/// A predicate of a script, (id: int, layer: int, transform: Transform3D) -> bool, as QueryFilter::accepts; none for a null one.
/// One that cannot be called lets nothing pass and prints one error, for `method` (`Class.method`).
std::function<bool(const PlacedInstance &)> to_predicate(
		std::string method, const godot::Callable &p_predicate, glm::dvec3 offset);

/// A value of a script that a state keeps as bytes; null for none.
godot::Variant decoded(std::span<const std::uint8_t> bytes);

} // namespace thicket
