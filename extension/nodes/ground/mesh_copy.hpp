#pragma once

#include "core/base/status.hpp"
#include "core/terrain/mesh_surface.hpp"

#include <godot_cpp/classes/mesh.hpp>
#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/variant/packed_byte_array.hpp>

#include <glm/vec3.hpp>

#include <cstdint>
#include <memory>
#include <vector>

namespace thicket {

/// The triangles of a mesh as the renderer stores them, so that a worker can decode them. Immutable; shares the renderer's memory where
/// that is no graphics card's.
class MeshCopy {
public:
	/// Adds three corners a triangle, in the mesh's space. On any thread.
	Status append_faces(std::vector<glm::vec3> &r_corners) const;

private:
	friend class MeshReader;

	struct Surface {
		MeshSurface layout; ///< But for the spans, which are those of the arrays.
		godot::PackedByteArray vertices;
		godot::PackedByteArray indices;
	};

	std::vector<Surface> surfaces_;
};

/// Copies a mesh, a surface with each step. On the main thread: the renderer answers other threads only when the main thread lets it,
/// once a frame, and never if the main thread waits for them.
///
/// It takes what the renderer has rather than Mesh.get_faces, which builds and keeps a search tree that some changes do not reach.
class MeshReader {
public:
	/// Begins with a mesh. `version` tells its states apart.
	void start(const godot::Ref<godot::Mesh> &p_mesh, std::uint64_t version);

	bool busy() const { return mesh_.is_valid(); }
	std::uint64_t source() const { return source_; }
	std::uint64_t version() const { return version_; }

	/// Reads the next surface. Returns the copy with the last one, null before. Runs the script of a mesh that has one, which may do
	/// anything, even call `cancel`.
	std::shared_ptr<const MeshCopy> step();

	void cancel();

private:
	static void read_stored(const godot::Mesh &p_mesh, std::int32_t surface, MeshCopy &r_copy);
	static void read_scripted(godot::Mesh &r_mesh, std::int32_t surface, MeshCopy &r_copy);

	godot::Ref<godot::Mesh> mesh_;
	std::uint64_t source_ = 0;
	std::uint64_t version_ = 0;
	std::int32_t next_ = 0;
	std::shared_ptr<MeshCopy> copy_;
};

} // namespace thicket
