#include "nodes/scatter/layer_list.hpp"

#include "nodes/common/property_check.hpp"

#include <godot_cpp/core/class_db.hpp>

#include <string>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// The previous object, if it is equal.
template <class Values>
std::shared_ptr<const Values> kept(const std::shared_ptr<const Values> &before, Values now) {
	if (before != nullptr && *before == now) {
		// An unchanged object regenerates nothing.
		return before;
	}
	return std::make_shared<const Values>(std::move(now));
}

/// The area in which the tiles of a layer are outdated, because its settings or the ground have changed.
EditedArea outdated_area(const SharedSnapshot &before, const SharedSnapshot &now, const EditedArea &ground_change,
		EditSearch &r_search) {
	EditedArea area;
	if (before == nullptr || now == nullptr) {
		area.everywhere = before != now;
		return area;
	}
	area = r_search.find(*before->settings, *now->settings);
	area.everywhere = area.everywhere || !before->drawing.same_meshes(now->drawing) ||
			before->drawing.mesh_reach != now->drawing.mesh_reach;
	area.add(ground_change, reach(*now->settings));
	return area;
}

/// The property whose distance is too large, for a layer that needs too many points although its own tiles are small
/// enough.
const char *far_looking_property(const LayerSettings &layer, double tile_size) {
	LayerSettings plain = layer;
	plain.instance_data = {};
	if (points_to_sample(plain, tile_size) > ScatterLayer::max_tile_points) {
		return "spacing";
	}
	const auto [color, variation] = distance_sources(layer.instance_data);
	const bool by_color = color != nullptr && (variation == nullptr || color->max >= variation->max);
	return by_color ? "color_value.max_value" : "variation_value.max_value";
}

} // namespace

void LayerList::clear() {
	entries_.clear();
	snapshots_.clear();
	water_ = nullptr;
}

void LayerList::complain(std::size_t index, bool own, const Status &status) {
	const std::string place = std::to_string(index);
	const std::string owner = (own ? "layers[" + place + "]" : "get_all_layers()[" + place + "]") + ": ScatterLayer";
	const String complaint = status.ok() ? String() : sentence(owner.c_str(), status);
	if (!complaint.is_empty() && !(complaint == entries_[index].complaint)) {
		ERR_PRINT(complaint);
	}
	entries_[index].complaint = complaint;
}

/// Takes a snapshot of a layer, if it is valid.
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

/// Adds data that a layer itself does not have: the shapes and biomes that affect it, and the water.
void LayerList::add_world(std::size_t index, const NodeLayers &layers, const LayerWorld &world) {
	LayerSnapshot &layer = *entries_[index].unlinked;
	const SharedSnapshot was = before(index);
	const auto settings = std::make_shared<LayerSettings>(*layer.settings);
	Rules &rules = settings->rules;
	rules.shapes = world.regions.set_for(layers.by_index(), index);
	rules.water = water_;
	rules.biome = nullptr;
	if (index >= layers.own_count()) {
		const Ref<ScatterLayer> resource = layers.by_index()[static_cast<int64_t>(index)];
		rules.biome = kept(was != nullptr ? was->settings->rules.biome : nullptr,
				BiomeDensity(world.biomes->map(), world.biomes->densities_of(resource)));
	}
	layer.settings = settings;
}

/// If there are biomes, the water levels are always known, so that a change of one biome's water only affects that biome.
void LayerList::find_water(const LayerWorld &world) {
	if (world.biomes.is_valid()) {
		water_ = kept(water_, WaterLevels(world.biomes->map(), world.biomes->water_levels(world.water_level)));
	} else if (world.water_level > no_water) {
		water_ = kept(water_, WaterLevels(world.water_level));
	} else {
		water_ = nullptr;
	}
}

/// Later layers in `order` give way to earlier ones; the result is by index.
std::vector<LinkedLayer> LayerList::link(const std::vector<std::size_t> &order) const {
	std::vector<UnlinkedLayer> layers;
	std::vector<SharedLayer> before_all;
	for (const std::size_t index : order) {
		const Entry &entry = entries_[index];
		layers.push_back(entry.unlinked ? UnlinkedLayer{entry.unlinked->settings.get(), &entry.unlinked->links}
										: UnlinkedLayer{});
		const SharedSnapshot was = before(index);
		before_all.push_back(was != nullptr ? was->settings : nullptr);
	}
	const auto check = [this, &order](const LayerSettings &layer, std::size_t at) {
		const double tile_size = entries_[order[at]].unlinked->range.tile_size;
		const double points = points_to_sample(layer, tile_size);
		return points > ScatterLayer::max_tile_points
				? Status::too_many_points(far_looking_property(layer, tile_size), points, ScatterLayer::max_tile_points,
						  "Lower tile_size or this distance, or raise the radius")
				: Status{};
	};
	std::vector<LinkedLayer> linked = link_layers(layers, before_all, check);
	std::vector<LinkedLayer> result(entries_.size());
	for (std::size_t at = 0; at < order.size(); ++at) {
		result[order[at]] = std::move(linked[at]);
	}
	return result;
}

/// The new snapshot of a layer, with its resolved references.
SharedSnapshot LayerList::next(std::size_t index, const LinkedLayer &linked) const {
	SharedSnapshot was = before(index);
	if (linked.settings == nullptr) {
		return nullptr;
	}
	if (!linked.status.ok()) {
		return was; // The whole snapshot, because its meshes belong to those settings.
	}
	LayerSnapshot now = *entries_[index].unlinked;
	now.settings = linked.settings;
	return kept(was, std::move(now));
}

std::vector<EditedArea> LayerList::update(
		const NodeLayers &layers, const LayerWorld &world, const EditedArea &ground_change) {
	const auto count = static_cast<std::size_t>(layers.by_index().size());
	entries_.resize(count);
	find_water(world);
	std::vector<Status> statuses;
	for (std::size_t index = 0; index < count; ++index) {
		const Ref<ScatterLayer> layer = layers.by_index()[static_cast<int64_t>(index)];
		const Ref<ScatterLayer> shown = world.previews.shown(layer);
		statuses.push_back(read(entries_[index], shown, world.seed, index));
		if (std::optional<LayerSnapshot> &unlinked = entries_[index].unlinked) {
			if (shown != layer) {
				unlinked->links.identity = layer->get_instance_id(); // Other layers may refer to the object itself.
			}
			add_world(index, layers, world);
		}
	}
	std::vector<EditedArea> areas;
	std::vector<SharedSnapshot> snapshots;
	EditSearch search; // Compares with settings of `snapshots_`, which must live as long.
	const std::vector<LinkedLayer> linked = link(layers.order());
	for (std::size_t index = 0; index < count; ++index) {
		const bool own = index < layers.own_count();
		complain(index, own, linked[index].status.ok() ? statuses[index] : linked[index].status);
		snapshots.push_back(next(index, linked[index]));
		areas.push_back(outdated_area(before(index), snapshots.back(), ground_change, search));
	}
	snapshots_ = std::move(snapshots);
	return areas;
}

} // namespace thicket
