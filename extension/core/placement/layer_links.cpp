#include "core/placement/layer_links.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace thicket {

namespace {

using Layers = std::span<const NamedLayer *const>;

/// The index of the first layer of a name, or the number of layers.
std::size_t find(Layers layers, const std::string &name) {
	const auto found = std::ranges::find_if(layers,
			[&name](const NamedLayer *layer) { return layer != nullptr && !name.empty() && layer->name == name; });
	return static_cast<std::size_t>(found - layers.begin());
}

double asked_spacing(const NamedLayer &asking, const NamedLayer &other) {
	const auto found = asking.spacing.find(other.name);
	return found != asking.spacing.end() ? found->second : 0.0;
}

LayerSettings linked(Layers layers, std::size_t index, std::span<const LinkedLayer> earlier) {
	const NamedLayer &layer = *layers[index];
	LayerSettings result = layer.settings;
	for (std::size_t i = 0; i < index; ++i) {
		// Of two layers of one name only the first can be spoken of; both can speak.
		if (layers[i] == nullptr || earlier[i].settings == nullptr) {
			continue;
		}
		const bool first_of_name = find(layers, layers[i]->name) == i;
		const double asked = first_of_name ? asked_spacing(layer, *layers[i]) : 0.0;
		const double given = find(layers, layer.name) == index ? asked_spacing(*layers[i], layer) : 0.0;
		if (std::max(asked, given) > 0.0) {
			result.neighbors.push_back({earlier[i].settings, std::max(asked, given), nullptr});
		}
		if (first_of_name && layer.proximity_layer == layers[i]->name && layer.proximity_distance > 0.0 &&
				layer.proximity_curve != nullptr) {
			result.neighbors.push_back({earlier[i].settings, layer.proximity_distance, layer.proximity_curve});
		}
	}
	return result;
}

} // namespace

std::vector<LinkedLayer> link_layers(Layers layers, std::span<const SharedLayer> before, const LayerCheck &check) {
	std::vector<LinkedLayer> result;
	for (std::size_t i = 0; i < layers.size(); ++i) {
		const SharedLayer was = i < before.size() ? before[i] : nullptr;
		LinkedLayer &out = result.emplace_back();
		if (layers[i] == nullptr) {
			continue;
		}
		LayerSettings settings = linked(layers, i, result);
		out.status = validate(settings);
		if (out.status.ok() && check) {
			out.status = check(settings, i);
		}
		if (!out.status.ok() || (was != nullptr && *was == settings)) {
			out.settings = was;
		} else {
			out.settings = std::make_shared<const LayerSettings>(std::move(settings));
		}
	}
	return result;
}

std::vector<std::string> name_problems(Layers layers, std::size_t index) {
	std::vector<std::string> problems;
	const NamedLayer &layer = *layers[index];
	for (const auto &[name, distance] : layer.spacing) {
		// That there is no name at all is told by the layer itself.
		if (!name.empty() && find(layers, name) == layers.size()) {
			problems.push_back("spacing names \"" + name + "\", and no layer has that name.");
		}
	}
	if (!layer.proximity_layer.empty()) {
		const std::size_t other = find(layers, layer.proximity_layer);
		if (other == layers.size()) {
			problems.push_back("proximity_layer is \"" + layer.proximity_layer + "\", and no layer has that name.");
		} else if (other >= index) {
			problems.push_back("proximity_layer is \"" + layer.proximity_layer +
					"\", which does not stand before this layer in the list: it has no effect.");
		}
	}
	if (!layer.name.empty() && find(layers, layer.name) != index) {
		problems.push_back("has the same name as another: \"" + layer.name + "\" means the first of them.");
	}
	return problems;
}

} // namespace thicket
