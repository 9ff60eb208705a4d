#pragma once

#include "core/base/rect.hpp"
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

/// A mesh as ground, at its position in the world when it was read.
struct GroundMesh {
	GroundSight sight;
	glm::dvec3 offset{0.0};   ///< The world position of the engine's origin at that time.
	std::uint64_t digest = 0; ///< The digest of the triangles in the world.
	TriangleParts::Part ground;
	std::shared_ptr<const MeshCopy> copy; ///< The source. Kept, so that a moved mesh is not read again.
};

using GroundMeshes = std::map<std::uint64_t, std::shared_ptr<const GroundMesh>>; ///< By the instances' IDs.

/// A mesh that was read and is not yet built.
struct MeshReading {
	std::uint64_t id = 0; ///< The instance's ID.
	GroundSight sight;
	glm::dvec3 offset{0.0};
	std::shared_ptr<const MeshCopy> copy;
	std::shared_ptr<const GroundMesh> before; ///< Reused if nothing has changed; null if there is none.

	Status status;
	glm::dvec3 refused_corner{0.0};         ///< In the world, if a corner is the reason for the refusal.
	std::shared_ptr<const GroundMesh> part; ///< Null before `build`, and if the mesh is refused.

	/// Builds from the faces of `copy`, on any thread.
	void build(std::span<const glm::vec3> faces, const std::atomic<bool> *cancel);
};

/// The ground of all hosts that have the same world position of the engine's origin.
struct GroundWorld {
	glm::dvec3 offset{0.0};
	std::shared_ptr<const GroundMeshes> parts;   ///< Never null.
	std::shared_ptr<const GroundMeshes> before;  ///< The parts when the work began.
	std::shared_ptr<const TriangleParts> ground; ///< Null before it was built for the first time.
	std::vector<Rect> changes;                   ///< The areas that the last work has changed.
	Status status;
};

/// The work of a worker: builds the ground of meshes, and the worlds that contain them.
struct MeshWork {
	std::vector<MeshReading> readings;
	std::vector<std::uint64_t> gone; ///< Instances that are no longer ground.
	std::vector<GroundWorld> worlds;
	std::vector<std::shared_ptr<const void>> unneeded; ///< Freed first, which takes milliseconds for much memory.

	void run(const std::atomic<bool> *cancel);

private:
	void build_readings(const std::atomic<bool> *cancel);
	void update(GroundWorld &r_world) const;
};

} // namespace thicket
