#pragma once

#include "core/base/progress.hpp"
#include "core/base/status.hpp"
#include "core/impostor/impostor_surface.hpp"
#include "core/impostor/octahedron.hpp"

#include <glm/vec3.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// How many pictures of a model are taken, and how large they are.
struct ImpostorSettings {
	int frames = 16;      ///< Pictures on a side of the atlas, min_impostor_frames to max_impostor_frames.
	int frame_size = 128; ///< Pixels on a side of a picture: a power of two, min_frame_size to max_frame_size.
	int samples = 2;      ///< On a side of a pixel, 1 to max_impostor_samples.
	OctahedralSpan span = OctahedralSpan::hemisphere;
};

inline constexpr int min_impostor_frames = 2;
inline constexpr int max_impostor_frames = 32;
inline constexpr int min_frame_size = 16;
inline constexpr int max_frame_size = 512;
inline constexpr int max_impostor_samples = 8;
inline constexpr int max_atlas_side = 8192; ///< Pixels.

/// Refuses settings outside their ranges, and pictures that make an atlas larger than max_atlas_side.
Status validate(const ImpostorSettings &settings);

/// Pictures of a model from all around in parallel projection, in a square atlas of frames x frames. The picture in column c and
/// row r (from the top) is taken from octahedral_direction(2 * (c, r) / (frames - 1) - 1), with picture_axes; it shows the
/// square that the model's ball fills, `up` being up.
///
/// The idea: Ryan Brucks, *Octahedral Impostors*, 2018.
struct Impostor {
	ImpostorSettings settings;
	glm::vec3 min{0.0F}; ///< The box of all triangles, meters.
	glm::vec3 max{0.0F};
	glm::vec3 center{0.0F}; ///< Of the ball that the pictures show: the middle of the box.
	float radius = 0.0F;    ///< Meters; a half of a picture's side.

	/// Both atlases, four bytes a pixel, row by row from the top: the finest level and then all its mip maps, each with half the side,
	/// rounded down, to a single pixel. No level of a picture's own mixes it with its neighbors, and the share of pixels whose alpha
	/// is at least a half is the same in each. Where there is nothing, color, normal and depth are those of what is near.
	std::vector<std::uint8_t> albedo; ///< sRGB, and how much of the pixel is covered.
	std::vector<std::uint8_t>
			normal; ///< x, y, z of the normal from -1 to 1; depth towards the viewer from -radius to radius.
};

/// Takes the pictures. Surfaces without a triangle, or numbers that ImpostorSurface::check refuses, are refused; a call that is
/// refused, cancelled or out of memory leaves `r_impostor` as it was. `progress` is told after each picture, and `points`
/// counts these; a raised flag ends the call within one picture (up to about 0.1 s at usual sizes).
Status bake_impostor(std::span<const ImpostorSurface> surfaces, const ImpostorSettings &settings,
		const Progress &progress, Impostor &r_impostor);

} // namespace thicket
