#include "core/rules/rule_factors.hpp"

#include "core/base/floating_point.hpp"

#include <algorithm>

namespace thicket {

double product_of(std::span<const RuleFactor> factors) {
	// Tiles compute the products of position rules and ground rules separately. The factors are
	// multiplied in that order here, too, because rounding depends on it.
	double of_position = 1.0;
	double of_ground = 1.0;
	float of_density_rules = 1.0f; // Ground::density is a float.
	for (const RuleFactor &factor : factors) {
		if (factor.rule == RuleKind::density_rule) {
			of_density_rules *= static_cast<float>(factor.density);
		} else if (factor.rule < RuleKind::ground) {
			of_position *= factor.density;
		} else if (factor.rule < RuleKind::shapes) {
			of_ground *= factor.density;
		}
	}
	of_ground *= double{of_density_rules};
	double density = of_position * of_ground;
	for (const RuleFactor &factor : factors) {
		if (factor.rule >= RuleKind::shapes) {
			density *= factor.density;
		}
	}
	return density;
}

const RuleFactor *strictest(std::span<const RuleFactor> factors) {
	const auto found = std::ranges::min_element(factors, {}, &RuleFactor::density);
	return found != factors.end() && found->density < 1.0 ? &*found : nullptr;
}

} // namespace thicket
