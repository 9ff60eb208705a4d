#include "nodes/gameplay/instance_answers.hpp"

#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/variant/packed_vector3_array.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <algorithm>
#include <array>
#include <memory>
#include <string>

using namespace godot;

namespace thicket {

namespace {

/// A script's condition. Through Variant, which says whether it could be called; Callable keeps that to itself.
class Predicate {
public:
	Predicate(const char *p_method, const Callable &p_callable, glm::dvec3 offset) :
			method_(p_method), callable_(p_callable), offset_(offset) {}

	bool operator()(const PlacedInstance &instance) {
		if (failed_) {
			return false;
		}
		const Variant id(script_id(instance.id));
		const Variant layer(static_cast<int64_t>(instance.layer));
		const Variant transform(to_engine(instance, offset_));
		std::array<const Variant *, 3> arguments{&id, &layer, &transform};
		Variant result;
		GDExtensionCallError error{};
		callable_.callp("call", arguments.data(), static_cast<int>(arguments.size()), result, error);
		failed_ = error.error != GDEXTENSION_CALL_OK || result.get_type() != Variant::BOOL;
		if (failed_) {
			const std::string problem = std::string("TerrainScatter3D.") + method_ +
					": predicate must take (id: int, layer: int, transform: Transform3D) and return a bool";
			ERR_PRINT(String(problem.c_str()));
		}
		return !failed_ && static_cast<bool>(result);
	}

private:
	const char *method_;
	Variant callable_;
	glm::dvec3 offset_;
	bool failed_ = false;
};

} // namespace

Transform3D to_engine(const PlacedInstance &instance, glm::dvec3 offset) {
	return to_engine(instance.basis, instance.position, offset);
}

AddedInstance to_added(const Transform3D &p_transform, glm::dvec3 offset) {
	AddedInstance added;
	added.position = to_world(p_transform.origin, offset);
	for (int row = 0; row < 3; ++row) {
		const Vector3 &axis = p_transform.basis.rows[row];
		added.basis[0][row] = static_cast<float>(axis.x);
		added.basis[1][row] = static_cast<float>(axis.y);
		added.basis[2][row] = static_cast<float>(axis.z);
	}
	return added;
}

PlacedInstance to_placed(const AddedInstance &added, std::uint64_t id, std::uint32_t place) {
	return {id, place, added.mesh, added.position, added.basis};
}

QueryFilter to_filter(
		const char *p_method, const PackedInt32Array &p_layers, const Callable &p_predicate, glm::dvec3 offset) {
	QueryFilter filter;
	for (int64_t i = 0; i < p_layers.size(); ++i) {
		filter.layers.push_back(
				static_cast<std::uint32_t>(p_layers[i])); // A negative one is refused like any too large.
	}
	if (!p_predicate.is_null()) {
		const auto predicate = std::make_shared<Predicate>(p_method, p_predicate, offset);
		filter.accepts = [predicate](const PlacedInstance &instance) {
			return (*predicate)(instance);
		};
	}
	return filter;
}

Dictionary to_arrays(std::span<const PlacedInstance> found, glm::dvec3 offset) {
	const auto count = static_cast<int64_t>(found.size());
	PackedInt64Array ids;
	PackedInt32Array layers;
	PackedInt32Array meshes;
	PackedVector3Array positions;
	PackedFloat32Array transforms;
	ids.resize(count);
	layers.resize(count);
	meshes.resize(count);
	positions.resize(count);
	transforms.resize(count * static_cast<int64_t>(transform_floats));
	// Asked for once: each time is a call into the engine.
	int64_t *next_id = ids.ptrw();
	int32_t *next_layer = layers.ptrw();
	int32_t *next_mesh = meshes.ptrw();
	Vector3 *next_position = positions.ptrw();
	float *floats = transforms.ptrw();
	for (const PlacedInstance &instance : found) {
		*next_id++ = script_id(instance.id);
		*next_layer++ = static_cast<int32_t>(instance.layer);
		*next_mesh++ = static_cast<int32_t>(instance.mesh);
		*next_position++ = to_engine(instance.position, offset);
		const glm::vec3 position(instance.position - offset);
		for (int row = 0; row < 3; ++row) {
			for (int column = 0; column < 3; ++column) {
				*floats++ = instance.basis[column][row];
			}
			*floats++ = position[row];
		}
	}
	Dictionary result;
	result["ids"] = ids;
	result["layers"] = layers;
	result["meshes"] = meshes;
	result["positions"] = positions;
	result["transforms"] = transforms;
	return result;
}

Dictionary to_dictionary(const PlacedInstance &instance, glm::dvec3 offset) {
	Dictionary result;
	result["id"] = script_id(instance.id);
	result["layer"] = static_cast<int64_t>(instance.layer);
	result["mesh"] = static_cast<int64_t>(instance.mesh);
	result["transform"] = to_engine(instance, offset);
	return result;
}

} // namespace thicket
