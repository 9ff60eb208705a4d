#pragma once

#include <godot_cpp/classes/mesh.hpp>
#include <godot_cpp/classes/ref.hpp>

#include <glm/vec3.hpp>

#include <cstddef>
#include <vector>

namespace thicket {

/// The most corners of a convex body: those farthest out.
inline constexpr std::size_t max_convex_corners = 64;

/// The corners of a mesh's convex hull, at most max_convex_corners. Empty where there is no hull, as of a mesh without surfaces. Main thread only.
std::vector<glm::vec3> convex_corners(const godot::Ref<godot::Mesh> &mesh);

} // namespace thicket
