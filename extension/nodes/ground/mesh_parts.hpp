#pragma once

#include "core/base/planet.hpp"
#include "core/base/rect.hpp"
#include "core/terrain/ground_shell.hpp"
#include "core/terrain/triangle_parts.hpp"
#include "nodes/ground/ground_watch.hpp"
#include "nodes/ground/mesh_copy.hpp"

#include <glm/vec3.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// The reference frame of a host's world: the engine's origin or the host itself.
struct GroundSpace {
	glm::dvec3 offset{0.0}; ///< The position of the engine's origin in the world; zero for local coordinates.
	std::uint64_t host = 0; ///< The ID of a host with local coordinates; otherwise 0.

	bool operator==(const GroundSpace &) const = default;
};

/// The ground of a mesh instance, at its world position when it was read.
struct GroundMesh {
	GroundNodeState state;    ///< The node's state. Its transform is in `space`, without the offset.
	GroundSpace space;        ///< The space when the mesh was read.
	std::uint64_t digest = 0; ///< A digest of the triangles in world space.
	TriangleParts::Part ground;
	Planet planet;                        ///< The planet when the mesh was read, if any.
	GroundShell shell;                    ///< Contains all triangles; empty if there is no planet.
	std::shared_ptr<const MeshCopy> copy; ///< Kept to avoid rereading a moved mesh.
};

/// Returns the rectangle of the world that contains all triangles of a mesh.
Rect area_of(const GroundMesh &mesh);

/// The ground of all mesh instances, keyed by instance ID.
using GroundMeshes = std::map<std::uint64_t, std::shared_ptr<const GroundMesh>>;

/// A mesh instance whose mesh was read but whose ground is not yet built.
struct MeshReading {
	std::uint64_t id = 0; ///< The MeshInstance3D's ID.
	GroundNodeState state;
	GroundSpace space;
	std::shared_ptr<const MeshCopy> copy;
	/// The previous ground, which is reused if its triangles are unchanged. May be null.
	std::shared_ptr<const GroundMesh> before;
	Planet planet;

	Status status;
	/// The invalid corner in world space, if a corner is the reason for the error.
	glm::dvec3 refused_corner{0.0};
	/// The result. Null before `build`, and if the mesh was rejected.
	std::shared_ptr<const GroundMesh> mesh;

	/// Builds `mesh` from the triangles of `copy` in local space. Any thread may call this method.
	void build(std::span<const glm::vec3> faces, const std::atomic<bool> *cancel);
};

/// The ground for all hosts with the same space.
struct GroundWorld {
	GroundSpace space;
	std::shared_ptr<const GroundMeshes> meshes;  ///< Never null.
	std::shared_ptr<const GroundMeshes> before;  ///< The meshes at the start of the work.
	std::shared_ptr<const TriangleParts> ground; ///< The ground of the whole world. Null until it is first built.
	std::vector<Rect> changes;                   ///< The areas that the last work changed.
	Status status;
};

/// The work for a worker: builds the ground of meshes and updates the worlds that contain them.
struct MeshWork {
	std::vector<MeshReading> readings;
	std::vector<std::uint64_t> removed_ids; ///< IDs of instances that are no longer ground.
	std::vector<GroundWorld> worlds;
	/// Large objects that the worker frees, because freeing them takes milliseconds.
	std::vector<std::shared_ptr<const void>> unneeded_objects;

	void run(const std::atomic<bool> *cancel);

private:
	void build_readings(const std::atomic<bool> *cancel);
	void update(GroundWorld &r_world) const;
};

} // namespace thicket
