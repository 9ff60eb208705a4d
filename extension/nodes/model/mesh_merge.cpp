#include "nodes/model/mesh_merge.hpp"

#include "core/base/basis_scale.hpp"
#include "nodes/common/boxes.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/engine_arrays.hpp"
#include "nodes/common/stripped.hpp"
#include "nodes/common/surface_streams.hpp"

#include <godot_cpp/classes/array_mesh.hpp>
#include <godot_cpp/classes/placeholder_mesh.hpp>
#include <godot_cpp/classes/rendering_server.hpp>
#include <godot_cpp/core/memory.hpp>
#include <godot_cpp/core/object.hpp>
#include <godot_cpp/variant/array.hpp>
#include <godot_cpp/variant/dictionary.hpp>
#include <godot_cpp/variant/packed_color_array.hpp>
#include <godot_cpp/variant/packed_int32_array.hpp>
#include <godot_cpp/variant/typed_array.hpp>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

// These constants are bits of Mesh.ArrayFormat: all streams except bones and weights, and the
// formats of custom streams.
constexpr std::uint64_t streams_mask = (std::uint64_t{1} << SurfaceStream::bones) - 1;
constexpr std::uint64_t custom_mask = ((std::uint64_t{1} << 12U) - 1) << 13U;
constexpr std::uint64_t custom3_bit = std::uint64_t{1} << 9U;
constexpr std::uint64_t custom3_of_floats = std::uint64_t{7} << 22U; // Four floats per vertex.

/// An index buffer for the engine's automatic LOD selection.
struct IndexLod {
	double edge_length = 0.0; ///< The size in meters of the details that the LOD omits.
	PackedInt32Array indices;
};

/// The vertices and indices that one part adds to a surface.
struct Piece {
	int32_t vertex_count = 0;
	PackedInt32Array indices;
	std::vector<IndexLod> lods; ///< The index buffers of the LODs, finest first.
};

struct Surface {
	Ref<Material> material;
	int64_t primitive = 0;
	std::uint64_t format = 0;
	Array arrays;
	std::vector<Piece> pieces;

	bool can_append(const Surface &other) const {
		const bool in_strips =
				primitive == SurfacePrimitive::line_strip || primitive == SurfacePrimitive::triangle_strip;
		return material == other.material && primitive == other.primitive && format == other.format && !in_strips;
	}
};

template <class Packed>
void append(const Variant &p_addition, Variant &r_stream) {
	const Packed before = r_stream;
	const Packed addition = p_addition;
	Packed result = resized_copy(before, before.size() + addition.size());
	std::copy_n(addition.ptr(), addition.size(), writable(result).begin() + static_cast<std::ptrdiff_t>(before.size()));
	r_stream = result;
}

/// Copies a stream, so that writing to it does not change the original.
template <class Packed>
Packed copied_stream(const Array &p_arrays, int64_t stream) {
	const Packed shared = p_arrays[stream];
	return resized_copy(shared, shared.size());
}

/// Appends a vertex stream to one of the same type.
void append_stream(const Variant &p_addition, Variant &r_stream) {
	switch (r_stream.get_type()) {
		case Variant::PACKED_VECTOR3_ARRAY: append<PackedVector3Array>(p_addition, r_stream); break;
		case Variant::PACKED_VECTOR2_ARRAY: append<PackedVector2Array>(p_addition, r_stream); break;
		case Variant::PACKED_COLOR_ARRAY: append<PackedColorArray>(p_addition, r_stream); break;
		case Variant::PACKED_FLOAT32_ARRAY: append<PackedFloat32Array>(p_addition, r_stream); break;
		case Variant::PACKED_BYTE_ARRAY: append<PackedByteArray>(p_addition, r_stream); break;
		default: break;
	}
}

bool is_mirrored(const Transform3D &p_transform) { return glm::determinant(to_core(p_transform.basis)) < 0.0; }

