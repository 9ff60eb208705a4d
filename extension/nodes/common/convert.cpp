#include "nodes/common/convert.hpp"

#include "nodes/common/engine_arrays.hpp"

#include <algorithm>

using namespace godot;

namespace thicket {

namespace {

template <class Packed, class Element>
Packed copied(std::span<const Element> elements) {
	Packed result;
	std::ranges::copy(elements, resize(result, static_cast<int64_t>(elements.size())).begin());
	return result;
}

} // namespace

Vector2 to_engine(glm::dvec2 vector) { return {static_cast<real_t>(vector.x), static_cast<real_t>(vector.y)}; }

Vector3 to_engine(glm::vec3 vector) { return {vector.x, vector.y, vector.z}; }

Vector3 to_engine(glm::dvec3 vector) {
	return {static_cast<real_t>(vector.x), static_cast<real_t>(vector.y), static_cast<real_t>(vector.z)};
}

Basis to_engine(const glm::mat3 &basis) { return {to_engine(basis[0]), to_engine(basis[1]), to_engine(basis[2])}; }

Rect2 to_engine(const Rect &rect) { return {to_engine(rect.min), to_engine(rect.size())}; }

glm::dvec2 to_core(const Vector2 &p_vector) { return {p_vector.x, p_vector.y}; }

glm::dvec3 to_core(const Vector3 &p_vector) { return {p_vector.x, p_vector.y, p_vector.z}; }

glm::dmat3 to_core(const Basis &p_basis) {
	glm::dmat3 result;
	for (int row = 0; row < 3; ++row) {
		const glm::dvec3 axis = to_core(p_basis.rows[row]);
		for (int column = 0; column < 3; ++column) {
			result[column][row] = axis[column];
		}
	}
	return result;
}

Rect to_core(const Rect2 &p_rect) {
	const glm::dvec2 corner = to_core(p_rect.position);
	return {corner, corner + to_core(p_rect.size)};
}

glm::dvec3 to_world(const Vector3 &p_position, glm::dvec3 offset) { return to_core(p_position) + offset; }

Rect to_world(const Rect2 &p_rect, glm::dvec3 offset) {
	const glm::dvec2 corner = to_core(p_rect.position) + glm::dvec2(offset.x, offset.z);
	return {corner, corner + to_core(p_rect.size)};
}

Vector3 to_engine(glm::dvec3 position, glm::dvec3 offset) { return to_engine(position - offset); }

Transform3D to_engine(const glm::mat3 &basis, glm::dvec3 position, glm::dvec3 offset) {
	return {to_engine(basis), to_engine(position, offset)};
}

std::span<const std::uint8_t> span_of(const PackedByteArray &p_bytes) {
	return {p_bytes.ptr(), static_cast<std::size_t>(p_bytes.size())};
}

PackedByteArray packed_bytes(std::span<const std::uint8_t> bytes) { return copied<PackedByteArray>(bytes); }

PackedInt32Array packed_integers(std::span<const std::int32_t> integers) { return copied<PackedInt32Array>(integers); }

PackedInt64Array packed_ids(std::span<const std::uint64_t> ids) { return packed<PackedInt64Array>(ids, script_id); }

PackedFloat32Array packed_floats(std::span<const float> numbers) { return copied<PackedFloat32Array>(numbers); }

PackedVector2Array packed_vectors(std::span<const glm::dvec2> vectors) {
	return packed<PackedVector2Array>(vectors, [](glm::dvec2 vector) { return to_engine(vector); });
}

} // namespace thicket
