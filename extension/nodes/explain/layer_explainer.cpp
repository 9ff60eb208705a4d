#include "nodes/explain/layer_explainer.hpp"

#include "core/explain/density_probe.hpp"
#include "core/explain/model_probe.hpp"
#include "core/explain/position_grid.hpp"
#include "core/explain/point_probe.hpp"
#include "core/sampling/nearest_points.hpp"
#include "nodes/workers/build_at_once.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace thicket {

namespace {

std::string name_of(const LayerSnapshot &layer, std::size_t index) {
	return layer.links.name.empty() ? "layer " + std::to_string(index) : layer.links.name;
}

/// Returns the surface of a terrain. Returns null if there is no terrain, or if it has only
/// heights.
const Surface *surface_of(const Terrain *terrain) { return terrain != nullptr ? terrain->surface() : nullptr; }

} // namespace

RuleNames LayerExplainer::names_for(const LayerSnapshot &layer) const {
	RuleNames names{layer.field_names, {}, shape_names, layer.density_rule_names};
	for (const Neighbor &neighbor : layer.settings->neighbors) {
		const auto entry = std::ranges::find_if(layers, [&](const SharedSnapshot &other) {
			return other != nullptr && other->settings->set == neighbor.layer->set;
		});
		names.neighbors.push_back(
				entry == layers.end() ? "" : name_of(**entry, static_cast<std::size_t>(entry - layers.begin())));
	}
	return names;
}

/// Finds the models on which a layer grows around a position; see ModelProbe.
Status LayerExplainer::find_models(
		const LayerSettings &layer, const glm::dvec3 &position, std::unique_ptr<const Surface> &r_models) const {
	ModelProbe probe;
	std::vector<Ground> answers;
	Status status = probe.find(layer, position, surface_of(terrain.get()));
	if (status.ok()) {
		status = query_in_steps(terrain.get(), ground, probe, answers);
	}
	return status.ok() ? probe.models(answers, r_models) : status;
}

Status LayerExplainer::explain(std::uint32_t layer, const glm::dvec3 &position, LayerExplanation &r_explanation) const {
	const LayerSettings &settings = *layers[layer]->settings;
	PositionExplainer explainer;
	std::vector<Ground> answers;
	std::unique_ptr<const Surface> models;
	Status status = settings.hosted ? find_models(settings, position, models) : Status();
	if (status.ok()) {
		status = explainer.find(settings, position, surface_of(terrain.get()), models.get());
	}
	if (status.ok()) {
		status = query_in_steps(terrain.get(), ground, explainer, answers);
	}
	if (status.ok()) {
		status = explainer.explain(answers, r_explanation.rules);
	}
	if (!status.ok()) {
		return status;
	}
	const RuleNames names = names_for(*layers[layer]);
	for (const RuleFactor &factor : r_explanation.rules.at_position.factors) {
		r_explanation.messages.push_back(describe(factor, settings, names));
	}
	r_explanation.verdict = judge(r_explanation.rules, settings, names);
	r_explanation.is_placed = r_explanation.rules.is_placed();
	if (std::isfinite(r_explanation.rules.at_position.ground.height)) {
		r_explanation.position.y = double{r_explanation.rules.at_position.ground.height};
	}
	return {};
}

Status LayerExplainer::densities(
		std::uint32_t layer, std::span<const glm::dvec2> positions, std::vector<float> &r_densities) const {
	const Planet &planet = layers[layer]->settings->planet;
	if (const Surface *surface = surface_of(terrain.get()); planet.exists() && surface != nullptr) {
		PlanetSamples samples;
		samples.find_on_top(*surface, planet, positions);
		r_densities.assign(positions.size(), 0.0F);
		return sample_densities(layer, samples, r_densities);
	}
	DensityProbe probe;
	std::vector<Ground> answers;
	Status status = probe.find(*layers[layer]->settings, positions, false, surface_of(terrain.get()));
	if (status.ok()) {
		status = query_in_steps(terrain.get(), ground, probe, answers);
	}
	if (status.ok()) {
		status = probe.evaluate(answers);
	}
	r_densities.clear();
	for (std::size_t position = 0; status.ok() && position < positions.size(); ++position) {
		r_densities.push_back(static_cast<float>(probe.density_at(position)));
	}
	return status;
}

