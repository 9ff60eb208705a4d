#pragma once

#include "core/explain/density_probe.hpp"
#include "core/explain/point_probe.hpp"
#include "core/placement/mesh_rules.hpp"
#include "core/rules/rule_factors.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// The results of a layer's rules at one position.
struct RuleResult {
	Ground ground;
	double density = 0.0; ///< The product of all factors, 0 to 1.
	/// The factors of all rules with an effect, in the order of evaluation.
	std::vector<RuleFactor> factors;
};

/// The reasons why a layer has or does not have an instance at a position.
struct PositionExplanation {
	RuleResult at_position;

	/// The point of the layer's set that is nearest to the position: in the plane, or in space for
	/// a layer on surfaces. It is always closer than the set's radius. An instance can be placed
	/// here only if the rules keep this point.
	SamplePoint point{};
	double distance = 0.0; ///< Distance from the position to the point, in meters.
	RuleResult at_point;
	/// False if there is no point within the radius, because the layer fills gaps and the position
	/// is too near to a neighbor's instance. `point` is then the position itself, with the id of its
	/// cell.
	bool has_point = true;
	/// The share of each mesh of the layer in the choice for an instance at the point.
	std::vector<MeshShare> meshes;
	std::size_t mesh = 0; ///< Index of the mesh that an instance at the point gets.

	/// Returns true if the rules allow an instance at the position itself.
	bool is_allowed() const { return at_position.density > 0.0; }

	/// Returns true if the rules keep the point. The point is then an instance, unless a game has
	/// removed it.
	bool is_placed() const { return has_point && thicket::is_placed(point.rank, at_point.density); }
};

/// Explains the results of a layer's rules at a position, with the same code that generates tiles.
/// The work has two steps, as for DensityProbe.
class PositionExplainer {
public:
	/// Prepares the explanation of a position in world meters, on the top of the ground. If the
	/// layer is on surfaces, explains the position on `surface` that is nearest to `position`
	/// instead. That position must not be farther from `position` than the set's radius. Positions
	/// that are not finite or outside the set's cells return an error, as do the layers that
	/// DensityProbe rejects. If the layer is hosted, the position is explained on `models`, the
	/// result of ModelProbe, instead of `surface`. A layer on surfaces whose surface is null
	/// returns an error.
	Status find(const LayerSettings &layer, const glm::dvec3 &position, const Surface *surface = nullptr,
			const Surface *models = nullptr);

	/// These functions continue `find` with the ground at positions(); see
	/// TileBuilder::find_further.
	bool is_complete() const { return points_.is_complete() && probe_.is_complete(); }
	Status find_further(std::span<const Ground> ground);

	std::span<const glm::dvec2> positions() const {
		return points_.is_complete() ? probe_.positions() : points_.positions();
	}
	std::span<const GroundQuery> queries() const {
		return points_.is_complete() ? probe_.queries() : points_.queries();
	}

	/// Completes the explanation. Call this function after `find`, with the ground at all
	/// positions. After an error, the content of `r_explanation` is unspecified.
	Status explain(std::span<const Ground> ground, PositionExplanation &r_explanation);

private:
	Status find_on_top(const LayerSettings &layer, glm::dvec2 position, const Surface *surface);
	Status find_on_surface(const LayerSettings &layer, const glm::dvec3 &position, const Surface &host_surface,
			const Surface *ground_surface);

	Status probe_on_top(const LayerSettings &layer);
	Status explain_mesh(PositionExplanation &r_explanation) const;

	MeshRules mesh_rules_;
	PointProbe points_;
	LayerSettings layer_; ///< The layer to explain on the top of the ground.
	glm::dvec2 position_{0.0};
	const Surface *surface_ = nullptr;
	bool has_point_ = true;
	DensityProbe probe_;
	double distance_ = 0.0;
	SamplePoint point_{}; ///< The nearest point.
};

} // namespace thicket
