#include "nodes/impostor/surface_arrays.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/common/surface_streams.hpp"

#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/core/object.hpp>
#include <godot_cpp/variant/packed_byte_array.hpp>
#include <godot_cpp/variant/packed_color_array.hpp>
#include <godot_cpp/variant/packed_int32_array.hpp>
#include <godot_cpp/variant/packed_vector2_array.hpp>
#include <godot_cpp/variant/packed_vector3_array.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <numeric>
#include <span>

using namespace godot;

namespace thicket {

namespace {

/// Converts one of the arrays, if it exists. Returns an error if it has the wrong type.
template <class Packed, class Element, class Convert>
Status read(const Array &p_arrays, int64_t p_stream, Variant::Type p_type, std::vector<Element> &r_list,
		Convert p_convert) {
	const Variant value = p_stream < p_arrays.size() ? p_arrays[p_stream] : Variant();
	if (value.get_type() == Variant::NIL) {
		return {};
	}
	if (value.get_type() != p_type) {
		return {ErrorCode::wrong_size, "arrays", static_cast<double>(p_stream), {}, {},
				"Use arrays as Mesh.surface_get_arrays returns them"};
	}
	const Packed packed = value;
	r_list.reserve(static_cast<std::size_t>(packed.size()));
	for (const auto &element : std::span(packed.ptr(), static_cast<std::size_t>(packed.size()))) {
		r_list.push_back(p_convert(element));
	}
	return {};
}

glm::vec3 vector_of(const Vector3 &p_vector) {
	return {static_cast<float>(p_vector.x), static_cast<float>(p_vector.y), static_cast<float>(p_vector.z)};
}

} // namespace

Status read_arrays(const Array &p_arrays, ImpostorSurface &r_surface) {
	const auto uv_of = [](const Vector2 &p_uv) {
		return glm::vec2(static_cast<float>(p_uv.x), static_cast<float>(p_uv.y));
	};
	const auto color_of = [](const Color &p_color) {
		return glm::vec4(p_color.r, p_color.g, p_color.b, p_color.a);
	};
	const auto index_of = [](int32_t p_index) {
		return static_cast<std::uint32_t>(p_index);
	};
	for (const Status &status : {
				 read<PackedVector3Array>(p_arrays, SurfaceStream::positions, Variant::PACKED_VECTOR3_ARRAY,
						 r_surface.positions, vector_of),
				 read<PackedVector3Array>(
						 p_arrays, SurfaceStream::normals, Variant::PACKED_VECTOR3_ARRAY, r_surface.normals, vector_of),
				 read<PackedColorArray>(
						 p_arrays, SurfaceStream::colors, Variant::PACKED_COLOR_ARRAY, r_surface.colors, color_of),
				 read<PackedVector2Array>(
						 p_arrays, SurfaceStream::uvs, Variant::PACKED_VECTOR2_ARRAY, r_surface.uvs, uv_of),
				 read<PackedInt32Array>(
						 p_arrays, SurfaceStream::indices, Variant::PACKED_INT32_ARRAY, r_surface.indices, index_of),
		 }) {
		if (!status.ok()) {
			return status;
		}
	}
	if (r_surface.indices.empty()) {
		r_surface.indices.resize(r_surface.positions.size());
		std::iota(r_surface.indices.begin(), r_surface.indices.end(), 0U);
	}
	return {};
}

Status read_texture(const Ref<Image> &p_image, SurfaceTexture &r_texture) {
	const Ref<Image> copy = p_image->duplicate();
	if (copy->is_compressed() && copy->decompress() != OK) {
		return {ErrorCode::out_of_range, "texture", static_cast<double>(p_image->get_format()), {}, {},
				"Use an image format that the engine can decompress"};
	}
	copy->clear_mipmaps();
	copy->convert(Image::FORMAT_RGBA8);
	const PackedByteArray bytes = copy->get_data();
	return r_texture.set(copy->get_width(), copy->get_height(), span_of(bytes));
}

} // namespace thicket
