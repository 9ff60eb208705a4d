#pragma once

#include "core/base/rect.hpp"
#include "core/rules/density_field.hpp"

#include <glm/vec2.hpp>

#include <cstdint>
#include <vector>

namespace thicket {

/// How a mask continues outside its image.
enum class MaskEdge : std::uint8_t {
	nothing,    ///< Density 0.
	everything, ///< Density 1.
	clamp,      ///< The density of the nearest position in the image.
	repeat,     ///< The image repeats.
};

inline constexpr int max_mask_pixels = 1 << 14; ///< On each side.

/// Densities from an image of 8-bit values over a rectangle of the world. Bilinear between pixel centers. Immutable after `set`.
class ImageMask final : public DensityField {
public:
	/// `pixels` are in row order, x fastest; 0 to 255 means densities 0 to 1. `area` is in world meters, finite and not empty. `size` is
	/// 1 to max_mask_pixels on both axes. Anything else is refused and changes nothing.
	Status set(glm::ivec2 size, std::span<const std::uint8_t> pixels, const Rect &area, MaskEdge edge);

	/// Returns 0 for a position that is not finite, whatever the edge mode.
	Status sample(std::span<const glm::dvec2> positions, std::span<float> r_density) const override;

	friend bool operator==(const ImageMask &, const ImageMask &);

private:
	double at(glm::dvec2 position) const;

	glm::ivec2 size_{1};
	std::vector<std::uint8_t> pixels_{255};
	Rect area_{{0.0, 0.0}, {1.0, 1.0}};
	MaskEdge edge_ = MaskEdge::everything;
};

} // namespace thicket
