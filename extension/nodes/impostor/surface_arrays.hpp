#pragma once

#include "core/impostor/impostor_surface.hpp"

#include <godot_cpp/classes/image.hpp>
#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/variant/array.hpp>

namespace thicket {

/// Reads triangles from the arrays of a surface, as returned by Mesh.surface_get_arrays. Reads the
/// positions, and also the normals, colors, texture coordinates and indices if they exist. Without
/// indices, every three consecutive vertices form a triangle. Returns an error for the property
/// `arrays` if an array has the wrong type.
Status read_arrays(const godot::Array &p_arrays, ImpostorSurface &r_surface);

/// Reads the pixels of an image. Decompresses a copy if needed, so the image does not change.
/// Returns an error for the property `texture` if the image cannot be decompressed.
Status read_texture(const godot::Ref<godot::Image> &p_image, SurfaceTexture &r_texture);

} // namespace thicket
