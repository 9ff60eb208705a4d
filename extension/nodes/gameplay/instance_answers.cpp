#include "nodes/gameplay/instance_answers.hpp"

#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <algorithm>
#include <array>
#include <memory>
#include <string>

using namespace godot;

namespace thicket {

namespace {

Vector3 to_vector(glm::vec3 vector) { return Vector3(vector.x, vector.y, vector.z); }

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

PackedInt64Array packed_ids(std::span<const std::uint64_t> ids) {
	PackedInt64Array result;
	result.resize(static_cast<int64_t>(ids.size()));
	std::transform(ids.begin(), ids.end(), result.ptrw(), script_id);
	return result;
}

PackedFloat32Array packed_floats(std::span<const float> numbers) {
	PackedFloat32Array result;
	result.resize(static_cast<int64_t>(numbers.size()));
	std::copy(numbers.begin(), numbers.end(), result.ptrw());
	return result;
}

Rect to_world(const Rect2 &p_rect, glm::dvec3 offset) {
	const glm::dvec2 corner{p_rect.position.x + offset.x, p_rect.position.y + offset.z};
	return {corner, corner + glm::dvec2{p_rect.size.x, p_rect.size.y}};
}

glm::dvec3 to_world(const Vector3 &p_position, glm::dvec3 offset) {
	return glm::dvec3(p_position.x, p_position.y, p_position.z) + offset;
}

Vector3 to_engine(glm::dvec3 position, glm::dvec3 offset) {
	const glm::dvec3 from = position - offset;
	return Vector3(static_cast<real_t>(from.x), static_cast<real_t>(from.y), static_cast<real_t>(from.z));
}

Transform3D to_engine(const PlacedInstance &instance, glm::dvec3 offset) {
	const glm::mat3 &basis = instance.basis;
	return Transform3D(
			Basis(to_vector(basis[0]), to_vector(basis[1]), to_vector(basis[2])), to_engine(instance.position, offset));
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

PlacedInstance to_placed(const AddedInstance &added, std::uint64_t id, std::uint32_t layer) {
	return {id, layer, added.mesh, added.position, added.basis};
}

std::function<bool(const PlacedInstance &)> to_predicate(
		const char *p_method, const Callable &p_predicate, glm::dvec3 offset) {
	if (p_predicate.is_null()) {
		return {};
	}
	const auto predicate = std::make_shared<Predicate>(p_method, p_predicate, offset);
	return [predicate](const PlacedInstance &instance) {
		return (*predicate)(instance);
	};
}

} // namespace thicket
