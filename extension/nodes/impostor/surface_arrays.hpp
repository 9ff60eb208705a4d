#pragma once

#include "core/impostor/impostor_surface.hpp"

#include <godot_cpp/classes/image.hpp>
#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/variant/array.hpp>

namespace thicket {

/// Reads the triangles from the arrays of a mesh's surface (Mesh.ARRAY_VERTEX and so on): positions, and normals, colors, texture
/// coordinates and indices if they exist. Without indices, the vertices form triangles in their order. Refuses arrays of other types, under
/// the property `arrays`.
Status read_arrays(const godot::Array &p_arrays, ImpostorSurface &r_surface);

/// Reads the pixels of an image, decompressed if needed; the image is not changed. Refuses an image that cannot be decompressed, under the
/// property `texture`.
Status read_texture(const godot::Ref<godot::Image> &p_image, SurfaceTexture &r_texture);

} // namespace thicket
