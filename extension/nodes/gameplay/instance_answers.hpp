#pragma once

#include "core/query/instance_query.hpp"
#include "nodes/common/convert.hpp"

#include <godot_cpp/variant/callable.hpp>
#include <godot_cpp/variant/dictionary.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/packed_int32_array.hpp>
#include <godot_cpp/variant/packed_int64_array.hpp>
#include <godot_cpp/variant/rect2.hpp>
#include <godot_cpp/variant/transform3d.hpp>
#include <godot_cpp/variant/vector3.hpp>

#include <glm/vec3.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// Between the world's space and the engine's, as in convert.hpp.
godot::Transform3D to_engine(const PlacedInstance &instance, glm::dvec3 offset);
AddedInstance to_added(const godot::Transform3D &p_transform, glm::dvec3 offset);
PlacedInstance to_placed(const AddedInstance &added, std::uint64_t id, std::uint32_t place);

/// Layers by place, and a predicate of a script: (id: int, layer: int, transform: Transform3D) -> bool. A predicate that cannot be
/// called lets nothing pass and prints one error.
QueryFilter to_filter(const char *p_method, const godot::PackedInt32Array &p_layers, const godot::Callable &p_predicate,
		glm::dvec3 offset);

/// ids, layers, meshes, positions and transforms (12 floats a piece, as in the buffer of a MultiMesh), packed.
godot::Dictionary to_arrays(std::span<const PlacedInstance> found, glm::dvec3 offset);

/// id, layer, mesh and transform.
godot::Dictionary to_dictionary(const PlacedInstance &instance, glm::dvec3 offset);

} // namespace thicket
