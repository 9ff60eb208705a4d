#pragma once

#include "core/impostor/impostor.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace thicket::test {

/// Returns a surface of one color, without normals. Every three corners are a triangle, clockwise
/// when seen from the front.
inline ImpostorSurface triangles(
		std::vector<glm::vec3> corners, glm::vec4 color, CulledSide culled = CulledSide::back) {
	ImpostorSurface surface;
	surface.positions = std::move(corners);
	for (std::uint32_t at = 0; at < surface.positions.size(); ++at) {
		surface.indices.push_back(at);
	}
	surface.material.albedo = color;
	surface.material.culled_side = culled;
	return surface;
}

/// Returns an upright square at depth z that faces +z. Its texture coordinate v runs downward.
inline ImpostorSurface square(float half, float z, glm::vec4 color) {
	ImpostorSurface surface;
	surface.positions = {{-half, half, z}, {half, half, z}, {half, -half, z}, {-half, -half, z}};
	surface.normals.assign(4, {0.0F, 0.0F, 1.0F});
	surface.uvs = {{0.0F, 0.0F}, {1.0F, 0.0F}, {1.0F, 1.0F}, {0.0F, 1.0F}};
	surface.indices = {0, 1, 2, 0, 2, 3};
	surface.material.albedo = color;
	return surface;
}

inline Impostor baked(const std::vector<ImpostorSurface> &surfaces, const ImpostorSettings &settings) {
	Impostor impostor;
	REQUIRE(bake_impostor(surfaces, settings, {}, impostor).ok());
	return impostor;
}

/// Returns the RGBA bytes of a pixel of an atlas's finest mip level. `frame` is the frame's column
/// and row, and `at` is the pixel within the frame.
inline std::array<int, 4> pixel_of(
		const Impostor &impostor, const std::vector<std::uint8_t> &atlas, glm::ivec2 frame, glm::ivec2 at) {
	const ImpostorSettings &settings = impostor.settings;
	const int side = settings.frames * settings.frame_size;
	const glm::ivec2 position = frame * settings.frame_size + at;
	const std::size_t first = 4 * static_cast<std::size_t>(position.y * side + position.x);
	return {atlas[first], atlas[first + 1], atlas[first + 2], atlas[first + 3]};
}

} // namespace thicket::test
