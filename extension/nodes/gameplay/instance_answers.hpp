#pragma once

#include "core/query/instance_query.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/layer/layer_reference.hpp"

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

/// Conversions between the world's space and the engine's, as in convert.hpp.
godot::Transform3D to_engine(const PlacedInstance &instance, glm::dvec3 offset);
AddedInstance to_added(const godot::Transform3D &p_transform, glm::dvec3 offset);

/// Converts a script's predicate, (id: int, layer: ScatterLayer, transform: Transform3D) -> bool, to
/// QueryFilter::accepts; empty if it is null. `layers` are the layers of the queried instances. A predicate that cannot
/// be called rejects everything and prints one error, which names `method` (`Class.method`).
std::function<bool(const PlacedInstance &)> to_predicate(
		std::string method, const godot::Callable &p_predicate, glm::dvec3 offset, SharedLayers layers);

/// A script's value that a state stores as bytes; null if there is none.
godot::Variant decoded(std::span<const std::uint8_t> bytes);

} // namespace thicket
