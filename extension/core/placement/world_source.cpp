#include "core/placement/world_source.hpp"

#include "core/placement/layer.hpp"

#include <algorithm>

namespace thicket {

namespace {

bool uses(const Rules &rules, const WorldInput &input) {
	return rules.expression != nullptr && std::ranges::count(rules.expression->world_inputs(), input) > 0;
}

} // namespace

std::vector<WorldSource> empty_sources(const LayerSettings &layer) {
	std::vector<WorldSource> sources;
	const auto add = [&sources](const Rules &rules) {
		if (rules.expression == nullptr) {
			return;
		}
		for (const WorldInput &input : rules.expression->world_inputs()) {
			if (source_of(sources, input) == sources.size()) {
				sources.push_back({.input = input});
			}
		}
	};
	add(layer.rules);
	for (const std::optional<Rules> &rules : layer.mesh_rules) {
		if (rules.has_value()) {
			add(*rules);
		}
	}
	return sources;
}

std::size_t source_of(std::span<const WorldSource> sources, const WorldInput &input) {
	return static_cast<std::size_t>(std::ranges::find(sources, input, &WorldSource::input) - sources.begin());
}

bool rules_use(const LayerSettings &layer, const WorldInput &input) { return uses(layer.rules, input); }

bool meshes_use(const LayerSettings &layer, const WorldInput &input) {
	return layer.mesh_weights.size() > 1 &&
			std::ranges::any_of(layer.mesh_rules,
					[&input](const std::optional<Rules> &rules) { return rules.has_value() && uses(*rules, input); });
}

} // namespace thicket
