#include "nodes/scatter/layer_list.hpp"

#include "core/rules/image_mask.hpp"
#include "core/rules/planet_mask.hpp"
#include "nodes/common/property_check.hpp"

#include <godot_cpp/core/class_db.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

/// Returns `before` if it equals `after`, so that unchanged values stay the same object.
template <class Values>
std::shared_ptr<const Values> reuse_if_equal(const std::shared_ptr<const Values> &before, Values after) {
	if (before != nullptr && *before == after) {
		// Nothing has to be regenerated for the same object.
		return before;
	}
	return std::make_shared<const Values>(std::move(after));
}

/// Replaces images on a plane by images on the whole planet. Reuses the fields of `before`, the
/// layer's previous version, for the same image and planet; `before` may be null.
void use_planet_masks(const Planet &planet, const SharedSnapshot &before,
		std::vector<std::shared_ptr<const DensityField>> &r_fields) {
	for (std::shared_ptr<const DensityField> &field : r_fields) {
		const auto image = std::dynamic_pointer_cast<const ImageMask>(field);
		if (image == nullptr) {
			continue; // Noise is a density in space already.
		}
		std::shared_ptr<const PlanetMask> previous;
		for (std::size_t i = 0; before != nullptr && i < before->settings->rules.fields.size(); ++i) {
			if (auto mask = std::dynamic_pointer_cast<const PlanetMask>(before->settings->rules.fields[i])) {
				previous = std::move(mask);
			}
		}
		field = reuse_if_equal(previous, PlanetMask(image, planet));
	}
}

/// Returns the source of an input in the layer's previous version; null if there is none.
const WorldSource *former_source(const SharedSnapshot &before, const WorldInput &input) {
	if (before == nullptr) {
		return nullptr;
	}
	const std::vector<WorldSource> &sources = before->settings->world_sources;
	const std::size_t index = source_of(sources, input);
	return index < sources.size() ? &sources[index] : nullptr;
}

/// Adds the weights of biomes to the sources of expressions.
void add_biomes_to_sources(
		const SharedSnapshot &before, const Ref<ScatterBiomeMap> &p_biomes, std::vector<WorldSource> &r_sources) {
	for (WorldSource &source : r_sources) {
		if (source.input.kind == WorldInputKind::biome && p_biomes.is_valid()) {
			const WorldSource *previous = former_source(before, source.input);
			source.biome = reuse_if_equal(previous != nullptr ? previous->biome : nullptr,
					BiomeDensity(p_biomes->map(), p_biomes->weights_for(source.input)));
		}
	}
}

/// Replaces the masks of expressions on a plane by masks on the whole planet, like use_planet_masks.
void use_planet_sources(const Planet &planet, const SharedSnapshot &before, std::vector<WorldSource> &r_sources) {
	for (WorldSource &source : r_sources) {
		if (const auto image = std::dynamic_pointer_cast<const ImageMask>(source.mask)) {
			const WorldSource *previous = former_source(before, source.input);
			source.mask = reuse_if_equal(
					previous != nullptr ? std::dynamic_pointer_cast<const PlanetMask>(previous->mask) : nullptr,
					PlanetMask(image, planet));
		}
	}
}

/// Returns the area in which a layer's tiles are outdated after a change to its settings or the
/// ground.
EditedArea outdated_area(const SharedSnapshot &before, const SharedSnapshot &after, const EditedArea &ground_change,
		EditSearch &r_search) {
	EditedArea area;
	if (before == nullptr || after == nullptr) {
		area.everywhere = before != after;
		return area;
	}
	area = r_search.find(*before->settings, *after->settings);
	area.everywhere = area.everywhere || !before->drawing.same_meshes(after->drawing) ||
			before->drawing.mesh_reach != after->drawing.mesh_reach;
	area.add(ground_change, reach(*after->settings));
	return area;
}

