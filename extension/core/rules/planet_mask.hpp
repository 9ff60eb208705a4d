#pragma once

#include "core/base/planet.hpp"
#include "core/rules/density_field.hpp"
#include "core/rules/image_mask.hpp"

#include <memory>
#include <utility>

namespace thicket {

/// An image as a density on a whole planet; see ImageMask::toward. Used by layers on surfaces only.
class PlanetMask final : public DensityField {
public:
	/// `image` must not be null, and the planet must exist.
	PlanetMask(std::shared_ptr<const ImageMask> image, const Planet &planet) :
			image_(std::move(image)), planet_(planet) {}

	/// See from_planet_center for positions without heights.
	Status sample(std::span<const glm::dvec2> positions, std::span<float> r_density) const override;

	Status sample_in_space(std::span<const glm::dvec2> positions, std::span<const float> heights,
			std::span<float> r_density) const override;

	/// Images are compared by address, not by content.
	friend bool operator==(const PlanetMask &a, const PlanetMask &b) {
		return a.image_ == b.image_ && a.planet_ == b.planet_;
	}

private:
	void sample_batch(const PositionBatch &batch, std::span<float> r_density) const;

	std::shared_ptr<const ImageMask> image_;
	Planet planet_;
};

} // namespace thicket
