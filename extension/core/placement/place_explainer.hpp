#pragma once

#include "core/placement/density_probe.hpp"
#include "core/rules/rule_factors.hpp"

#include <glm/vec2.hpp>

#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// What the rules of a layer make of a place.
struct RuledPlace {
	Ground ground;
	double density = 0.0;            ///< 0 to 1: the product of all factors.
	std::vector<RuleFactor> factors; ///< Of all rules that limit anything, in the order in which they are asked.
};

/// Why something of a layer stands at a place, or does not.
struct PlaceExplanation {
	RuledPlace place;

	/// The point of the layer's set that is nearest to the place, in the plane: closer than the radius, or there would be room for another.
	/// Only if it stands, something does.
	SamplePoint point{};
	double distance = 0.0; ///< Meters, in the plane.
	RuledPlace at_point;

	/// Whether something may stand at the place itself.
	bool allowed() const { return place.density > 0.0; }

	/// Whether the point stands by the rules: it is an instance, unless a game has removed it.
	bool stands() const { return thicket::stands(point.rank, at_point.density); }
};

/// Explains places, by the code that makes tiles. Two steps, as DensityProbe.
class PlaceExplainer {
public:
	/// Refuses what DensityProbe and TileSampler refuse: a place that is not finite, or beyond the set's cells.
	Status find(const LayerSettings &layer, glm::dvec2 place);

	std::span<const glm::dvec2> positions() const { return probe_.positions(); }
	std::span<const GroundQuery> queries() const { return probe_.queries(); }

	/// After `find`, given the ground of all positions. After an error `r_explanation` is valid but unspecified.
	Status explain(std::span<const Ground> ground, PlaceExplanation &r_explanation);

private:
	TileSampler sampler_;
	DensityProbe probe_;
	glm::dvec2 place_{0.0};
	std::vector<SamplePoint> point_; ///< The nearest.
};

} // namespace thicket
