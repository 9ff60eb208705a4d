#pragma once

#include "core/impostor/impostor_surface.hpp"

#include <godot_cpp/classes/image.hpp>
#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/variant/array.hpp>

namespace thicket {

/// The triangles in the arrays of a mesh's surface (Mesh.ARRAY_VERTEX and so on): positions, and normals, colors, texture coordinates
/// and indices where they are there. Without indices the vertices are triangles in their order. Refuses arrays of other types,
/// under the property `arrays`.
Status read_arrays(const godot::Array &p_arrays, ImpostorSurface &r_surface);

/// The pixels of an image, decompressed if need be; the image stays as it is. Refuses what cannot be decompressed, under the
/// property `texture`.
Status read_texture(const godot::Ref<godot::Image> &p_image, SurfaceTexture &r_texture);

} // namespace thicket
