#include "nodes/common/convert.hpp"

#include "nodes/common/engine_arrays.hpp"

#include <algorithm>

using namespace godot;

namespace thicket {

namespace {

template <class Packed, class Element>
Packed packed_copy(std::span<const Element> elements) {
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

bool is_finite(const Transform3D &p_transform) {
	const glm::dmat3 basis = to_core(p_transform.basis);
	// Zero, or NAN if any number is not finite.
	const glm::dvec3 sum = (basis[0] + basis[1] + basis[2] + to_core(p_transform.origin)) * 0.0;
	return sum == glm::dvec3(0.0);
}

glm::dvec3 to_world(const Vector3 &p_position, const WorldFrame &frame) { return frame.to_world(to_core(p_position)); }

Rect to_world(const Rect2 &p_rect, const WorldFrame &frame) {
	const glm::dvec2 offset = frame.local ? glm::dvec2(0.0) : glm::dvec2(frame.offset.x, frame.offset.z);
	const glm::dvec2 corner = to_core(p_rect.position) + offset;
	return {corner, corner + to_core(p_rect.size)};
}

Vector3 to_engine(glm::dvec3 position, const WorldFrame &frame) { return to_engine(frame.to_engine(position)); }

Transform3D to_engine(const glm::mat3 &basis, glm::dvec3 position, const WorldFrame &frame) {
	return {to_engine(frame.rotated_back(basis)), to_engine(position, frame)};
}

std::span<const std::uint8_t> span_of(const PackedByteArray &p_bytes) {
	return {p_bytes.ptr(), static_cast<std::size_t>(p_bytes.size())};
}

PackedByteArray packed_bytes(std::span<const std::uint8_t> bytes) { return packed_copy<PackedByteArray>(bytes); }

PackedInt32Array packed_integers(std::span<const std::int32_t> integers) {
	return packed_copy<PackedInt32Array>(integers);
}

PackedInt64Array packed_ids(std::span<const std::uint64_t> ids) { return packed<PackedInt64Array>(ids, script_id); }

PackedFloat32Array packed_floats(std::span<const float> numbers) { return packed_copy<PackedFloat32Array>(numbers); }

PackedVector2Array packed_vectors(std::span<const glm::dvec2> vectors) {
	return packed<PackedVector2Array>(vectors, [](glm::dvec2 vector) { return to_engine(vector); });
}

} // namespace thicket
