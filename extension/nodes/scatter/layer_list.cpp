#include "nodes/scatter/layer_list.hpp"

#include "nodes/common/property_check.hpp"

#include <godot_cpp/core/class_db.hpp>

#include <string>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Adds the shapes that count for a layer, which the layer itself does not know.
void set_shapes(LayerSnapshot &r_layer, const std::shared_ptr<const ShapeSet> &shapes) {
	if (r_layer.settings->rules.shapes != shapes) {
		const auto settings = std::make_shared<LayerSettings>(*r_layer.settings);
		settings->rules.shapes = shapes;
		r_layer.settings = settings;
	}
}

/// Where the tiles of a layer are not what they were, because it says something else or the ground has changed.
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

/// Why a layer takes more points than it may, though its own tiles are small enough: the property that looks too far.
const char *far_looking_property(const LayerSettings &layer, double tile_size) {
	LayerSettings plain = layer;
	plain.instance_data = {};
	if (points_to_sample(plain, tile_size) > ScatterLayer::max_tile_points) {
		return "spacing";
	}
	const auto [color, variation] = distance_sources(layer.instance_data);
	const bool by_color = color != nullptr && (variation == nullptr || color->max >= variation->max);
	return by_color ? "color_source_max" : "variation_source_max";
}

} // namespace

void LayerList::clear() {
	entries_.clear();
	snapshots_.clear();
}

void LayerList::complain(std::size_t index, const Status &status) {
	const std::string owner = "layers[" + std::to_string(index) + "]: ScatterLayer";
	const String complaint = status.ok() ? String() : sentence(owner.c_str(), status);
	if (!complaint.is_empty() && !(complaint == entries_[index].complaint)) {
		ERR_PRINT(complaint);
	}
	entries_[index].complaint = complaint;
}

/// Takes over what a layer says, if it may be used.
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

std::vector<LinkedLayer> LayerList::link() const {
	std::vector<UnlinkedLayer> layers;
	for (const Entry &entry : entries_) {
		layers.push_back(entry.unlinked ? UnlinkedLayer{entry.unlinked->settings.get(), &entry.unlinked->links}
										: UnlinkedLayer{});
	}
	std::vector<SharedLayer> before;
	for (const SharedSnapshot &layer : snapshots_) {
		before.push_back(layer != nullptr ? layer->settings : nullptr);
	}
	return link_layers(layers, before, [this](const LayerSettings &layer, std::size_t index) {
		const double tile_size = entries_[index].unlinked->range.tile_size;
		const double points = points_to_sample(layer, tile_size);
		return points > ScatterLayer::max_tile_points
				? Status{ErrorCode::too_many_points, far_looking_property(layer, tile_size), points}
				: Status{};
	});
}

/// What a layer says from now on, given what came of its names.
SharedSnapshot LayerList::next(std::size_t index, const LinkedLayer &linked) const {
	SharedSnapshot was = before(index);
	if (linked.settings == nullptr) {
		return nullptr;
	}
	if (!linked.status.ok()) {
		return was; // As a whole: its meshes belong to those settings.
	}
	LayerSnapshot now = *entries_[index].unlinked;
	now.settings = linked.settings;
	return was != nullptr && *was == now ? was : std::make_shared<const LayerSnapshot>(std::move(now));
}

std::vector<EditedArea> LayerList::update(const TypedArray<ScatterLayer> &p_layers, std::uint64_t seed,
		const EditedArea &ground_change, RegionRegister &regions) {
	const auto count = static_cast<std::size_t>(p_layers.size());
	entries_.resize(count);
	std::vector<Status> statuses;
	for (std::size_t index = 0; index < count; ++index) {
		const Ref<ScatterLayer> layer = p_layers[static_cast<int64_t>(index)];
		statuses.push_back(read(entries_[index], layer, seed, index));
		if (std::optional<LayerSnapshot> &unlinked = entries_[index].unlinked) {
			set_shapes(*unlinked, regions.set_for(p_layers, index));
		}
	}
	std::vector<EditedArea> areas;
	std::vector<SharedSnapshot> snapshots;
	EditSearch search; // Compares with settings of `snapshots_`, which have to live as long.
	const std::vector<LinkedLayer> linked = link();
	for (std::size_t index = 0; index < count; ++index) {
		complain(index, linked[index].status.ok() ? statuses[index] : linked[index].status);
		snapshots.push_back(next(index, linked[index]));
		areas.push_back(outdated_area(before(index), snapshots.back(), ground_change, search));
	}
	snapshots_ = std::move(snapshots);
	return areas;
}

} // namespace thicket