Status LayerExplainer::densities_at(
		std::uint32_t layer, std::span<const glm::dvec3> positions, std::vector<float> &r_densities) const {
	PlanetSamples samples;
	if (const Surface *surface = surface_of(terrain.get())) {
		samples.find_at(*surface, layers[layer]->settings->planet, positions);
	}
	r_densities.assign(positions.size(), 0.0F);
	return sample_densities(layer, samples, r_densities);
}

/// Writes the density at each sample to its index in `r_densities`.
Status LayerExplainer::sample_densities(
		std::uint32_t layer, const PlanetSamples &samples, std::vector<float> &r_densities) const {
	if (samples.positions.empty()) {
		return {};
	}
	DensityProbe probe;
	std::vector<Ground> answers;
	const LayerSettings &settings = *layers[layer]->settings;
	const Surface *surface = surface_of(terrain.get());
	// Layers that do not grow on surfaces are on the top, and layers on models are elsewhere.
	const bool grows_on_ground = settings.set.on_surface && !settings.hosted;
	const std::span<const Ground> surface_ground =
			grows_on_ground ? std::span<const Ground>(samples.ground) : std::span<const Ground>();
	Status status = probe.find(
			settings, samples.positions, false, surface, surface_ground, grows_on_ground ? surface : nullptr);
	if (status.ok()) {
		status = query_in_steps(terrain.get(), ground, probe, answers);
	}
	if (status.ok()) {
		status = probe.evaluate(answers);
	}
	for (std::size_t i = 0; status.ok() && i < samples.indices.size(); ++i) {
		r_densities[samples.indices[i]] = static_cast<float>(probe.density_at(i));
	}
	return status;
}

Status LayerExplainer::slopes_at(
		const Planet &planet, std::span<const glm::dvec3> positions, std::vector<float> &r_slopes) const {
	PlanetSamples samples;
	if (const Surface *surface = surface_of(terrain.get())) {
		samples.find_at(*surface, planet, positions);
	}
	r_slopes.assign(positions.size(), std::numeric_limits<float>::quiet_NaN());
	for (std::size_t i = 0; i < samples.indices.size(); ++i) {
		r_slopes[samples.indices[i]] = samples.slope(planet, i);
	}
	return {};
}

Status LayerExplainer::slopes(std::span<const glm::dvec2> positions, std::vector<float> &r_slopes) const {
	std::vector<Ground> answers;
	const std::array<GroundQuery, 1> query{{{0, positions.size(), {}}}};
	const Status status = query_synchronously(terrain.get(), ground, positions, query, answers);
	r_slopes.clear();
	for (std::size_t position = 0; status.ok() && position < positions.size(); ++position) {
		r_slopes.push_back(ground_slope(answers[position]));
	}
	return status;
}

Status LayerExplainer::ranks(
		std::uint32_t layer, std::span<const glm::dvec2> positions, std::vector<float> &r_ranks) const {
	const Rect area = enclosing_rect(positions);
	const PointSet &set = layers[layer]->settings->set;
	const glm::dvec2 sides = area.size() + 2.0 * set.radius;
	if (const double count = sides.x * sides.y * point_density(set); count > max_probed_points) {
		return Status::too_many_points("rect", count, max_probed_points);
	}
	PointProbe probe;
	std::vector<Ground> answers;
	Status status = probe.find(*layers[layer]->settings, positions);
	if (status.ok()) {
		status = query_in_steps(terrain.get(), ground, probe, answers);
	}
	r_ranks.clear();
	for (std::size_t position = 0; status.ok() && position < positions.size(); ++position) {
		r_ranks.push_back(static_cast<float>(probe.points()[position].rank * 0x1p-32));
	}
	return status;
}

} // namespace thicket
