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

/// What a node says of the world in which its layers stand.
struct LayerWorld {
	std::uint64_t seed = 0;
	double water_level = no_water; ///< Of the node: world meters.
	godot::Ref<ScatterBiomeMap> biomes;
	RegionRegister &regions;
	const LayerPreviews &previews; ///< What is shown in place of layers.
};

/// Makes a node's layers into snapshots, with their neighbors, shapes, biomes and water, and finds out which tiles have to be made anew when
/// the layers change. Main thread only.
class LayerList {
public:
	/// Reads the layers as they are now. Returns for each where its tiles are outdated, given where the ground has changed since the
	/// last update. A layer whose settings are refused keeps its last good ones, for its neighbors too, and one error is printed.
	std::vector<EditedArea> update(const NodeLayers &layers, const LayerWorld &world, const EditedArea &ground_change);

	/// By index among the node's layers. The same object as before while the layer says the same.
	const std::vector<SharedSnapshot> &snapshots() const { return snapshots_; }

	/// Forgets everything: all of the next update is new.
	void clear();

private:
	struct Entry {
		std::optional<LayerSnapshot> unlinked; ///< In its last good state, without neighbors; none where no layer is.
		godot::String complaint;               ///< The error that was printed last; empty while all is well.
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
	std::shared_ptr<const WaterLevels> water_; ///< For all layers; null for none.
};

} // namespace thicket
