#pragma once

#include "core/base/status.hpp"
#include "core/terrain/mesh_surface.hpp"
#include "nodes/ground/ground_pieces.hpp"

#include <godot_cpp/classes/mesh.hpp>
#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/variant/packed_byte_array.hpp>
#include <godot_cpp/variant/transform3d.hpp>

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// An immutable copy of a ground node's triangles, in the renderer's format, for decoding on a
/// worker. Shares the renderer's memory unless the data was read back from a GPU.
class MeshCopy {
public:
	/// Appends three corners per triangle, in the node's local space. Any thread may call this
	/// method.
	Status append_faces(std::vector<glm::vec3> &r_corners) const;

private:
	friend class MeshReader;

	struct Surface {
		MeshSurface layout; ///< The layout of the surface. `append_faces` sets its spans.
		godot::PackedByteArray vertices;
		godot::PackedByteArray indices;
	};

	/// The surfaces of a mesh and its copies; see GroundPiece::frames.
	struct Piece {
		std::vector<Surface> surfaces;
		std::vector<godot::Transform3D> frames;
	};

	std::vector<Piece> pieces_;
};

/// Copies the meshes of a ground node, one surface per step. Use it only on the main thread. On
/// other threads, a call to the renderer waits for the next frame and would never return while the
/// main thread waits for that thread.
///
/// Reads the renderer's data instead of calling Mesh.get_faces, which builds and keeps a search
/// tree that some changes do not update.
class MeshReader {
public:
	/// Starts reading a node's pieces. `source` and `version` identify the state of the pieces.
	void start(std::vector<GroundPiece> pieces, std::uint64_t source, std::uint64_t version);

	bool busy() const { return copy_ != nullptr; }
	std::uint64_t source() const { return source_; }
	std::uint64_t version() const { return version_; }

	/// Copies the next surface. Returns the finished copy after the last surface of the last piece,
	/// otherwise null. May run a script of the mesh, which may do anything, even call `cancel`.
	std::shared_ptr<const MeshCopy> step();

	void cancel();

private:
	static MeshCopy::Surface read_stored(const godot::Mesh &p_mesh, std::int32_t surface);
	static MeshCopy::Surface read_scripted(godot::Mesh &r_mesh, std::int32_t surface);
	static MeshCopy::Surface read_corners(std::span<const glm::vec3> corners);

	std::vector<GroundPiece> pieces_;
	std::uint64_t source_ = 0;
	std::uint64_t version_ = 0;
	std::size_t piece_index_ = 0;   ///< The piece that is being read.
	std::int32_t next_surface_ = 0; ///< The next surface of the piece.
	std::shared_ptr<MeshCopy> copy_;
};

} // namespace thicket
