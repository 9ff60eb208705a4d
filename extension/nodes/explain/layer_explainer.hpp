#pragma once

#include "core/explain/planet_samples.hpp"
#include "nodes/layer/layer_snapshot.hpp"
#include "nodes/explain/scatter_explanation.hpp"
#include "nodes/ground/scatter_ground.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace thicket {

/// A copy of the node's data that an explanation needs. The copy stays valid even if a script of
/// the ground changes or frees the node. Use it only on the main thread.
struct LayerExplainer {
	std::vector<SharedSnapshot> layers;
	/// The ground. Null if only the main thread may sample it.
	std::shared_ptr<const Terrain> terrain;
	HostedGround ground;
	std::vector<std::string> shape_names; ///< The names of the shapes of the layer to explain next.

	/// Explains the rules of a layer (by index) at a world position, and at the point of the layer
	/// that is nearest to the position. If PositionExplainer or the ground fails, returns its
	/// error. Throws std::bad_alloc.
	Status explain(std::uint32_t layer, const glm::dvec3 &position, LayerExplanation &r_explanation) const;

	/// Computes the density of a layer at world positions, 0 to 1. Replaces `r_densities`.
	Status densities(std::uint32_t layer, std::span<const glm::dvec2> positions, std::vector<float> &r_densities) const;

	// On a planet, these functions evaluate positions on the ground of any side. The density is 0, and the
	// slope is NAN, where there is no ground within a meter.

	/// Computes the density of a layer at positions in world space. Replaces `r_densities`.
	Status densities_at(
			std::uint32_t layer, std::span<const glm::dvec3> positions, std::vector<float> &r_densities) const;

	/// Computes the slope of the ground relative to the planet's up direction. Replaces `r_slopes`.
	Status slopes_at(const Planet &planet, std::span<const glm::dvec3> positions, std::vector<float> &r_slopes) const;

	/// Computes the slope of the ground at world positions, in degrees; NAN where there is no
	/// ground. Replaces `r_slopes`.
	Status slopes(std::span<const glm::dvec2> positions, std::vector<float> &r_slopes) const;

	/// Finds the rank, 0 to 1, of the layer's point nearest to each world position. Replaces
	/// `r_ranks`.
	Status ranks(std::uint32_t layer, std::span<const glm::dvec2> positions, std::vector<float> &r_ranks) const;

private:
	RuleNames names_for(const LayerSnapshot &layer) const;
	Status sample_densities(std::uint32_t layer, const PlanetSamples &samples, std::vector<float> &r_densities) const;
	Status find_models(
			const LayerSettings &layer, const glm::dvec3 &position, std::unique_ptr<const Surface> &r_models) const;
};

} // namespace thicket
