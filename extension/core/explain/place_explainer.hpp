#pragma once

#include "core/explain/density_probe.hpp"
#include "core/rules/rule_factors.hpp"

#include <glm/vec2.hpp>

#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// The result of a layer's rules at one position.
struct RuledPlace {
	Ground ground;
	double density = 0.0;            ///< 0 to 1: the product of all factors.
	std::vector<RuleFactor> factors; ///< One for each rule that limits anything, in the order of evaluation.
};

/// The reasons why an instance of a layer is placed at a position, or is not.
struct PlaceExplanation {
	RuledPlace place;

	/// The point of the layer's set that is nearest to the position, in the plane. It is closer than the radius,
	/// because otherwise there would be room for one more point. An instance is placed there only if this point is
	/// kept.
	SamplePoint point{};
	double distance = 0.0; ///< Meters, in the plane.
	RuledPlace at_point;

	/// Whether an instance is allowed at the position itself.
	bool allowed() const { return place.density > 0.0; }

	/// True if the rules keep the point. The point is then an instance, unless a game has removed it.
	bool stands() const { return thicket::stands(point.rank, at_point.density); }
};

/// Explains positions with the same code that generates tiles. Two steps, as in DensityProbe.
class PlaceExplainer {
public:
	/// Refuses the positions that DensityProbe and TileSampler refuse: those that are not finite, or outside the set's
	/// cells.
	Status find(const LayerSettings &layer, glm::dvec2 place);

	std::span<const glm::dvec2> positions() const { return probe_.positions(); }
	std::span<const GroundQuery> queries() const { return probe_.queries(); }

	/// Call it after `find`, with the ground of all positions. After an error, `r_explanation` is valid but unspecified.
	Status explain(std::span<const Ground> ground, PlaceExplanation &r_explanation);

private:
	TileSampler sampler_;
	DensityProbe probe_;
	glm::dvec2 place_{0.0};
	std::vector<SamplePoint> point_; ///< The nearest point.
};

} // namespace thicket
