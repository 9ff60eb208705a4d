#pragma once

#include "core/impostor/impostor_surface.hpp"

#include <godot_cpp/classes/image.hpp>
#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/variant/array.hpp>

namespace thicket {

/// Reads triangles from the arrays of a surface, as returned by Mesh.surface_get_arrays. Reads the
/// positions, and also the normals, colors, texture coordinates and indices if they exist. Without
/// indices, each three consecutive vertices form a triangle. Refuses an array of the wrong type,
/// under the property `arrays`.
Status read_arrays(const godot::Array &p_arrays, ImpostorSurface &r_surface);

/// Reads the pixels of an image. Decompresses a copy if needed; the image itself is not changed.
/// Refuses an image that cannot be decompressed, under the property `texture`.
Status read_texture(const godot::Ref<godot::Image> &p_image, SurfaceTexture &r_texture);

} // namespace thicket