/// Transforms the positions, normals and tangents of a surface.
void transform_streams(const Transform3D &p_transform, Array &r_arrays) {
	const glm::dmat3 basis = to_core(p_transform.basis);
	const glm::dmat3 normal_matrix = glm::transpose(glm::inverse(basis));
	const glm::dvec3 origin = to_core(p_transform.origin);
	auto positions = copied_stream<PackedVector3Array>(r_arrays, SurfaceStream::positions);
	for (Vector3 &position : writable(positions)) {
		position = to_engine(basis * to_core(position) + origin);
	}
	r_arrays[SurfaceStream::positions] = positions;
	auto normals = copied_stream<PackedVector3Array>(r_arrays, SurfaceStream::normals);
	for (Vector3 &normal : writable(normals)) {
		normal = to_engine(glm::normalize(normal_matrix * to_core(normal)));
	}
	if (normals.size() > 0) {
		r_arrays[SurfaceStream::normals] = normals;
	}
	auto tangents = copied_stream<PackedFloat32Array>(r_arrays, SurfaceStream::tangents);
	const std::span<float> tangent = writable(tangents);
	for (std::size_t index = 0; index + 3 < tangent.size(); index += 4) {
		const glm::dvec3 rotated =
				glm::normalize(basis * glm::dvec3{tangent[index], tangent[index + 1], tangent[index + 2]});
		for (int axis = 0; axis < 3; ++axis) {
			tangent[index + static_cast<std::size_t>(axis)] = static_cast<float>(rotated[axis]);
		}
		tangent[index + 3] = is_mirrored(p_transform) ? -tangent[index + 3] : tangent[index + 3];
	}
	if (tangents.size() > 0) {
		r_arrays[SurfaceStream::tangents] = tangents;
	}
}

/// Reverses the winding of triangles. Otherwise mirrored triangles would show their backs.
PackedInt32Array with_reversed_winding(const PackedInt32Array &p_indices, int64_t p_primitive) {
	if (p_indices.size() < 3) {
		return p_indices;
	}
	// An extra index at the front reverses the winding of all triangles.
	if (p_primitive == SurfacePrimitive::triangle_strip) {
		PackedInt32Array result = resized_copy(p_indices, p_indices.size() + 1);
		const std::span<int32_t> index = writable(result);
		std::copy_n(p_indices.ptr(), p_indices.size(), index.begin() + 1);
		return result;
	}
	PackedInt32Array result = resized_copy(p_indices, p_indices.size());
	const std::span<int32_t> index = writable(result);
	for (std::size_t first = 0; p_primitive == SurfacePrimitive::triangles && first + 2 < index.size(); first += 3) {
		std::swap(index[first + 1], index[first + 2]);
	}
	return result;
}

PackedInt32Array indices_of(const Array &p_arrays, int32_t vertex_count) {
	PackedInt32Array indices = p_arrays[SurfaceStream::indices];
	if (indices.size() == 0) {
		const std::span<int32_t> index_span = resize(indices, vertex_count);
		std::iota(index_span.begin(), index_span.end(), 0);
	}
	return indices;
}

/// Converts an index buffer. The engine stores each index in two bytes if these suffice for the
/// vertex count.
PackedInt32Array unpacked_indices(const PackedByteArray &p_bytes, int64_t vertex_count) {
	constexpr int64_t max_two_byte_index = 65536;
	PackedInt32Array result;
	if (vertex_count > max_two_byte_index) {
		const std::span<int32_t> output = resize(result, p_bytes.size() / 4);
		std::memcpy(output.data(), p_bytes.ptr(), output.size_bytes());
		return result;
	}
	const std::uint8_t *input = p_bytes.ptr();
	for (int32_t &output : resize(result, p_bytes.size() / 2)) {
		std::uint16_t index = 0;
		std::memcpy(&index, input, sizeof(index));
		output = index;
		input += sizeof(index);
	}
	return result;
}

/// Applies weighted blend shapes to the streams of a surface.
class Blend {
public:
	/// The blend has no effect if the mesh is not an ArrayMesh, because only these have blend
	/// shapes.
	Blend(const MeshPart &part, int32_t index) : weights_(part.blend_weights) {
		const Ref<ArrayMesh> mesh = weights_.empty() ? Ref<Mesh>() : part.mesh;
		if (mesh.is_null()) {
			weights_.clear();
			return;
		}
		shapes_ = mesh->surface_get_blend_shape_arrays(index);
		weights_.resize(std::min(weights_.size(), static_cast<std::size_t>(shapes_.size())));
		const bool is_relative = static_cast<int64_t>(mesh->call("get_blend_shape_mode")) == relative_mode;
		for (const double weight : weights_) {
			// Shapes that are not relative contain absolute positions instead of offsets.
			base_weight_ -= is_relative ? 0.0 : weight;
		}
	}

	void apply(int64_t stream, Array &r_arrays) const {
		auto values = copied_stream<PackedVector3Array>(r_arrays, stream);
		if (weights_.empty() || values.size() == 0) {
			return;
		}
		const std::span<Vector3> value = writable(values);
		std::ranges::for_each(
				value, [this](Vector3 &position) { position = to_engine(base_weight_ * to_core(position)); });
		for (std::size_t shape = 0; shape < weights_.size(); ++shape) {
			const Array arrays = shapes_[static_cast<int64_t>(shape)];
			const PackedVector3Array offsets = arrays[stream];
			for (std::size_t index = 0; index < std::min(static_cast<std::size_t>(offsets.size()), value.size());
					++index) {
				value[index] = to_engine(to_core(value[index]) + weights_[shape] * to_core(offsets.ptr()[index]));
			}
		}
		r_arrays[stream] = values;
	}

