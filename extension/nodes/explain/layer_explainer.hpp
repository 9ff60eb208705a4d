#pragma once

#include "nodes/layer/layer_snapshot.hpp"
#include "nodes/explain/scatter_explanation.hpp"
#include "nodes/ground/scatter_ground.hpp"

#include <glm/vec2.hpp>

#include <memory>
#include <span>
#include <string>
#include <vector>

namespace thicket {

/// The data of a node that an explanation needs. Keeps it alive until the explanation is done, because a ground's
/// script may change or free the node. Main thread only.
struct LayerExplainer {
	std::vector<SharedSnapshot> layers;
	std::shared_ptr<const Terrain> terrain; ///< Null for ground that is sampled on the main thread only.
	HostedGround ground;
	std::vector<std::string> shapes; ///< The names of the shapes of the layer that is explained next.

	/// Explains the rules of the layer at an index for a world position, and for the point nearest to it. Returns the
	/// error of PlaceExplainer or of the ground, if either fails. Throws std::bad_alloc.
	Status explain(std::uint32_t layer, glm::dvec2 place, LayerExplanation &r_explanation) const;

	/// Computes the density of a layer at some positions, 0 to 1. Replaces `r_densities`.
	Status densities(std::uint32_t layer, std::span<const glm::dvec2> places, std::vector<float> &r_densities) const;

	/// Computes the slope of the ground at some positions, in degrees; NAN where there is no ground. Replaces
	/// `r_slopes`.
	Status slopes(std::span<const glm::dvec2> places, std::vector<float> &r_slopes) const;

	/// Finds the layer's point nearest to each position, and its rank, 0 to 1. Replaces `r_ranks`.
	Status ranks(std::uint32_t layer, std::span<const glm::dvec2> places, std::vector<float> &r_ranks) const;

private:
	RuleNames names_for(const LayerSnapshot &layer) const;
};

} // namespace thicket
