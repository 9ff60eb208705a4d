#include "core/placement/layer_edits.hpp"

#include "core/base/guard.hpp"
#include "core/placement/edge_probes.hpp"
#include "core/rows/row_edits.hpp"
#include "core/rules/shape_edits.hpp"
#include "core/sampling/obstacles.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace thicket {

namespace {

bool contains(const Rect &outer, const Rect &inner) {
	return outer.min.x <= inner.min.x && outer.min.y <= inner.min.y && inner.max.x <= outer.max.x &&
			inner.max.y <= outer.max.y;
}

/// Returns true if two layers have the same point set and rules, except for neighbors and for the
/// objects that are edited interactively.
bool same_rules(const LayerSettings &a, const LayerSettings &b) {
	const auto without_edits = [](const Rules &rules) {
		Rules result = rules;
		result.mask = nullptr;
		result.shapes = nullptr;
		result.biome = nullptr;
		result.water = nullptr;
		return result;
	};
	return a.set == b.set && a.spacing_fills == b.spacing_fills && a.planet == b.planet &&
			without_edits(a.rules) == without_edits(b.rules);
}

/// Returns true if two layers choose the meshes of their instances in the same way, as long as the
/// values of their world sources are equal.
bool same_meshes(const LayerSettings &a, const LayerSettings &b) {
	return a.mesh_weights == b.mesh_weights && a.mesh_rules == b.mesh_rules;
}

/// Returns the source of an input of another version of a layer; null if that version has none.
const WorldSource *find_source(const LayerSettings &layer, const WorldInput &input) {
	const std::size_t at = source_of(layer.world_sources, input);
	return at < layer.world_sources.size() ? &layer.world_sources[at] : nullptr;
}

/// Compares the world sources that `uses` selects, except for the layers to measure distances to.
/// Appends the areas of edits to biomes. Returns false if values may differ anywhere.
bool find_source_edits(const LayerSettings &before, const LayerSettings &after,
		bool (*uses)(const LayerSettings &, const WorldInput &), std::vector<Rect> &r_areas) {
	return std::ranges::all_of(after.world_sources, [&](const WorldSource &current) {
		const WorldSource *previous = find_source(before, current.input);
		return !uses(after, current.input) ||
				(previous != nullptr && previous->mask == current.mask &&
						(previous->layer == nullptr) == (current.layer == nullptr) &&
						find_biome_edits(after.planet, previous->biome.get(), current.biome.get(), r_areas));
	});
}

/// Returns true if the settings for the appearance of instances are equal, except for the layers of
/// their sources.
bool same_appearance(const LayerSettings &a, const LayerSettings &b) {
	const auto without_layers = [](const InstanceData &data) {
		InstanceData result = data;
		result.color.layer = nullptr;
		result.variation.layer = nullptr;
		result.scale.layer = nullptr;
		return result;
	};
	return a.placement == b.placement && without_layers(a.instance_data) == without_layers(b.instance_data) &&
			same_meshes(a, b);
}

/// Returns true if instances of both layers at the same point have the same model and transform,
/// unless the instances of the scale source's layer differ.
bool same_models(const LayerSettings &a, const LayerSettings &b) {
	std::vector<Rect> areas;
	const auto without_layer = [](ScaleSource source) {
		source.layer = nullptr;
		return source;
	};
	const ScaleSource &scale_a = a.instance_data.scale;
	const ScaleSource &scale_b = b.instance_data.scale;
	return a.placement == b.placement && same_meshes(a, b) && find_source_edits(a, b, meshes_use, areas) &&
			areas.empty() && scale_a.known() == scale_b.known() && without_layer(scale_a) == without_layer(scale_b);
}

bool find_mask_edits(
		const Planet &planet, const PaintedMask *before, const PaintedMask *after, std::vector<Rect> &r_areas) {
	if (before == after) {
		// Both layers have the same mask, so it has no edits.
		return true;
	}
	Rect area;
	if (before == nullptr || after == nullptr) {
		return false;
	}
	if (planet.exists()) {
		return after->find_edits_on(planet, *before, r_areas);
	}
	if (before->differs(*after, area)) {
		r_areas.push_back(area);
	}
	return area.empty() || area.finite();
}

/// Returns true if the rules depend on the water level.
bool uses_water_depth(const Rules &rules) {
	return rules.min_water_depth > -unlimited_height || rules.max_water_depth < unlimited_height ||
			(rules.expression != nullptr && rules.expression->uses(ExpressionInput::water_depth));
}

/// Returns true if a layer's instances or their meshes depend on the water level.
bool uses_water_depth(const LayerSettings &layer) {
	return uses_water_depth(layer.rules) ||
			std::ranges::any_of(layer.mesh_rules,
					[](const std::optional<Rules> &rules) { return rules.has_value() && uses_water_depth(*rules); });
}

/// Returns the area of edits to the layer's own rows, mask, shapes, biomes and water.
EditedArea own_edits(const LayerSettings &layer_before, const LayerSettings &layer_after) {
	const Rules &before = layer_before.rules;
	const Rules &after = layer_after.rules;
	const Planet &planet = layer_after.planet; // The planets are equal; see same_rules.
	std::vector<Rect> areas;
	EditedArea result;
	result.everywhere = !find_row_edits(layer_before.rows.get(), layer_after.rows.get(), areas) ||
			!find_shape_edits(before.shapes.get(), after.shapes.get(), areas) ||
			!find_mask_edits(planet, before.mask.get(), after.mask.get(), areas) ||
			!find_biome_edits(planet, before.biome.get(), after.biome.get(), areas) ||
			(uses_water_depth(layer_after) &&
					!find_biome_edits(planet, before.water.get(), after.water.get(), areas)) ||
			!find_source_edits(layer_before, layer_after, rules_use, areas);
	for (const Rect &area : areas) {
		result.add(area, edge_reach(after.edge_feather, layer_after.set.on_surface));
	}
	return result;
}

} // namespace

