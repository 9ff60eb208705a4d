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

/// The number and the size of the frames that are taken of a model.
struct ImpostorSettings {
	int frames = 16;      ///< Frames on a side of the atlas, min_impostor_frames to max_impostor_frames.
	int frame_size = 128; ///< Pixels on a side of a frame: a power of two, min_frame_size to max_frame_size.
	int samples = 2;      ///< Samples on a side of a pixel, 1 to max_impostor_samples.
	OctahedralSpan span = OctahedralSpan::hemisphere;
};

inline constexpr int min_impostor_frames = 2;
inline constexpr int max_impostor_frames = 32;
inline constexpr int min_frame_size = 16;
inline constexpr int max_frame_size = 512;
inline constexpr int max_impostor_samples = 8;
inline constexpr int max_atlas_side = 8192; ///< Pixels.

/// Refuses settings outside their ranges, and frames that would make an atlas larger than max_atlas_side.
Status validate(const ImpostorSettings &settings);

/// Frames of a model from all around in parallel projection, in a square atlas of frames x frames. The frame in column c and row r (from
/// the top) is taken from octahedral_direction(2 * (c, r) / (frames - 1) - 1), with picture_axes. It shows the square that encloses the
/// model's bounding sphere, with `up` pointing up.
///
/// The idea is from Ryan Brucks, *Octahedral Impostors*, 2018.
struct Impostor {
	ImpostorSettings settings;
	glm::vec3 min{0.0F}; ///< The box of all triangles, meters.
	glm::vec3 max{0.0F};
	glm::vec3 center{0.0F}; ///< The center of the sphere that the frames show, which is the center of the box.
	float radius = 0.0F;    ///< Meters; half of a frame's side.

	/// Both atlases, four bytes per pixel, row by row from the top: the finest level and then all its mip maps, each
	/// with half the side, rounded down, to a single pixel. In levels where each frame has its own pixels, these are
	/// not mixed with the pixels of neighboring frames. Each level has the same share of pixels whose alpha is at least
	/// a half. Empty pixels have the color, normal and depth of nearby ones.
	std::vector<std::uint8_t> albedo; ///< sRGB, and the share of the pixel that is covered.
	/// x, y, z of the normal from -1 to 1; depth towards the viewer from -radius to radius.
	std::vector<std::uint8_t> normal;
};

/// Renders the frames. Refuses surfaces without a triangle, and numbers that ImpostorSurface::check refuses. If the
/// call is refused, cancelled or out of memory, `r_impostor` is unchanged. Calls `progress` after each frame; its
/// `points` is the number of frames. Ends within one frame (up to about 0.1 s at usual sizes) after the cancel flag is
/// raised.
Status bake_impostor(std::span<const ImpostorSurface> surfaces, const ImpostorSettings &settings,
		const Progress &progress, Impostor &r_impostor);

} // namespace thicket