/// Names the property whose distance is too large. Call it for a layer that exceeds the limit only
/// because of the points of other layers around a tile.
const char *property_to_lower(const LayerSettings &layer, double tile_size) {
	LayerSettings reduced = layer;
	reduced.world_sources.clear();
	if (points_to_sample(reduced, tile_size) <= ScatterLayer::max_tile_points) {
		const bool in_rules = std::ranges::any_of(
				layer.world_sources, [&layer](const WorldSource &source) { return rules_use(layer, source.input); });
		return in_rules ? "density_expression" : "mesh_density_expressions";
	}
	reduced.instance_data = {};
	if (points_to_sample(reduced, tile_size) > ScatterLayer::max_tile_points) {
		reduced.spacing_fills = false;
		return points_to_sample(reduced, tile_size) > ScatterLayer::max_tile_points ? "spacing" : "spacing_fills";
	}
	constexpr std::array names{"scale_value.max_value", "color_value.max_value", "variation_value.max_value"};
	const auto sources = distance_sources(layer.instance_data);
	const auto distance = [](const InstanceSource *source) {
		return source != nullptr ? source->max : 0.0;
	};
	return names[static_cast<std::size_t>(std::ranges::max_element(sources, {}, distance) - sources.begin())];
}

} // namespace

void LayerList::clear() {
	entries_.clear();
	snapshots_.clear();
	water_ = nullptr;
}

void LayerList::print_once(std::size_t index, bool is_own, const Status &status) {
	const std::string index_text = std::to_string(index);
	const std::string owner =
			(is_own ? "layers[" + index_text + "]" : "get_all_layers()[" + index_text + "]") + ": ScatterLayer";
	const String complaint = status.ok() ? String() : sentence(owner.c_str(), status);
	if (!complaint.is_empty() && !(complaint == entries_[index].complaint)) {
		ERR_PRINT(complaint);
	}
	entries_[index].complaint = complaint;
}

/// Takes a snapshot of a layer if its settings are valid.
Status LayerList::read(Entry &r_entry, const Ref<ScatterLayer> &p_layer, std::uint64_t seed, std::size_t index) const {
	if (p_layer.is_null()) {
		r_entry = {};
		return {};
	}
	const Status status = p_layer->check();
	if (status.ok()) {
		r_entry.unlinked = p_layer->snapshot(seed, index);
	}
	return status;
}

/// Adds the rows along the scene's paths. After an error, the layer keeps the previous rows.
Status LayerList::add_rows(std::size_t index, const LayerWorld &world) {
	LayerSnapshot &layer = *entries_[index].unlinked;
	if (!layer.rows) {
		return {};
	}
	const SharedSnapshot previous = previous_snapshot(index);
	const auto settings = std::make_shared<LayerSettings>(*layer.settings);
	settings->rows = previous != nullptr ? previous->settings->rows : nullptr;
	const Status status = world.row_paths.rows_for(layer.rows->group, layer.rows->settings, settings->rows);
	layer.settings = settings;
	return status;
}

/// Adds the data that does not come from the layer: shapes, biomes, water and the planet.
void LayerList::add_world(std::size_t index, const NodeLayers &layers, const LayerWorld &world) {
	LayerSnapshot &layer = *entries_[index].unlinked;
	const SharedSnapshot previous = previous_snapshot(index);
	const auto settings = std::make_shared<LayerSettings>(*layer.settings);
	Rules &rules = settings->rules;
	rules.shapes = world.regions.set_for(layers.by_index(), index);
	rules.water = water_;
	rules.biome = nullptr;
	if (index >= layers.own_count()) {
		const Ref<ScatterLayer> resource = layers.by_index()[static_cast<int64_t>(index)];
		rules.biome = reuse_if_equal(previous != nullptr ? previous->settings->rules.biome : nullptr,
				BiomeDensity(world.biomes->map(), world.biomes->densities_of(resource)));
	}
	add_biomes_to_sources(previous, world.biomes, settings->world_sources);
	if (settings->set.on_surface && world.planet.exists()) {
		settings->planet = world.planet;
		use_planet_masks(world.planet, previous, rules.fields);
		use_planet_sources(world.planet, previous, settings->world_sources);
		settings->set.faces = permitted_faces(*settings);
		layer.range.bottom = world.planet.bottom();
		layer.range.top = world.planet.top();
		layer.range.center = world.planet.center;
		// The models of other layers may extend beyond the ground.
		const GroundShell shell = layer.links.surface_layers.empty() ? world.shell : GroundShell::everywhere();
		layer.range.nearest = shell.nearest;
		layer.range.farthest = shell.farthest;
		layer.range.view_distance =
				std::min(layer.range.view_distance, layer.range.view_tile_limit() * layer.range.tile_size);
		layer.lod.sight_end = layer.range.view_distance;
		layer.lod.in_space = true;
	}
	layer.settings = settings;
}

