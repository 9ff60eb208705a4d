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
	for (const auto &number : std::span(p_numbers.ptr(), static_cast<std::size_t>(p_numbers.size()))) {
		Number stored{};
		if constexpr (std::is_same_v<Number, glm::vec3>) {
			stored = floats_of(number);
		} else {
			stored = static_cast<Number>(number);
		}
		std::memcpy(out, &stored, sizeof(stored));
		out += sizeof(stored);
	}
	return bytes;
}

/// Appends a copy of triangles in another frame. A mirrored copy keeps the front of each triangle.
void append_placed(std::span<const glm::vec3> corners, const Transform3D &frame, std::vector<glm::vec3> &r_corners) {
	const glm::dmat3 basis = to_core(frame.basis);
	const glm::dvec3 origin = to_core(frame.origin);
	const bool mirrored = glm::determinant(basis) < 0.0;
	const std::size_t first = r_corners.size();
	for (const glm::vec3 &corner : corners) {
		r_corners.emplace_back(origin + basis * glm::dvec3(corner));
	}
	for (std::size_t triangle = first; mirrored && triangle + 2 < r_corners.size(); triangle += 3) {
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
			MeshSurface stored = surface.layout;
			stored.vertices = span_of(surface.vertices);
			stored.indices = span_of(surface.indices);
			if (const Status status = thicket::append_faces(stored, r_corners); !status.ok()) {
				return status;
			}
		}
		if (!piece.frames.empty()) {
			const std::vector<glm::vec3> corners(r_corners.begin() + first, r_corners.end());
			r_corners.resize(static_cast<std::size_t>(first));
			for (const Transform3D &frame : piece.frames) {
				append_placed(corners, frame, r_corners);
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
	piece_ = 0;
	next_ = 0;
}

/// Copies a surface in the renderer's format.
MeshCopy::Surface MeshReader::read_stored(const Mesh &p_mesh, std::int32_t surface) {
	const Dictionary stored = RenderingServer::get_singleton()->mesh_get_surface(p_mesh.get_rid(), surface);
	MeshCopy::Surface read;
	const auto format = static_cast<std::uint64_t>(static_cast<std::int64_t>(stored["format"]));
	read.layout.shape = shape_of(stored["primitive"]);
	if ((format & SurfaceFormat::no_vertices) != 0) {
		read.layout.shape = MeshSurface::Shape::none;
	} else if ((format & SurfaceFormat::flat) != 0) {
		read.layout.positions = MeshSurface::Positions::flat;
	} else if ((format & SurfaceFormat::quantized) != 0) {
		read.layout.positions = MeshSurface::Positions::quantized;
	}
	read.layout.vertex_count = static_cast<std::size_t>(static_cast<std::int64_t>(stored["vertex_count"]));
	read.layout.index_count =
			static_cast<std::size_t>(static_cast<std::int64_t>(stored.get("index_count", std::int64_t{0})));
	const AABB box = stored["aabb"];
	read.layout.box_corner = floats_of(box.position);
	read.layout.box_size = floats_of(box.size);
	read.vertices = stored["vertex_data"];
	read.indices = stored.get("index_data", PackedByteArray());
	return read;
}

/// Copies a surface that a mesh's script returns.
MeshCopy::Surface MeshReader::read_scripted(Mesh &r_mesh, std::int32_t surface) {
	const StringName primitive("_surface_get_primitive_type");
	MeshCopy::Surface read;
	read.layout.shape =
			r_mesh.has_method(primitive) ? shape_of(r_mesh.call(primitive, surface)) : MeshSurface::Shape::triangles;
	const Array arrays = r_mesh.surface_get_arrays(surface);
	const auto stream = [&arrays](std::int64_t which) {
		return which < arrays.size() ? arrays[which] : Variant();
	};
	const PackedVector3Array positions = stream(SurfaceStream::positions);
	const PackedInt32Array indices = stream(SurfaceStream::indices);
	read.layout.vertex_count = static_cast<std::size_t>(positions.size());
	read.layout.index_count = static_cast<std::size_t>(indices.size());
	read.vertices = packed_as<glm::vec3>(positions);
	read.indices = packed_as<std::uint32_t>(indices);
	return read;
}

MeshCopy::Surface MeshReader::read_corners(std::span<const glm::vec3> corners) {
	MeshCopy::Surface read;
	read.layout.shape = MeshSurface::Shape::triangles;
	read.layout.vertex_count = corners.size();
	const auto bytes = resize(read.vertices, static_cast<std::int64_t>(corners.size_bytes()));
	std::memcpy(bytes.data(), corners.data(), corners.size_bytes());
	return read;
}

std::shared_ptr<const MeshCopy> MeshReader::step() {
	const std::shared_ptr<MeshCopy> copy = copy_;
	if (piece_ < pieces_.size()) {
		const GroundPiece &piece = pieces_[piece_];
		const Ref<Mesh> mesh = piece.mesh;
		const std::int32_t surface = next_++;
		if (surface == 0) {
			copy->pieces_.push_back({{}, piece.frames});
		}
		std::int32_t count = 1;
		if (mesh.is_null()) {
			copy->pieces_.back().surfaces.push_back(read_corners(piece.corners));
		} else if (surface < mesh->get_surface_count()) {
			MeshCopy::Surface read =
					is_stored(*mesh.ptr()) ? read_stored(*mesh.ptr(), surface) : read_scripted(*mesh.ptr(), surface);
			copy->pieces_.back().surfaces.push_back(std::move(read));
			count = mesh->get_surface_count();
		}
		if (copy != copy_) {
			return nullptr; // A script of the mesh has started other work.
		}
		if (next_ >= count) {
			++piece_;
			next_ = 0;
		}
	}
	if (piece_ < pieces_.size()) {
		return nullptr;
	}
	cancel();
	return copy;
}

} // namespace thicket
