#pragma once

#include "core/base/view_volume.hpp"
#include "core/base/world_frame.hpp"

#include <godot_cpp/classes/mesh.hpp>

#include <glm/vec3.hpp>

#include <cstdint>
#include <map>
#include <optional>

namespace godot {
class Camera3D;
} // namespace godot

namespace thicket {

/// The number of objects that the renderer draws in one frame, without shadows.
struct DrawFigures {
	std::uint64_t multimeshes = 0;
	std::uint64_t instances = 0;
	std::uint64_t triangles = 0;
	std::uint64_t draw_calls = 0;
};

/// Adds up the statistics of everything that is drawn, or only of the part that may be visible in a
/// view.
class DrawCounter {
public:
	explicit DrawCounter(const std::optional<ViewVolume> &view) : view_(view) {}

	/// Adds instances of a mesh. `min` and `max` are their bounds in world meters.
	void add(const godot::Ref<godot::Mesh> &mesh, std::uint64_t instances, glm::dvec3 min, glm::dvec3 max);
	const DrawFigures &figures() const { return figures_; }

private:
	struct MeshFigures {
		std::uint64_t triangles = 0;
		std::uint64_t surfaces = 0;
	};
	const MeshFigures &figures_of(const godot::Ref<godot::Mesh> &mesh);

	std::optional<ViewVolume> view_;
	std::map<std::uint64_t, MeshFigures> meshes_; ///< The triangles and surfaces of each mesh, keyed by its object ID.
	DrawFigures figures_;
};

/// Returns the view volume of a camera in the tree. `frame` is the world position of the engine's
/// origin, in meters.
ViewVolume view_of(const godot::Camera3D &camera, const WorldFrame &frame);

} // namespace thicket
