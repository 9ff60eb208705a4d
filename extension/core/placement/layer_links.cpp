#include "core/placement/layer_links.hpp"

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

namespace thicket {

namespace {

using Links = std::span<const LayerLinks *const>;

/// Returns the index of the referenced layer, or the number of layers if it does not exist.
std::size_t find(Links layers, const LayerReference &reference) {
	const auto is_meant = [&reference](const LayerLinks *layer) {
		return layer != nullptr &&
				(reference.name.empty() ? reference.identity != 0 && layer->identity == reference.identity
										: layer->name == reference.name);
	};
	if (reference.name.empty() && reference.index >= 0) {
		const auto index = std::min(static_cast<std::size_t>(reference.index), layers.size());
		return index < layers.size() && layers[index] != nullptr ? index : layers.size();
	}
	return static_cast<std::size_t>(std::ranges::find_if(layers, is_meant) - layers.begin());
}

/// The references of a layer, resolved to indices.
struct ResolvedReferences {
	std::map<std::size_t, double> spacing;
	std::size_t proximity_layer = 0; ///< Index, or the number of layers if there is none.
	std::size_t color_layer = 0;     ///< Index of the color's layer, or the number of layers if there is none.
	std::size_t variation_layer = 0; ///< Index of the variation's layer, or the number of layers if there is none.
	std::size_t scale_layer = 0;     ///< Index of the scale's layer, or the number of layers if there is none.
	/// Indices of the surface layers. Contains the number of layers if a layer is unknown.
	std::set<std::size_t> hosts;
};

std::vector<ResolvedReferences> find_all(Links layers) {
	std::vector<ResolvedReferences> result;
	for (const LayerLinks *layer : layers) {
		ResolvedReferences &references = result.emplace_back();
		if (layer != nullptr) {
			references.proximity_layer = find(layers, layer->proximity_layer);
			references.color_layer = find(layers, layer->color_layer);
			references.variation_layer = find(layers, layer->variation_layer);
			references.scale_layer = find(layers, layer->scale_layer);
			for (const LayerReference &reference : layer->surface_layers) {
				references.hosts.insert(find(layers, reference));
			}
			for (const auto &[reference, distance] : layer->spacing) {
				double &meters = references.spacing[find(layers, reference)];
				meters = std::max(meters, distance);
			}
		}
	}
	return result;
}

double required_spacing(const ResolvedReferences &references, std::size_t other) {
	const auto entry = references.spacing.find(other);
	return entry != references.spacing.end() ? entry->second : 0.0;
}

/// Returns the neighbors of the layer at `index`, among the layers before it.
std::vector<Neighbor> neighbors(Links layers, std::span<const ResolvedReferences> references, std::size_t index,
		std::span<const LinkedLayer> earlier) {
	const LayerLinks &layer = *layers[index];
	std::vector<Neighbor> result;
	for (std::size_t i = 0; i < index; ++i) {
		if (earlier[i].settings == nullptr) {
			continue;
		}
		const double distance =
				std::max(required_spacing(references[index], i), required_spacing(references[i], index));
		if (distance > 0.0) {
			result.push_back({earlier[i].settings, distance, nullptr});
		}
		if (references[index].proximity_layer == i && layer.proximity_distance > 0.0 &&
				layer.proximity_curve != nullptr) {
			result.push_back({earlier[i].settings, layer.proximity_distance, layer.proximity_curve});
		}
	}
	return result;
}

/// Returns the layer at `index`, if it is already linked.
SharedLayer layer_at(std::span<const LinkedLayer> earlier, std::size_t index) {
	return index < earlier.size() ? earlier[index].settings : nullptr;
}

/// Returns the hosts of a layer: the surface layers that come before it and have models.
std::vector<HostLayer> hosts(std::span<const UnlinkedLayer> layers, const ResolvedReferences &references,
		std::span<const LinkedLayer> earlier) {
	std::vector<HostLayer> result;
	for (const std::size_t host : references.hosts) {
		if (SharedLayer settings = layer_at(earlier, host); settings != nullptr && layers[host].models != nullptr) {
			result.push_back({std::move(settings), layers[host].models, layers[host].changes});
		}
	}
	return result;
}

/// Returns the name that a warning uses for a referenced layer.
std::string quoted(const LayerReference &reference) {
	if (!reference.name.empty()) {
		return '"' + reference.name + '"';
	}
	return reference.index >= 0 ? "layer " + std::to_string(reference.index) : "a layer without a name";
}

/// Returns the part of a warning that explains a reference to an unknown layer. Users often try to
/// refer to layers of a different node.
std::string unknown_layer_note(const LayerReference &reference) {
	return std::string(reference.name.empty() ? ", which is not in the list of this node. "
											  : ", and no layer has that name in this node. ") +
			"Layers of different TerrainScatter3D nodes cannot refer to each other: move both layers into one node.";
}

/// Appends a warning if the layer at `index` cannot fill gaps around all layers from which it keeps
/// a distance.
void add_fill_problems(Links layers, std::size_t index, std::vector<std::string> &r_problems) {
	const LayerLinks &layer = *layers[index];
	if (!layer.spacing_fills) {
		return;
	}
	if (layer.on_surface) {
		r_problems.push_back("spacing_fills has no effect while on_surfaces is on: only layers that grow on the ground "
							 "as seen from above fill gaps. Disable one of them.");
		return;
	}
	const std::vector<ResolvedReferences> references = find_all(layers);
	bool has_spacing = false;
	for (std::size_t i = 0; i < index; ++i) {
		const double distance =
				std::max(required_spacing(references[index], i), required_spacing(references[i], index));
		if (layers[i] == nullptr || distance <= 0.0) {
			continue;
		}
		has_spacing = true;
		if (layers[i]->on_surface) {
			const std::string name =
					layers[i]->name.empty() ? "layer " + std::to_string(i) : '"' + layers[i]->name + '"';
			r_problems.push_back("spacing_fills has no effect around " + name +
					", which is on_surfaces: there, spacing only removes instances.");
		}
	}
	if (!has_spacing) {
		r_problems.push_back(
				"spacing_fills has no effect: there is no spacing between this layer and an earlier one in "
				"the list. Add an entry to spacing.");
	}
}

} // namespace

std::set<std::size_t> hosts_in(Links layers) {
	std::set<std::size_t> result;
	for (const ResolvedReferences &references : find_all(layers)) {
		result.insert(references.hosts.begin(), references.hosts.end());
	}
	result.erase(layers.size()); // The index of unknown layers.
	return result;
}

std::vector<LinkedLayer> link_layers(
		std::span<const UnlinkedLayer> layers, std::span<const SharedLayer> before, const LayerCheck &check) {
	std::vector<const LayerLinks *> links;
	for (const UnlinkedLayer &layer : layers) {
		links.push_back(layer.links);
	}
	const std::vector<ResolvedReferences> references = find_all(links);
	std::vector<LinkedLayer> result;
	for (std::size_t i = 0; i < layers.size(); ++i) {
		const SharedLayer previous = i < before.size() ? before[i] : nullptr;
		LinkedLayer &out = result.emplace_back();
		if (layers[i].settings == nullptr) {
			continue;
		}
		LayerSettings settings = *layers[i].settings;
		const std::span<const LinkedLayer> earlier = std::span(result).first(i);
		settings.neighbors = neighbors(links, references, i, earlier);
		settings.spacing_fills = links[i]->spacing_fills;
		settings.spacing_fills = fills(settings); // A switch without an effect regenerates nothing.
		settings.hosted = settings.set.on_surface && !links[i]->surface_layers.empty();
		settings.hosts = settings.hosted ? hosts(layers, references[i], earlier) : std::vector<HostLayer>();
		settings.instance_data.color.layer = layer_at(earlier, references[i].color_layer);
		settings.instance_data.variation.layer = layer_at(earlier, references[i].variation_layer);
		settings.instance_data.scale.layer = layer_at(earlier, references[i].scale_layer);
		for (WorldSource &source : settings.world_sources) {
			if (source.input.kind == WorldInputKind::distance) {
				source.layer = layer_at(earlier, find(links, LayerReference(source.input.name)));
			}
		}
		out.status = validate(settings);
		if (out.status.ok() && check) {
			out.status = check(settings, i);
		}
		if (!out.status.ok() || (previous != nullptr && *previous == settings)) {
			out.settings = previous;
		} else {
			out.settings = std::make_shared<const LayerSettings>(std::move(settings));
		}
	}
	return result;
}

std::string free_layer_name(std::string_view name, std::span<const std::string> taken_names) {
	std::string result(name);
	for (int number = 2; std::ranges::find(taken_names, result) != taken_names.end(); ++number) {
		result = std::string(name).append(" ").append(std::to_string(number));
	}
	return result;
}

std::vector<std::string> name_problems(Links layers, std::size_t index) {
	std::vector<std::string> problems;
	const LayerLinks &layer = *layers[index];
	for (const auto &[reference, distance] : layer.spacing) {
		const std::size_t other = find(layers, reference);
		// Other code warns about an empty name.
		if (!reference.empty() && other == layers.size()) {
			problems.push_back(("spacing refers to " + quoted(reference)).append(unknown_layer_note(reference)));
		} else if (other == index) {
			problems.push_back(
					"spacing refers to the layer itself, which has no effect. Set radius, and remove the entry.");
		}
	}
	const auto check_earlier = [&](const std::string &property, const LayerReference &reference) {
		const std::size_t other = find(layers, reference);
		const std::string start = property + " is " + quoted(reference);
		if (!reference.empty() && other == layers.size()) {
			problems.push_back(std::string(start).append(unknown_layer_note(reference)));
		} else if (!reference.empty() && other >= index) {
			problems.push_back(
					start + ", which is not before this layer in the list, so it has no effect. Move that layer up.");
		}
	};
	add_fill_problems(layers, index, problems);
	check_earlier("proximity_layer", layer.proximity_layer);
	check_earlier("color_value.layer", layer.color_layer);
	check_earlier("variation_value.layer", layer.variation_layer);
	check_earlier("scale_value.layer", layer.scale_layer);
	for (const std::string &name : layer.measured_layers) {
		check_earlier("distance() in an expression", name);
	}
	for (const LayerReference &reference : layer.surface_layers) {
		check_earlier("surface_layers", reference);
	}
	if (!layer.name.empty() && find(layers, layer.name) != index) {
		problems.push_back("has the name of an earlier layer, so \"" + layer.name +
				"\" refers to that layer. Rename one of them.");
	}
	return problems;
}

} // namespace thicket