Rect grown(const Rect &area, double distance) {
	const double margin = distance > 0.0 ? 1.001 * distance + 1e-6 : 0.0;
	return expanded(area, margin);
}

bool EditedArea::touches(const Rect &rect) const {
	return everywhere || std::ranges::any_of(areas, [&rect](const Rect &area) { return meet(area, rect); });
}

void EditedArea::add(const Rect &area, double distance) {
	const Rect new_area = grown(area, distance);
	if (new_area.empty() ||
			std::ranges::any_of(areas, [&new_area](const Rect &other) { return contains(other, new_area); })) {
		return;
	}
	std::erase_if(areas, [&new_area](const Rect &other) { return contains(new_area, other); });
	areas.push_back(new_area);
}

void EditedArea::add(const EditedArea &other, double distance) {
	everywhere = everywhere || other.everywhere;
	for (const Rect &area : other.areas) {
		add(area, distance);
	}
}

const EditedArea &EditSearch::find(const LayerSettings &before, const LayerSettings &after) {
	static const EditedArea anywhere{.everywhere = true, .areas = {}};
	const EditedArea *found = &anywhere;
	const Status status = guarded("edits", 1.0, [&] { found = &find_edits(before, after); });
	return status.ok() ? *found : anywhere;
}

const EditedArea &EditSearch::find_edits(const LayerSettings &before, const LayerSettings &after) {
	const Pair pair{&before, &after};
	if (const auto known_area = found_.find(pair); known_area != found_.end()) {
		// Settings do not change during the search, so the cached result is valid.
		return known_area->second;
	}
	EditedArea area = find_standing(before, after);
	area.everywhere = area.everywhere || !same_appearance(before, after);
	const auto previous = distance_sources(before.instance_data);
	const auto current = distance_sources(after.instance_data);
	for (std::size_t i = 0; i < current.size() && !area.everywhere; ++i) {
		area.everywhere = (previous[i] == nullptr) != (current[i] == nullptr);
		if (!area.everywhere && current[i] != nullptr) {
			area.add(find_standing(*previous[i]->layer, *current[i]->layer), current[i]->max);
		}
	}
	if (!area.everywhere) {
		std::vector<Rect> areas;
		area.everywhere = !find_source_edits(before, after, meshes_use, areas);
		for (const Rect &rect : areas) {
			area.add(rect, 0.0);
		}
		add_measured_edits(before, after, meshes_use, 0.0, area);
	}
	return found_.emplace(pair, std::move(area)).first->second;
}

