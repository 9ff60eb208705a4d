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

/// The side of a triangle that is not drawn. On the front, corners go clockwise, as in the engine.
enum class CulledSide : std::uint8_t {
	back,
	front,
	none, ///< Both are drawn; the back with reversed normals.
};

/// How a surface uses its vertex colors.
enum class VertexColors : std::uint8_t {
	unused,
	linear, ///< The albedo is multiplied by the vertex colors.
	srgb,   ///< As `linear`, after conversion to linear light.
};

struct ImpostorMaterial {
	glm::vec4 albedo{1.0F};                        ///< In linear light, with alpha; 0 or more.
	std::shared_ptr<const SurfaceTexture> texture; ///< Null for a plain color.
	float alpha_threshold = 0.0F;                  ///< 0 to 1: pixels with an alpha below are empty. 0 ignores alpha.
	CulledSide culled = CulledSide::back;
	VertexColors vertex_colors = VertexColors::unused;
};

/// A part of a model with one material: triangles of three indices each. Normals, texture coordinates and colors are empty, or have one
/// entry for each position. Without normals, triangles are shaded flat.
struct ImpostorSurface {
	std::vector<glm::vec3> positions; ///< Meters.
	std::vector<glm::vec3> normals;   ///< Unit vectors.
	std::vector<glm::vec2> uvs;
	std::vector<glm::vec4> colors;
	std::vector<std::uint32_t> indices;
	ImpostorMaterial material;

	/// Transforms positions and normals by a basis and an offset. If the basis mirrors, also reverses the corners of
	/// the triangles, so that their fronts stay fronts.
	void transform(const glm::mat3 &basis, glm::vec3 offset);

	/// Refuses numbers that are not finite, lists of different sizes, indices without a vertex, and values outside their ranges.
	Status check() const;
};

} // namespace thicket
