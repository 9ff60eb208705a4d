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

/// A mesh as ground, where it was in the world when it was read.
struct GroundMesh {
	GroundSight sight;
	glm::dvec3 offset{0.0};   ///< Where the engine's origin was in the world.
	std::uint64_t digest = 0; ///< Of the triangles in the world.
	TriangleParts::Part ground;
	std::shared_ptr<const MeshCopy> copy; ///< What it was built from: a mesh that only moves is not read again.
};

using GroundMeshes = std::map<std::uint64_t, std::shared_ptr<const GroundMesh>>; ///< By the instances' ids.

/// A mesh that was read and is not built yet.
struct MeshReading {
	std::uint64_t id = 0; ///< Of the instance.
	GroundSight sight;
	glm::dvec3 offset{0.0};
	std::shared_ptr<const MeshCopy> copy;
	std::shared_ptr<const GroundMesh> before; ///< Reused if nothing has changed; null for none.

	Status status;
	glm::dvec3 refused_corner{0.0};         ///< In the world, if a corner is why it was refused.
	std::shared_ptr<const GroundMesh> part; ///< Null before `build`, and for what is refused.

	/// Builds from the faces of `copy`, on any thread.
	void build(std::span<const glm::vec3> faces, const std::atomic<bool> *cancel);
};

/// The ground of all hosts that see the engine's origin at one position of the world.
struct GroundWorld {
	glm::dvec3 offset{0.0};
	std::shared_ptr<const GroundMeshes> parts;   ///< Never null.
	std::shared_ptr<const GroundMeshes> before;  ///< The parts with which the work began.
	std::shared_ptr<const TriangleParts> ground; ///< Null before it was built for the first time.
	std::vector<Rect> changes;                   ///< Where it is not as it was before the last work.
	Status status;
};

/// What a worker does: builds meshes, and the worlds that they belong to.
struct MeshWork {
	std::vector<MeshReading> readings;
	std::vector<std::uint64_t> gone; ///< Instances that are ground no longer.
	std::vector<GroundWorld> worlds;
	std::vector<std::shared_ptr<const void>> unneeded; ///< Freed first: that takes milliseconds for much memory.

	void run(const std::atomic<bool> *cancel);

private:
	void build_readings(const std::atomic<bool> *cancel);
	void update(GroundWorld &r_world) const;
};

} // namespace thicket
