#pragma once

#include "core/base/status.hpp"
#include "core/impostor/surface_texture.hpp"

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <cstdint>
#include <memory>
#include <vector>

namespace thicket {

/// The side of a triangle that is not drawn. Front faces have clockwise winding, as in the engine.
enum class CulledSide : std::uint8_t {
	back,
	front,
	none, ///< Both sides are drawn, the back with reversed normals.
};

/// The use of a surface's vertex colors.
enum class VertexColors : std::uint8_t {
	unused,
	linear, ///< The albedo is multiplied by the vertex colors.
	srgb,   ///< Like `linear`, after conversion from sRGB.
};

struct ImpostorMaterial {
	glm::vec4 albedo{1.0F};                        ///< Linear color with alpha; each at least 0.
	std::shared_ptr<const SurfaceTexture> texture; ///< Null if there is no texture.
	/// Samples with a lower alpha are empty. 0 to 1; 0 ignores alpha.
	float alpha_threshold = 0.0F;
	CulledSide culled_side = CulledSide::back;
	VertexColors vertex_colors = VertexColors::unused;
};

/// A part of a model with a single material. Each triangle has three entries in `indices`. Normals,
/// UVs and colors are either empty or have one entry per position. Without normals, triangles have
/// flat normals.
struct ImpostorSurface {
	std::vector<glm::vec3> positions; ///< Positions of the vertices in meters.
	std::vector<glm::vec3> normals;   ///< Normals of the vertices: unit vectors.
	std::vector<glm::vec2> uvs;
	std::vector<glm::vec4> colors;
	std::vector<std::uint32_t> indices;
	ImpostorMaterial material;

	/// Transforms positions and normals by a basis and an offset. If the basis mirrors, also
	/// reverses the winding of the triangles so that front faces remain front faces.
	void transform(const glm::mat3 &basis, glm::vec3 offset);

	/// Returns an error if a number is not finite or out of range, if the lists have different
	/// sizes, or if an index does not refer to a vertex.
	Status check() const;
};

} // namespace thicket
