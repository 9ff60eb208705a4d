#pragma once

#include <godot_cpp/classes/mesh.hpp>
#include <godot_cpp/classes/ref.hpp>

#include <glm/vec3.hpp>

#include <cstddef>
#include <vector>

namespace thicket {

/// The maximum number of corners of a convex body. If there are more, only the outermost ones are
/// kept.
inline constexpr std::size_t max_convex_corners = 64;

/// Returns the corners of a mesh's convex hull, at most max_convex_corners. Returns none if the
/// mesh has no hull, for example because it has no surfaces. Call it only on the main thread.
std::vector<glm::vec3> convex_corners(const godot::Ref<godot::Mesh> &mesh);

} // namespace thicket
