#pragma once

#include "core/base/world_frame.hpp"
#include "core/query/instance_query.hpp"
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

/// These functions convert transforms between world space and engine space, as in convert.hpp.
/// `frame` is the world position of the engine's origin, in meters.
godot::Transform3D to_engine(const PlacedInstance &instance, const WorldFrame &frame);
AddedInstance to_added(const godot::Transform3D &p_transform, const WorldFrame &frame);

/// Converts a script's predicate, (id: int, layer: ScatterLayer, transform: Transform3D) -> bool,
/// to QueryFilter::accepts. Returns an empty function for a null predicate. `layers` are the layers
/// of the queried instances. If a call fails or does not return a bool, the predicate prints one
/// error, which names `method` (`Class.method`), and rejects all remaining instances.
std::function<bool(const PlacedInstance &)> to_predicate(
		std::string method, const godot::Callable &p_predicate, const WorldFrame &frame, SharedLayers layers);

/// Decodes a script value that a state stores as bytes. Returns null for no bytes.
godot::Variant decoded(std::span<const std::uint8_t> bytes);

} // namespace thicket
