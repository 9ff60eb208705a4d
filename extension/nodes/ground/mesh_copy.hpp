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

/// The triangles of a mesh as the renderer stores them, so that a worker can decode them. Immutable. Shares the renderer's memory unless
/// that is on a graphics card.
class MeshCopy {
public:
	/// Adds three corners per triangle, in the mesh's space. On any thread.
	Status append_faces(std::vector<glm::vec3> &r_corners) const;

private:
	friend class MeshReader;

	struct Surface {
		MeshSurface layout; ///< Except for the spans, which are those of the arrays.
		godot::PackedByteArray vertices;
		godot::PackedByteArray indices;
	};

	std::vector<Surface> surfaces_;
};

/// Copies a mesh, one surface with each step. Main thread only: the renderer answers other threads only once per frame,
/// and never while the main thread waits for them.
///
/// Reads the renderer's data rather than Mesh.get_faces, which builds and keeps a search tree that some changes do not update.
class MeshReader {
public:
	/// Begins to read a mesh. `version` identifies its state.
	void start(const godot::Ref<godot::Mesh> &p_mesh, std::uint64_t version);

	bool busy() const { return mesh_.is_valid(); }
	std::uint64_t source() const { return source_; }
	std::uint64_t version() const { return version_; }

	/// Reads the next surface. Returns the copy after the last surface, and null before. If the mesh has a script, runs
	/// the script, which may do anything, even call `cancel`.
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
