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

/// Whether the engine itself stores the mesh in its renderer. Other meshes are provided by their scripts.
bool is_stored(const Mesh &p_mesh) {
	return p_mesh.is_class("ArrayMesh") || p_mesh.is_class("PrimitiveMesh") || p_mesh.is_class("ImmediateMesh");
}

} // namespace

Status MeshCopy::append_faces(std::vector<glm::vec3> &r_corners) const {
	for (const Surface &surface : surfaces_) {
		MeshSurface stored = surface.layout;
		stored.vertices = span_of(surface.vertices);
		stored.indices = span_of(surface.indices);
		if (const Status status = thicket::append_faces(stored, r_corners); !status.ok()) {
			return status;
		}
	}
	return {};
}

void MeshReader::start(const Ref<Mesh> &p_mesh, std::uint64_t version) {
	cancel();
	mesh_ = p_mesh;
	source_ = p_mesh->get_instance_id();
	version_ = version;
	copy_ = std::make_shared<MeshCopy>();
}

void MeshReader::cancel() {
	mesh_ = Ref<Mesh>();
	copy_ = nullptr;
	next_ = 0;
}

/// Reads the surface in the renderer's own bytes.
void MeshReader::read_stored(const Mesh &p_mesh, std::int32_t surface, MeshCopy &r_copy) {
	const Dictionary stored = RenderingServer::get_singleton()->mesh_get_surface(p_mesh.get_rid(), surface);
	if (stored.is_empty()) {
		return; // The engine has printed the reason.
	}
	const auto format = static_cast<std::uint64_t>(static_cast<std::int64_t>(stored["format"]));
	MeshCopy::Surface read;
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
	r_copy.surfaces_.push_back(std::move(read));
}

/// Reads the surface that a mesh's script returns.
void MeshReader::read_scripted(Mesh &r_mesh, std::int32_t surface, MeshCopy &r_copy) {
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
	r_copy.surfaces_.push_back(std::move(read));
}

std::shared_ptr<const MeshCopy> MeshReader::step() {
	const Ref<Mesh> mesh = mesh_;
	const std::shared_ptr<MeshCopy> copy = copy_;
	const std::int32_t surface = next_++;
	if (surface < mesh->get_surface_count()) {
		if (is_stored(*mesh.ptr())) {
			read_stored(*mesh.ptr(), surface, *copy);
		} else {
			read_scripted(*mesh.ptr(), surface, *copy);
		}
	}
	if (copy != copy_ || next_ < mesh->get_surface_count()) {
		return nullptr;
	}
	cancel();
	return copy;
}

} // namespace thicket
