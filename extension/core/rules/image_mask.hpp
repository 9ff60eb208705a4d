#pragma once

#include "core/base/rect.hpp"
#include "core/rules/density_field.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <vector>

namespace thicket {

/// The density at positions outside the image.
enum class MaskEdge : std::uint8_t {
	nothing,    ///< The density is 0.
	everything, ///< The density is 1.
	clamp,      ///< The density at the nearest position in the image.
	repeat,     ///< The image repeats.
};

inline constexpr int max_mask_pixels = 1 << 14; ///< Maximum width and height in pixels.

/// Densities from an 8-bit image over a rectangle of the world, interpolated bilinearly between
/// pixel centers. The mask does not change after `set`.
class ImageMask final : public DensityField {
public:
	/// Sets the image. `pixels` are in row order, x fastest; 0 to 255 means densities 0 to 1.
	/// `area` is in world meters, finite and not empty. `size` is 1 to max_mask_pixels on both
	/// axes. Any other value is an error and leaves the mask unchanged.
	Status set(glm::ivec2 size, std::span<const std::uint8_t> pixels, const Rect &area, MaskEdge edge);

	/// At a position that is not finite, the density is 0 for every MaskEdge.
	Status sample(std::span<const glm::dvec2> positions, std::span<float> r_density) const override;

	/// Returns the density in a direction from a planet's center, which need not be normalized; 0 if
	/// it is not finite. The image covers the whole sphere, as a texture covers the engine's
	/// SphereMesh: `area` and MaskEdge have no effect. The first row is at the pole toward world y,
	/// and the last row at the opposite pole. Columns go once around the planet, from +z over +x, -z
	/// and -x, so the left and right borders of the image meet. Pixels have equal angles.
	double toward(const glm::dvec3 &from_center) const;

	friend bool operator==(const ImageMask &, const ImageMask &);

private:
	double at(glm::dvec2 position) const;
	double interpolate(glm::dvec2 fraction, bool repeat_x, bool repeat_y) const;

	glm::ivec2 size_{1};
	std::vector<std::uint8_t> pixels_{255};
	Rect area_{{0.0, 0.0}, {1.0, 1.0}};
	MaskEdge edge_ = MaskEdge::everything;
};

} // namespace thicket