	bool has_effect() const { return !weights_.empty(); }

private:
	static constexpr int64_t relative_mode = 1; ///< Mesh.BLEND_SHAPE_MODE_RELATIVE.

	std::vector<double> weights_;
	TypedArray<Array> shapes_;
	double base_weight_ = 1.0; ///< The weight of the unblended surface.
};

/// Restores the unit length of normals.
void normalize_streams(Array &r_arrays) {
	auto normals = copied_stream<PackedVector3Array>(r_arrays, SurfaceStream::normals);
	for (Vector3 &normal : writable(normals)) {
		normal = to_engine(glm::normalize(to_core(normal)));
	}
	if (normals.size() > 0) {
		r_arrays[SurfaceStream::normals] = normals;
	}
}

void blend(const MeshPart &part, int32_t index, Array &r_arrays) {
	const Blend shapes(part, index);
	if (shapes.has_effect()) {
		shapes.apply(SurfaceStream::positions, r_arrays);
		shapes.apply(SurfaceStream::normals, r_arrays);
		normalize_streams(r_arrays);
	}
}

/// Reads one surface of a part and transforms it to the model's space.
Surface surface_of(const MeshPart &part, int32_t index) {
	Surface result;
	const Dictionary data = RenderingServer::get_singleton()->mesh_get_surface(part.mesh->get_rid(), index);
	result.primitive = data["primitive"];
	result.format = static_cast<std::uint64_t>(static_cast<int64_t>(data["format"])) & (streams_mask | custom_mask);
	const auto surface_index = static_cast<std::size_t>(index);
	if (surface_index < part.materials.size() && part.materials[surface_index].is_valid()) {
		result.material = part.materials[surface_index];
	} else {
		result.material = part.mesh->surface_get_material(index);
	}
	result.arrays = part.mesh->surface_get_arrays(index);
	if (result.arrays.is_empty()) {
		return result;
	}
	result.arrays[SurfaceStream::bones] = Variant();
	result.arrays[SurfaceStream::weights] = Variant();
	blend(part, index, result.arrays);
	if (part.transform != Transform3D()) {
		transform_streams(part.transform, result.arrays);
	}
	Piece piece;
	piece.vertex_count =
			static_cast<int32_t>(static_cast<PackedVector3Array>(result.arrays[SurfaceStream::positions]).size());
	piece.indices = indices_of(result.arrays, piece.vertex_count);
	// The key is missing if the surface has no LODs.
	const Array lods = data.get("lods", Array());
	for (int64_t lod = 0; lod < lods.size(); ++lod) {
		const Dictionary lod_data = lods[lod];
		piece.lods.push_back(
				{static_cast<double>(lod_data["edge_length"]) * largest_scale(to_core(part.transform.basis)),
						unpacked_indices(lod_data["index_data"], piece.vertex_count)});
	}
	std::ranges::stable_sort(piece.lods, {}, &IndexLod::edge_length);
	if (is_mirrored(part.transform)) {
		piece.indices = with_reversed_winding(piece.indices, result.primitive);
		for (IndexLod &lod : piece.lods) {
			lod.indices = with_reversed_winding(lod.indices, result.primitive);
		}
	}
	result.pieces.push_back(std::move(piece));
	return result;
}

/// Appends a surface to one with the same material and format, or adds it to the list.
void add(Surface surface, std::vector<Surface> &r_surfaces) {
	if (surface.pieces.empty() || surface.pieces.front().vertex_count == 0) {
		return;
	}
	const auto match =
			std::ranges::find_if(r_surfaces, [&](const Surface &other) { return other.can_append(surface); });
	if (match == r_surfaces.end()) {
		r_surfaces.push_back(std::move(surface));
		return;
	}
	for (int64_t stream = 0; stream < SurfaceStream::bones; ++stream) {
		append_stream(surface.arrays[stream], match->arrays[stream]);
	}
	match->pieces.push_back(std::move(surface.pieces.front()));
}

/// Joins the indices of all pieces. Uses the coarsest LOD of each piece that omits only details of
/// at most `edge_length` meters.
PackedInt32Array joined_indices(const Surface &surface, double edge_length) {
	std::vector<int32_t> result;
	int32_t first = 0;
	for (const Piece &piece : surface.pieces) {
		const PackedInt32Array *indices = &piece.indices;
		for (const IndexLod &lod : piece.lods) {
			indices = lod.edge_length <= edge_length ? &lod.indices : indices;
		}
		for (const int32_t index : *indices) {
			result.push_back(index + first);
		}
		first += piece.vertex_count;
	}
	return packed_integers(result);
}

