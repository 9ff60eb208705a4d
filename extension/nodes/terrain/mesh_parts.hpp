#pragma once

#include "core/terrain/triangle_parts.hpp"
#include "nodes/terrain/ground_watch.hpp"

#include <godot_cpp/variant/packed_vector3_array.hpp>

#include <glm/vec3.hpp>

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace thicket {

/// A mesh as ground, where it stood in the world when it was read.
struct GroundMesh {
	GroundSight sight;
	glm::dvec3 offset{0.0};   ///< Where the engine's origin was in the world.
	std::uint64_t digest = 0; ///< Of the triangles in the world.
	TriangleParts::Part ground;
};

using GroundMeshes = std::map<std::uint64_t, std::shared_ptr<const GroundMesh>>; ///< By the instances' ids.

/// Adds where there is not the same ground. False if there is, everywhere.
bool add_changes(const GroundMeshes &before, const GroundMeshes &now, std::vector<Rect> &r_areas);

/// A mesh that was read and is not built yet.
struct MeshReading {
	std::uint64_t id = 0; ///< Of the instance.
	GroundSight sight;
	glm::dvec3 offset{0.0};
	godot::PackedVector3Array faces;
	std::shared_ptr<const GroundMesh> before; ///< Used again if nothing has changed; null for none.

	Status status;
	std::shared_ptr<const GroundMesh> part; ///< Null before `build`, and for what is refused.

	/// On any thread. The arrays come from the main thread and go there.
	void build();
};

/// Builds meshes on the engine's WorkerThreadPool, or at once where it has no threads. Main thread only, apart from the work itself.
class MeshBuilder {
public:
	MeshBuilder() = default;
	~MeshBuilder() { cancel(); }
	MeshBuilder(const MeshBuilder &) = delete;
	MeshBuilder &operator=(const MeshBuilder &) = delete;

	/// Not while it is busy.
	void start(std::vector<MeshReading> readings);

	bool busy() const { return busy_; }

	/// True once, when all that was started is built and can be taken.
	bool finish();
	std::vector<MeshReading> take();

	/// Waits for the mesh that is being built, and forgets all.
	void cancel();

private:
	static void run(void *p_builder);

	std::vector<MeshReading> readings_; ///< A worker's until its task has ended.
	std::atomic<bool> cancelled_ = false;
	std::int64_t task_ = -1;
	bool busy_ = false;
};

} // namespace thicket
