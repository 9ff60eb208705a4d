#include "core/rules/density_rule_query.hpp"

#include "core/base/trigonometry.hpp"
#include "core/rules/density_field.hpp"
#include "core/terrain/planet_ground.hpp"

#include <algorithm>
#include <cstddef>

namespace thicket {

namespace {

/// The positions that have ground, in the form that rules require.
struct OnGround {
	std::vector<std::size_t> indices;
	std::vector<glm::dvec3> positions;
	std::vector<glm::vec3> normals;
	std::vector<float> slopes;
	std::vector<float> weights;
	Box3 bounds = no_box;

	OnGround(const DensityRuleQuery &query, std::span<const glm::dvec2> all, std::span<const Ground> ground) {
		for (std::size_t i = 0; i < all.size(); ++i) {
			const Ground in_frame = query.planet.exists() ? on_planet(query.planet, all[i], ground[i]) : ground[i];
			if (!is_ground(in_frame, query.sides)) {
				continue;
			}
			indices.push_back(i);
			positions.emplace_back(all[i].x, double{ground[i].height}, all[i].y);
			normals.push_back(ground[i].normal);
			slopes.push_back(static_cast<float>(slope_degrees(in_frame.normal)));
			weights.push_back(ground[i].weight);
			bounds = with(bounds, positions.back());
		}
	}

	/// Writes the densities of a rule at all positions to `r_densities`.
	Status evaluate(const DensityRule &rule, std::span<float> r_densities) const {
		bool is_closed = false;
		Status status = rule.find_closed(bounds, is_closed);
		if (status.ok() && !is_closed) {
			status = rule.sample({positions, normals, slopes, weights}, r_densities);
		}
		if (is_closed || !status.ok()) {
			std::ranges::fill(r_densities, 0.0f);
		}
		for (float &density : r_densities) {
			density = static_cast<float>(unit_density(density));
		}
		return status;
	}
};

} // namespace

Status DensityRuleQuery::query(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const {
	if (rules.empty()) {
		return {};
	}
	const OnGround found(*this, positions, r_ground);
	if (found.indices.empty()) {
		return {};
	}
	for (const std::size_t index : found.indices) {
		r_ground[index].density = 1.0f;
	}
	std::vector<float> densities(found.indices.size());
	for (const SharedDensityRule &rule : rules) {
		if (const Status status = found.evaluate(*rule, densities); !status.ok()) {
			return status;
		}
		for (std::size_t i = 0; i < densities.size(); ++i) {
			r_ground[found.indices[i]].density *= densities[i];
		}
	}
	return {};
}

Status DensityRuleQuery::find_each(glm::dvec2 position, const Ground &ground, std::vector<float> &r_densities) const {
	r_densities.clear();
	const OnGround found(*this, {&position, 1}, {&ground, 1});
	if (found.indices.empty()) {
		return {};
	}
	for (const SharedDensityRule &rule : rules) {
		float density = 0.0f;
		if (const Status status = found.evaluate(*rule, {&density, 1}); !status.ok()) {
			return status;
		}
		r_densities.push_back(density);
	}
	return {};
}

} // namespace thicket