/// Adds a surface with all its LODs to a mesh.
void add_to_mesh(Surface &r_surface, ArrayMesh &r_mesh) {
	std::set<double> edge_lengths;
	for (const Piece &piece : r_surface.pieces) {
		for (const IndexLod &lod : piece.lods) {
			edge_lengths.insert(lod.edge_length);
		}
	}
	Dictionary lods;
	for (const double edge_length : edge_lengths) {
		lods[edge_length] = joined_indices(r_surface, edge_length);
	}
	r_surface.arrays[SurfaceStream::indices] = joined_indices(r_surface, -1.0);
	r_mesh.call("add_surface_from_arrays", r_surface.primitive, r_surface.arrays, TypedArray<Array>(), lods,
			static_cast<int64_t>(r_surface.format & custom_mask));
	r_mesh.surface_set_material(r_mesh.get_surface_count() - 1, r_surface.material);
}

bool is_unmodified(const MeshPart &part) {
	return part.transform == Transform3D() && part.overlay.is_null() && part.blend_weights.empty() &&
			std::ranges::all_of(part.materials, [](const Ref<Material> &material) { return material.is_null(); });
}

/// Returns a placeholder with the bounding box of all stripped meshes; null if there are none.
Ref<Mesh> merged_placeholder(std::span<const MeshPart> parts) {
	std::optional<AABB> box;
	for (const MeshPart &part : parts) {
		if (is_stripped(part.mesh)) {
			const AABB part_box = transformed(part.mesh->get_aabb(), part.transform);
			box = box ? joined(*box, part_box) : part_box;
		}
	}
	if (!box) {
		return {};
	}
	Ref<PlaceholderMesh> mesh(memnew(PlaceholderMesh));
	mesh->set_aabb(*box);
	return mesh;
}

} // namespace

Ref<Mesh> merged_mesh(std::span<const MeshPart> parts) {
	if (parts.size() == 1 && is_unmodified(parts.front()) && parts.front().mesh->get_surface_count() > 0) {
		// Return the mesh itself; a copy would look identical.
		return parts.front().mesh;
	}
	std::vector<Surface> surfaces;
	for (const MeshPart &part : parts) {
		for (int32_t index = 0; index < part.mesh->get_surface_count(); ++index) {
			add(surface_of(part, index), surfaces);
			if (part.overlay.is_valid()) {
				Surface overlay_surface = surface_of(part, index);
				overlay_surface.material = part.overlay;
				add(std::move(overlay_surface), surfaces);
			}
		}
	}
	if (surfaces.empty()) {
		return merged_placeholder(parts);
	}
	Ref<ArrayMesh> mesh(memnew(ArrayMesh));
	for (Surface &surface : surfaces) {
		add_to_mesh(surface, *mesh.ptr());
	}
	return mesh;
}

std::vector<Ref<Mesh>> faded_meshes(const Ref<Mesh> &mesh, std::span<const glm::vec4> values) {
	std::vector<Surface> surfaces;
	for (int32_t index = 0; index < mesh->get_surface_count(); ++index) {
		Surface surface = surface_of({mesh, Transform3D(), {}, {}, {}}, index);
		if (!surface.pieces.empty() && surface.pieces.front().vertex_count > 0) {
			surface.format |= custom3_of_floats;
			surfaces.push_back(std::move(surface));
		}
	}
	std::vector<Ref<Mesh>> result;
	for (const glm::vec4 &value : values) {
		Ref<ArrayMesh> copy(memnew(ArrayMesh));
		for (Surface &surface : surfaces) {
			PackedFloat32Array stream;
			const std::span<float> floats = resize(stream, int64_t{4} * surface.pieces.front().vertex_count);
			for (std::size_t index = 0; index < floats.size(); ++index) {
				floats[index] = value[static_cast<glm::length_t>(index % 4)];
			}
			surface.arrays[SurfaceStream::custom3] = stream;
			add_to_mesh(surface, *copy.ptr());
		}
		result.push_back(surfaces.empty() ? Ref<Mesh>() : Ref<Mesh>(copy));
	}
	return result;
}

bool uses_custom3(const Ref<Mesh> &mesh) {
	Ref<ArrayMesh> arrays = mesh; // Other types of meshes have no custom streams.
	for (int32_t index = 0; arrays.is_valid() && index < arrays->get_surface_count(); ++index) {
		const auto format = static_cast<int64_t>(arrays->call("surface_get_format", index));
		if ((static_cast<std::uint64_t>(format) & custom3_bit) != 0) {
			return true;
		}
	}
	return false;
}

} // namespace thicket
