#pragma once

#include "core/base/planet.hpp"
#include "core/near/host_state.hpp"
#include "core/placement/layer_edits.hpp"
#include "core/placement/layer_links.hpp"
#include "core/terrain/ground_shell.hpp"
#include "nodes/gameplay/scatter_state.hpp"
#include "nodes/layer/scatter_layer.hpp"
#include "nodes/region/region_register.hpp"
#include "nodes/scatter/host_reader.hpp"
#include "nodes/scatter/layer_previews.hpp"
#include "nodes/scatter/node_layers.hpp"
#include "nodes/scatter/row_paths.hpp"

#include <godot_cpp/variant/string.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace thicket {

/// The areas in which a game has changed the instances of layers, keyed by the layer's index.
struct StateEdits {
	bool everywhere = false; ///< True if any instance may have changed.
	std::map<std::size_t, EditedArea> areas;
};

/// The settings of a node that affect all its layers.
struct LayerWorld {
	std::uint64_t seed = 0;
	double water_level = no_water; ///< The node's water level, in world meters.
	godot::Ref<ScatterBiomeMap> biomes;
	RegionRegister &regions;
	RowPaths &row_paths;
	const LayerPreviews &previews;  ///< The layers that the editor displays in place of others.
	Planet planet;                  ///< The planet that the ground forms, if any.
	GroundShell shell;              ///< Contains all ground around the planet's center.
	const StateEdits &state_edits;  ///< The changes to instances since the last update.
	godot::Ref<ScatterState> state; ///< The game's changes; null if there are none.
};

/// Creates snapshots of a node's layers, with their neighbors, shapes, biomes and water. Finds the
/// areas that must be regenerated when something changes. Use it only on the main thread.
class LayerList {
public:
	/// Reads the current layers and returns, for each layer, the area in which its tiles are
	/// outdated. `ground_change` is the area in which the ground has changed since the last update.
	/// If a layer has invalid settings, prints an error once and keeps its last valid settings.
	std::vector<EditedArea> update(const NodeLayers &layers, const LayerWorld &world, const EditedArea &ground_change);

	/// Returns the snapshots by layer index; null for an empty entry. A snapshot stays the same
	/// object until its layer changes.
	const std::vector<SharedSnapshot> &snapshots() const { return snapshots_; }

	/// These methods return true if other layers grow on the models of this layer, or of any layer.
	bool is_host(std::size_t index) const { return index < entries_.size() && entries_[index].host != nullptr; }
	bool has_hosts() const;

	/// Adds a message for each reason why nothing can grow on a host or one of its meshes.
	void add_host_problems(godot::PackedStringArray &r_problems) const;

	/// Adds a message for each layer whose rows have no paths.
	void add_row_problems(const RowPaths &paths, godot::PackedStringArray &r_problems) const;

	/// Discards everything, so that the next update treats all layers as new.
	void clear();

private:
	/// The data of a host, which is a layer on whose models other layers grow.
	struct Host {
		HostReader reader;
		std::uint16_t point_layer = 0;              ///< The PointSet::layer of `changes`.
		std::shared_ptr<const HostChanges> changes; ///< Null without a state.
	};

	struct Entry {
		/// The last valid snapshot, without links to neighbors. Empty if there is none.
		std::optional<LayerSnapshot> unlinked;
		godot::String complaint;    ///< The last printed error; empty after a success.
		std::shared_ptr<Host> host; ///< Null if no other layer grows on this layer.
	};

	Status read(Entry &r_entry, const godot::Ref<ScatterLayer> &p_layer, std::uint64_t seed, std::size_t index) const;
	void print_once(std::size_t index, bool is_own, const Status &status);
	Status add_rows(std::size_t index, const LayerWorld &world);
	void add_world(std::size_t index, const NodeLayers &layers, const LayerWorld &world);
	void find_water(const LayerWorld &world);
	void add_hosts(const NodeLayers &layers, const LayerWorld &world, std::vector<UnlinkedLayer> &r_layers);
	HostEdits host_edits(const StateEdits &edits) const;
	std::vector<LinkedLayer> link(const NodeLayers &node_layers, const LayerWorld &world);
	SharedSnapshot next_snapshot(std::size_t index, const LinkedLayer &linked) const;
	SharedSnapshot previous_snapshot(std::size_t index) const {
		return index < snapshots_.size() ? snapshots_[index] : nullptr;
	}

	std::vector<Entry> entries_;
	std::vector<SharedSnapshot> snapshots_;
	std::shared_ptr<const WaterLevels> water_; ///< Shared by all layers; null if there is no water.
};

} // namespace thicket