const EditedArea &EditSearch::find_standing(const LayerSettings &before, const LayerSettings &after) {
	const Pair pair{&before, &after};
	if (const auto known_area = present_areas_.find(pair); known_area != present_areas_.end()) {
		// The result is cached, as in find_edits.
		return known_area->second;
	}
	if (&before == &after) {
		// Both sides are the same layer, which has no edits.
		return present_areas_.emplace(pair, EditedArea()).first->second;
	}
	EditedArea area;
	area.everywhere = !same_rules(before, after) || before.neighbors.size() != after.neighbors.size();
	if (!area.everywhere) {
		area.add(own_edits(before, after));
		for (std::size_t i = 0; i < after.neighbors.size(); ++i) {
			const Neighbor &previous = before.neighbors[i];
			const Neighbor &current = after.neighbors[i];
			area.everywhere =
					area.everywhere || previous.distance != current.distance || previous.curve != current.curve;
			const double chain = fills_around(after, current) ? fill_distance(after.set, fill_chain_cells) : 0.0;
			area.add(find_standing(*previous.layer, *current.layer), current.distance + chain);
		}
		const double probes = edge_reach(after.rules.edge_feather, after.set.on_surface);
		add_measured_edits(before, after, rules_use, probes, area);
	}
	area.add(find_host_edits(before, after));
	return present_areas_.emplace(pair, std::move(area))
			.first->second; // The area is cached only now that it is complete.
}

/// Adds the area in which the distances to other layers may have changed that `uses` selects, grown by
/// `distance`.
void EditSearch::add_measured_edits(const LayerSettings &before, const LayerSettings &after,
		bool (*uses)(const LayerSettings &, const WorldInput &), double distance, EditedArea &r_area) {
	for (const WorldSource &current : after.world_sources) {
		if (!r_area.everywhere && current.layer != nullptr && uses(after, current.input)) {
			const WorldSource *previous = find_source(before, current.input);
			r_area.add(find_standing(*previous->layer, *current.layer), current.input.max_distance + distance);
		}
	}
}

/// Returns the area in which a layer's instances may have changed because its hosts have changed.
EditedArea EditSearch::find_host_edits(const LayerSettings &before, const LayerSettings &after) {
	EditedArea area;
	area.everywhere = before.hosted != after.hosted || before.hosts.size() != after.hosts.size();
	for (std::size_t i = 0; !area.everywhere && i < after.hosts.size(); ++i) {
		const HostLayer &previous = before.hosts[i];
		const HostLayer &current = after.hosts[i];
		const double distance = host_distance(after, std::max(widest_reach_of(previous), widest_reach_of(current)));
		area.everywhere = previous.models != current.models || !same_models(*previous.layer, *current.layer);
		area.add(find_standing(*previous.layer, *current.layer), distance);
		const ScaleSource &scale = current.layer->instance_data.scale;
		if (!area.everywhere && scale.kind == SourceKind::distance && scale.known()) {
			area.add(find_standing(*previous.layer->instance_data.scale.layer, *scale.layer), scale.max + distance);
		}
		if (!area.everywhere) {
			add_measured_edits(*previous.layer, *current.layer, meshes_use, distance, area);
		}
		const auto changes = host_edits_.find(current.layer->set.layer);
		if (changes != host_edits_.end()) {
			area.add(changes->second, distance);
		}
	}
	return area;
}

} // namespace thicket
