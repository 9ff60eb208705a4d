#pragma once

#include "core/query/instance_query.hpp"

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

namespace thicket {

/// The same id as a script has it.
constexpr std::int64_t script_id(std::uint64_t id) { return static_cast<std::int64_t>(id); }
constexpr std::uint64_t core_id(std::int64_t id) { return static_cast<std::uint64_t>(id); }

godot::PackedInt64Array packed_ids(std::span<const std::uint64_t> ids);
godot::PackedFloat32Array packed_floats(std::span<const float> numbers);

/// Between positions in the world and the engine's, of which `offset` is the engine's origin, in world meters.
Rect to_world(const godot::Rect2 &p_rect, glm::dvec3 offset);
glm::dvec3 to_world(const godot::Vector3 &p_position, glm::dvec3 offset);
godot::Vector3 to_engine(glm::dvec3 position, glm::dvec3 offset);
godot::Transform3D to_engine(const PlacedInstance &instance, glm::dvec3 offset);
AddedInstance to_added(const godot::Transform3D &p_transform, glm::dvec3 offset);
PlacedInstance to_placed(const AddedInstance &added, std::uint64_t id, std::uint32_t layer);

/// A predicate of a script, (id: int, layer: int, transform: Transform3D) -> bool, as QueryFilter::accepts; none for a null one.
/// One that cannot be called lets nothing pass and prints one error.
std::function<bool(const PlacedInstance &)> to_predicate(
		const char *p_method, const godot::Callable &p_predicate, glm::dvec3 offset);

} // namespace thicket
