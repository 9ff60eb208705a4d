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

/// The number and the size of an impostor's frames.
struct ImpostorSettings {
	int frames = 16;      ///< Frames along each edge of the atlas, min_impostor_frames to max_impostor_frames.
	int frame_size = 128; ///< Pixels along each edge of a frame: a power of two, min_frame_size to max_frame_size.
	int samples = 2;      ///< Samples along each edge of a pixel, 1 to max_impostor_samples.
	OctahedralSpan span = OctahedralSpan::hemisphere;
};

inline constexpr int min_impostor_frames = 2;
inline constexpr int max_impostor_frames = 32;
inline constexpr int min_frame_size = 16;
inline constexpr int max_frame_size = 512;
inline constexpr int max_impostor_samples = 8;
inline constexpr int max_atlas_side = 8192; ///< Maximum width and height of the atlas in pixels.

/// Returns an error if a setting is out of range, or if the atlas would be larger than
/// max_atlas_side.
Status validate(const ImpostorSettings &settings);

/// Views of a model from all around, in orthogonal projection, in a square atlas of frames x
/// frames. The frame in column c and row r (from the top) shows the model from
/// octahedral_direction(2 * (c, r) / (frames - 1) - 1). A frame's axes come from view_axes(). A
/// frame covers the square that encloses the model's bounding sphere.
///
/// The idea is from Ryan Brucks, *Octahedral Impostors*, 2018.
struct Impostor {
	ImpostorSettings settings;
	glm::vec3 min{0.0F}; ///< The bounding box of all triangles, in meters.
	glm::vec3 max{0.0F};
	glm::vec3 center{0.0F}; ///< The center of the sphere that the frames show, which is the center of the box.
	float radius = 0.0F;    ///< The radius of that sphere in meters: half of a frame's width.

	/// Both atlases have four bytes per pixel, row by row from the top. The finest level comes
	/// first, followed by all its mipmaps down to a single pixel, each half as wide and high,
	/// rounded down. In levels where each frame has its own pixels, neighboring frames are not
	/// blended. In all levels, about the same fraction of pixels has an alpha of at least one half.
	/// Empty pixels have the color, normal and depth of nearby pixels.
	std::vector<std::uint8_t> albedo; ///< sRGB color, and the covered fraction of the pixel as alpha.
	/// The normal's x, y and z from -1 to 1, and the depth toward the viewer from -radius to
	/// radius.
	std::vector<std::uint8_t> normal;
};

/// Renders the frames. Returns an error if the settings are invalid, no surface has a triangle, or
/// a surface fails ImpostorSurface::check(). `r_impostor` is unchanged if the call fails or is
/// canceled. Calls `progress` after each frame, with the number of frames as `points`. After the
/// cancel flag is set, the call ends within one frame, up to about 0.1 s at typical sizes.
Status bake_impostor(std::span<const ImpostorSurface> surfaces, const ImpostorSettings &settings,
		const Progress &progress, Impostor &r_impostor);

} // namespace thicket
