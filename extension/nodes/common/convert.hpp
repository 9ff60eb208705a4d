#pragma once

#include "core/base/rect.hpp"
#include "core/base/world_frame.hpp"
#include "nodes/common/engine_arrays.hpp"

#include <godot_cpp/variant/packed_byte_array.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/packed_float64_array.hpp>
#include <godot_cpp/variant/packed_int32_array.hpp>
#include <godot_cpp/variant/packed_int64_array.hpp>
#include <godot_cpp/variant/packed_vector2_array.hpp>
#include <godot_cpp/variant/packed_vector3_array.hpp>
#include <godot_cpp/variant/rect2.hpp>
#include <godot_cpp/variant/transform3d.hpp>
#include <godot_cpp/variant/vector2.hpp>
#include <godot_cpp/variant/vector3.hpp>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <cstdint>
#include <span>

namespace thicket {

// Conversions between the types of the core and of the engine. The core stores positions in double
// precision, relative to the world's origin. Conversions to the engine's precision round once.

/// These functions convert IDs between the engine's signed integers and the core's unsigned ones.
/// All 64 bits are preserved.
constexpr std::int64_t script_id(std::uint64_t id) { return static_cast<std::int64_t>(id); }
constexpr std::uint64_t core_id(std::int64_t id) { return static_cast<std::uint64_t>(id); }

// These functions convert only the type. The numbers are unchanged except for rounding.
godot::Vector2 to_engine(glm::dvec2 vector);
godot::Vector3 to_engine(glm::vec3 vector);
godot::Vector3 to_engine(glm::dvec3 vector);
godot::Basis to_engine(const glm::mat3 &basis);
godot::Rect2 to_engine(const Rect &rect);
glm::dvec2 to_core(const godot::Vector2 &p_vector);
glm::dvec3 to_core(const godot::Vector3 &p_vector);
glm::dmat3 to_core(const godot::Basis &p_basis);
Rect to_core(const godot::Rect2 &p_rect);

/// Returns false if any component is NAN or infinite.
bool is_finite(const godot::Transform3D &p_transform);

// Conversions between engine space and world space.

glm::dvec3 to_world(const godot::Vector3 &p_position, const WorldFrame &frame);
/// With local coordinates, a rectangle is already in world space.
Rect to_world(const godot::Rect2 &p_rect, const WorldFrame &frame);
godot::Vector3 to_engine(glm::dvec3 position, const WorldFrame &frame);
godot::Transform3D to_engine(const glm::mat3 &basis, glm::dvec3 position, const WorldFrame &frame);

/// Copies a span into a packed array. `convert` converts each element. Throws std::bad_alloc.
template <class Packed, class Element, class Convert>
Packed packed(std::span<const Element> elements, Convert convert) {
	Packed result;
	std::ranges::transform(elements, resize(result, static_cast<std::int64_t>(elements.size())).begin(), convert);
	return result;
}

/// Returns a view of an array's bytes, valid until the array is modified or destroyed.
std::span<const std::uint8_t> span_of(const godot::PackedByteArray &p_bytes);

godot::PackedByteArray packed_bytes(std::span<const std::uint8_t> bytes);
godot::PackedInt32Array packed_integers(std::span<const std::int32_t> integers);
godot::PackedInt64Array packed_ids(std::span<const std::uint64_t> ids);
godot::PackedFloat32Array packed_floats(std::span<const float> numbers);
godot::PackedVector2Array packed_vectors(std::span<const glm::dvec2> vectors);

} // namespace thicket