/// Creates the water levels. With biomes, creates them even if there is no water. A later change to
/// one biome's water then affects only the area of that biome.
void LayerList::find_water(const LayerWorld &world) {
	if (world.biomes.is_valid()) {
		water_ =
				reuse_if_equal(water_, WaterLevels(world.biomes->map(), world.biomes->water_levels(world.water_level)));
	} else if (world.water_level > no_water) {
		water_ = reuse_if_equal(water_, WaterLevels(world.water_level));
	} else {
		water_ = nullptr;
	}
}

bool LayerList::has_hosts() const {
	return std::ranges::any_of(entries_, [](const Entry &entry) { return entry.host != nullptr; });
}

/// Adds the models and the game's changes of all hosts. `r_layers` is in the order of priority.
void LayerList::add_hosts(const NodeLayers &layers, const LayerWorld &world, std::vector<UnlinkedLayer> &r_layers) {
	std::vector<const LayerLinks *> links;
	for (const UnlinkedLayer &layer : r_layers) {
		links.push_back(layer.links);
	}
	const std::set<std::size_t> hosts = hosts_in(links);
	std::shared_ptr<const SharedState> state;
	for (std::size_t priority = 0; priority < r_layers.size(); ++priority) {
		const std::size_t index = layers.order()[priority];
		Entry &entry = entries_[index];
		if (!hosts.contains(priority)) {
			entry.host = nullptr;
			continue;
		}
		const std::uint16_t point_layer = entry.unlinked->settings->set.layer;
		const bool is_new = entry.host == nullptr || entry.host->point_layer != point_layer;
		if (is_new) {
			entry.host = std::make_shared<Host>();
			entry.host->point_layer = point_layer;
		}
		Host &host = *entry.host;
		if (is_new || world.state_edits.everywhere || world.state_edits.areas.contains(index)) {
			if (state == nullptr && world.state.is_valid()) {
				state = std::make_shared<const SharedState>(world.state->share());
			}
			host.changes = state != nullptr ? std::make_shared<const HostState>(state, point_layer) : nullptr;
		}
		const Ref<ScatterLayer> displayed_layer =
				world.previews.displayed_layer(layers.by_index()[static_cast<int64_t>(index)]);
		r_layers[priority].models = host.reader.read(entry.unlinked->drawing, displayed_layer->mesh_version());
		r_layers[priority].changes = host.changes;
	}
}

/// Returns the changed areas of hosts, keyed by PointSet::layer instead of by index.
HostEdits LayerList::host_edits(const StateEdits &edits) const {
	HostEdits result;
	for (std::size_t index = 0; index < entries_.size(); ++index) {
		const auto edit = edits.areas.find(index);
		const bool is_edited = edits.everywhere || edit != edits.areas.end();
		if (is_host(index) && is_edited) {
			EditedArea area = edit != edits.areas.end() ? edit->second : EditedArea();
			area.everywhere = area.everywhere || edits.everywhere;
			result.emplace(entries_[index].unlinked->settings->set.layer, std::move(area));
		}
	}
	return result;
}

void LayerList::add_host_problems(PackedStringArray &r_problems) const {
	for (std::size_t index = 0; index < entries_.size(); ++index) {
		if (is_host(index)) {
			for (const String &problem : entries_[index].host->reader.problems()) {
				r_problems.push_back("Layer " + String::num_int64(static_cast<int64_t>(index)) + ": " + problem);
			}
		}
	}
}

void LayerList::add_row_problems(const RowPaths &paths, PackedStringArray &r_problems) const {
	for (std::size_t index = 0; index < entries_.size(); ++index) {
		const std::optional<LayerSnapshot> &layer = entries_[index].unlinked;
		if (layer && layer->rows && !layer->rows->group.empty() && paths.path_count(layer->rows->group) == 0) {
			r_problems.push_back(vformat("Layer %d: nothing is placed: the group \"%s\" of ScatterRows.path_group "
										 "contains no Path3D. Add paths to the group.",
					static_cast<int64_t>(index), String::utf8(layer->rows->group.c_str())));
		}
	}
}

