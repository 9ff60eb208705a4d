#include "nodes/ground/mesh_copy.hpp"

#include "nodes/common/convert.hpp"
#include "nodes/common/engine_arrays.hpp"
#include "nodes/common/surface_streams.hpp"

#include <godot_cpp/classes/rendering_server.hpp>
#include <godot_cpp/variant/aabb.hpp>
#include <godot_cpp/variant/array.hpp>
#include <godot_cpp/variant/dictionary.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/packed_int32_array.hpp>
#include <godot_cpp/variant/packed_vector3_array.hpp>

#include <glm/matrix.hpp>

#include <cstddef>
#include <cstring>
#include <span>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

MeshSurface::Shape shape_of(std::int64_t primitive) {
	switch (primitive) {
		case SurfacePrimitive::triangles: return MeshSurface::Shape::triangles;
		case SurfacePrimitive::triangle_strip: return MeshSurface::Shape::strip;
		default: return MeshSurface::Shape::none;
	}
}

glm::vec3 floats_of(const Vector3 &p_vector) { return {to_core(p_vector)}; }

template <typename Number, class Packed>
PackedByteArray packed_as(const Packed &p_numbers) {
	PackedByteArray bytes;
	std::uint8_t *out = resize(bytes, p_numbers.size() * static_cast<std::int64_t>(sizeof(Number))).data();
	for (const auto &element : std::span(p_numbers.ptr(), static_cast<std::size_t>(p_numbers.size()))) {
		Number converted{};
		if constexpr (std::is_same_v<Number, glm::vec3>) {
			converted = floats_of(element);
		} else {
			converted = static_cast<Number>(element);
		}
		std::memcpy(out, &converted, sizeof(converted));
		out += sizeof(converted);
	}
	return bytes;
}

/// Appends triangles, transformed by `frame`. Triangles of a mirrored copy keep their front side.
void append_transformed(
		std::span<const glm::vec3> corners, const Transform3D &frame, std::vector<glm::vec3> &r_corners) {
	const glm::dmat3 basis = to_core(frame.basis);
	const glm::dvec3 origin = to_core(frame.origin);
	const bool is_mirrored = glm::determinant(basis) < 0.0;
	const std::size_t first = r_corners.size();
	for (const glm::vec3 &corner : corners) {
		r_corners.emplace_back(origin + basis * glm::dvec3(corner));
	}
	for (std::size_t triangle = first; is_mirrored && triangle + 2 < r_corners.size(); triangle += 3) {
		std::swap(r_corners[triangle + 1], r_corners[triangle + 2]);
	}
}

/// Returns true if the renderer stores the mesh. The surfaces of other meshes come from scripts.
bool is_stored(const Mesh &p_mesh) {
	return p_mesh.is_class("ArrayMesh") || p_mesh.is_class("PrimitiveMesh") || p_mesh.is_class("ImmediateMesh");
}

} // namespace

Status MeshCopy::append_faces(std::vector<glm::vec3> &r_corners) const {
	for (const Piece &piece : pieces_) {
		const auto first = static_cast<std::ptrdiff_t>(r_corners.size());
		for (const Surface &surface : piece.surfaces) {
			MeshSurface layout = surface.layout;
			layout.vertices = span_of(surface.vertices);
			layout.indices = span_of(surface.indices);
			if (const Status status = thicket::append_faces(layout, r_corners); !status.ok()) {
				return status;
			}
		}
		if (!piece.frames.empty()) {
			const std::vector<glm::vec3> corners(r_corners.begin() + first, r_corners.end());
			r_corners.resize(static_cast<std::size_t>(first));
			for (const Transform3D &frame : piece.frames) {
				append_transformed(corners, frame, r_corners);
			}
		}
	}
	return {};
}

void MeshReader::start(std::vector<GroundPiece> pieces, std::uint64_t source, std::uint64_t version) {
	cancel();
	pieces_ = std::move(pieces);
	source_ = source;
	version_ = version;
	copy_ = std::make_shared<MeshCopy>();
}

void MeshReader::cancel() {
	pieces_.clear();
	copy_ = nullptr;
	piece_index_ = 0;
	next_surface_ = 0;
}

