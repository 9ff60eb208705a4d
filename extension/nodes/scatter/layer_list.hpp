#pragma once

#include "core/placement/layer_edits.hpp"
#include "core/placement/layer_links.hpp"
#include "nodes/layer/scatter_layer.hpp"
#include "nodes/region/region_register.hpp"
#include "nodes/scatter/layer_previews.hpp"
#include "nodes/scatter/node_layers.hpp"

#include <godot_cpp/variant/string.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace thicket {

/// The node's settings of the world that its layers belong to.
struct LayerWorld {
	std::uint64_t seed = 0;
	double water_level = no_water; ///< The node's water level, in world meters.
	godot::Ref<ScatterBiomeMap> biomes;
	RegionRegister &regions;
	const LayerPreviews &previews; ///< Layers that are displayed in place of others.
};

/// Creates snapshots of a node's layers, with their neighbors, shapes, biomes and water. When layers change, finds the
/// tiles that must be regenerated. Main thread only.
class LayerList {
public:
	/// Reads the current layers. Returns for each layer the area in which its tiles are outdated. `ground_change` is
	/// the area in which the ground has changed since the last update. If the settings of a layer are refused, prints
	/// one error. The layer, and its neighbors, then keep using its last valid settings.
	std::vector<EditedArea> update(const NodeLayers &layers, const LayerWorld &world, const EditedArea &ground_change);

	/// By index in the node's layers. A snapshot stays the same object until its layer changes.
	const std::vector<SharedSnapshot> &snapshots() const { return snapshots_; }

	/// Forgets everything, so that the next update treats all layers as new.
	void clear();

private:
	struct Entry {
		std::optional<LayerSnapshot> unlinked; ///< The last valid state, without neighbors; empty if there is no layer.
		godot::String complaint;               ///< The last printed error; empty if there is none.
	};

	Status read(Entry &r_entry, const godot::Ref<ScatterLayer> &p_layer, std::uint64_t seed, std::size_t index) const;
	void complain(std::size_t index, bool own, const Status &status);
	void add_world(std::size_t index, const NodeLayers &layers, const LayerWorld &world);
	void find_water(const LayerWorld &world);
	std::vector<LinkedLayer> link(const std::vector<std::size_t> &order) const;
	SharedSnapshot next(std::size_t index, const LinkedLayer &linked) const;
	SharedSnapshot before(std::size_t index) const { return index < snapshots_.size() ? snapshots_[index] : nullptr; }

	std::vector<Entry> entries_;
	std::vector<SharedSnapshot> snapshots_;
	std::shared_ptr<const WaterLevels> water_; ///< For all layers; null if there is no water.
};

} // namespace thicket