/// Resolves the layers' references to each other. Earlier layers in `order` take priority over
/// later ones. The result is by index.
std::vector<LinkedLayer> LayerList::link(const NodeLayers &node_layers, const LayerWorld &world) {
	const std::vector<std::size_t> &order = node_layers.order();
	std::vector<UnlinkedLayer> layers;
	std::vector<SharedLayer> previous_settings;
	for (const std::size_t index : order) {
		const Entry &entry = entries_[index];
		layers.push_back(entry.unlinked ? UnlinkedLayer{entry.unlinked->settings.get(), &entry.unlinked->links}
										: UnlinkedLayer{});
		const SharedSnapshot previous = previous_snapshot(index);
		previous_settings.push_back(previous != nullptr ? previous->settings : nullptr);
	}
	const auto check = [this, &order](const LayerSettings &layer, std::size_t priority) {
		const double tile_size = entries_[order[priority]].unlinked->range.tile_size;
		const double points = points_to_sample(layer, tile_size);
		return points > ScatterLayer::max_tile_points
				? Status::too_many_points(property_to_lower(layer, tile_size), points, ScatterLayer::max_tile_points,
						  "Lower tile_size or this distance, raise the radius, or turn off spacing_fills")
				: Status{};
	};
	add_hosts(node_layers, world, layers);
	std::vector<LinkedLayer> linked = link_layers(layers, previous_settings, check);
	std::vector<LinkedLayer> result(entries_.size());
	for (std::size_t priority = 0; priority < order.size(); ++priority) {
		result[order[priority]] = std::move(linked[priority]);
	}
	return result;
}

/// Returns the new snapshot of a layer with resolved references, or the last valid one.
SharedSnapshot LayerList::next_snapshot(std::size_t index, const LinkedLayer &linked) const {
	SharedSnapshot previous = previous_snapshot(index);
	if (linked.settings == nullptr) {
		return nullptr;
	}
	if (!linked.status.ok()) {
		return previous; // Keep the whole snapshot, because the meshes belong to its settings.
	}
	LayerSnapshot result = *entries_[index].unlinked;
	result.settings = linked.settings;
	return reuse_if_equal(previous, std::move(result));
}

std::vector<EditedArea> LayerList::update(
		const NodeLayers &layers, const LayerWorld &world, const EditedArea &ground_change) {
	const auto count = static_cast<std::size_t>(layers.by_index().size());
	entries_.resize(count);
	find_water(world);
	std::vector<Status> statuses;
	for (std::size_t index = 0; index < count; ++index) {
		const Ref<ScatterLayer> layer = layers.by_index()[static_cast<int64_t>(index)];
		const Ref<ScatterLayer> displayed_layer = world.previews.displayed_layer(layer);
		statuses.push_back(read(entries_[index], displayed_layer, world.seed, index));
		if (std::optional<LayerSnapshot> &unlinked = entries_[index].unlinked) {
			if (displayed_layer != layer) {
				// References to a layer without a name use this ID.
				unlinked->links.identity = layer->get_instance_id();
			}
			if (const Status status = add_rows(index, world); statuses.back().ok()) {
				statuses.back() = status;
			}
			add_world(index, layers, world);
		}
	}
	std::vector<EditedArea> areas;
	std::vector<SharedSnapshot> snapshots;
	const std::vector<LinkedLayer> linked = link(layers, world);
	EditSearch search(host_edits(world.state_edits)); // Refers to settings in `snapshots_`.
	for (std::size_t index = 0; index < count; ++index) {
		const bool is_own = index < layers.own_count();
		print_once(index, is_own, linked[index].status.ok() ? statuses[index] : linked[index].status);
		snapshots.push_back(next_snapshot(index, linked[index]));
		areas.push_back(outdated_area(previous_snapshot(index), snapshots.back(), ground_change, search));
	}
	snapshots_ = std::move(snapshots);
	return areas;
}

} // namespace thicket