/// Copies a surface in the renderer's format.
MeshCopy::Surface MeshReader::read_stored(const Mesh &p_mesh, std::int32_t surface) {
	const Dictionary data = RenderingServer::get_singleton()->mesh_get_surface(p_mesh.get_rid(), surface);
	MeshCopy::Surface result;
	const auto format = static_cast<std::uint64_t>(static_cast<std::int64_t>(data["format"]));
	result.layout.shape = shape_of(data["primitive"]);
	if ((format & SurfaceFormat::no_vertices) != 0) {
		result.layout.shape = MeshSurface::Shape::none;
	} else if ((format & SurfaceFormat::flat) != 0) {
		result.layout.positions = MeshSurface::Positions::flat;
	} else if ((format & SurfaceFormat::quantized) != 0) {
		result.layout.positions = MeshSurface::Positions::quantized;
	}
	result.layout.vertex_count = static_cast<std::size_t>(static_cast<std::int64_t>(data["vertex_count"]));
	result.layout.index_count =
			static_cast<std::size_t>(static_cast<std::int64_t>(data.get("index_count", std::int64_t{0})));
	const AABB box = data["aabb"];
	result.layout.box_corner = floats_of(box.position);
	result.layout.box_size = floats_of(box.size);
	result.vertices = data["vertex_data"];
	result.indices = data.get("index_data", PackedByteArray());
	return result;
}

/// Copies a surface that a mesh's script returns.
MeshCopy::Surface MeshReader::read_scripted(Mesh &r_mesh, std::int32_t surface) {
	const StringName primitive("_surface_get_primitive_type");
	MeshCopy::Surface result;
	result.layout.shape =
			r_mesh.has_method(primitive) ? shape_of(r_mesh.call(primitive, surface)) : MeshSurface::Shape::triangles;
	const Array arrays = r_mesh.surface_get_arrays(surface);
	const auto stream = [&arrays](std::int64_t index) {
		return index < arrays.size() ? arrays[index] : Variant();
	};
	const PackedVector3Array positions = stream(SurfaceStream::positions);
	const PackedInt32Array indices = stream(SurfaceStream::indices);
	result.layout.vertex_count = static_cast<std::size_t>(positions.size());
	result.layout.index_count = static_cast<std::size_t>(indices.size());
	result.vertices = packed_as<glm::vec3>(positions);
	result.indices = packed_as<std::uint32_t>(indices);
	return result;
}

MeshCopy::Surface MeshReader::read_corners(std::span<const glm::vec3> corners) {
	MeshCopy::Surface result;
	result.layout.shape = MeshSurface::Shape::triangles;
	result.layout.vertex_count = corners.size();
	const auto bytes = resize(result.vertices, static_cast<std::int64_t>(corners.size_bytes()));
	std::memcpy(bytes.data(), corners.data(), corners.size_bytes());
	return result;
}

std::shared_ptr<const MeshCopy> MeshReader::step() {
	const std::shared_ptr<MeshCopy> copy = copy_;
	if (piece_index_ < pieces_.size()) {
		const GroundPiece &piece = pieces_[piece_index_];
		const Ref<Mesh> mesh = piece.mesh;
		const std::int32_t surface = next_surface_++;
		if (surface == 0) {
			copy->pieces_.push_back({{}, piece.frames});
		}
		std::int32_t count = 1;
		if (mesh.is_null()) {
			copy->pieces_.back().surfaces.push_back(read_corners(piece.corners));
		} else if (surface < mesh->get_surface_count()) {
			MeshCopy::Surface surface_copy =
					is_stored(*mesh.ptr()) ? read_stored(*mesh.ptr(), surface) : read_scripted(*mesh.ptr(), surface);
			copy->pieces_.back().surfaces.push_back(std::move(surface_copy));
			count = mesh->get_surface_count();
		}
		if (copy != copy_) {
			return nullptr; // A script of the mesh has started other work.
		}
		if (next_surface_ >= count) {
			++piece_index_;
			next_surface_ = 0;
		}
	}
	if (piece_index_ < pieces_.size()) {
		return nullptr;
	}
	cancel();
	return copy;
}

} // namespace thicket
