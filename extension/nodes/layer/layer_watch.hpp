#pragma once

#include "nodes/layer/scatter_layer.hpp"

#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/variant/string.hpp>
#include <godot_cpp/variant/typed_array.hpp>

#include <cstddef>
#include <cstdint>
#include <set>
#include <vector>

namespace thicket {

/// The renaming of a layer. References to the old name must be changed to the new one.
struct LayerRename {
	godot::String from; ///< The old name. Empty if the layer had no name; references to it are then objects.
	godot::String to;
};

/// Detects changes to a node's list of layers. Scripts share the array with the node, so they can
/// add and remove layers without calling a setter. The node therefore checks the list every frame
/// and before it answers a query. Use it only on the main thread.
class LayerWatch {
public:
	/// Creates a watch for a node. `update` connects the methods `_mark_dirty` and
	/// `_mark_area_edited(rect)` of `node` to the signals of the layers.
	explicit LayerWatch(godot::Object *node) : node_(node) {}

	/// Returns true if the list has changed since the last call to `update`, or if a script has
	/// modified a layer's meshes in place.
	bool differs(const godot::TypedArray<ScatterLayer> &p_layers) const;

	/// Reads the list. Connects to new layers, disconnects from removed ones, and applies changes
	/// that scripts have made to the layers' meshes. Returns true if the list differs from the list
	/// of the last call.
	///
	/// Assigns an ID to each layer whose layer_id is -1, if the list has changed or `p_assign` is
	/// true. The ID is the layer's index if no other layer has that ID, otherwise the lowest unused
	/// ID. Biomes add and remove the layers from index `own_count` on. These get IDs that no layer
	/// has ever had, so that a layer that is added again still has a unique ID. A layer emits
	/// `changed` when it gets an ID.
	bool update(const godot::TypedArray<ScatterLayer> &p_layers, std::size_t own_count, bool p_assign);

	/// Returns the layers that were renamed since the last call, whose references must change.
	/// Skips a new name that is empty or that another layer has, because the user may still be
	/// typing it. Skips an old name that another layer has, because references then refer to that
	/// layer.
	std::vector<LayerRename> follow_names();

	/// Applies a change to the references of all layers in the list.
	void change_references(const ReferenceChange &change) const;

private:
	struct WatchedLayer {
		godot::Ref<ScatterLayer> layer; ///< The layer; null for an empty entry.
		godot::String name;             ///< The name that references use.
	};

	bool lists_differ(const godot::TypedArray<ScatterLayer> &p_layers) const;
	void take_mesh_changes() const;
	bool is_name_of_other(const godot::String &p_name, const WatchedLayer &layer) const;
	void listen(bool p_listen) const;
	void assign_ids(std::size_t own_count);

	godot::Object *node_;
	std::vector<WatchedLayer> watched_layers_;
	std::set<std::int64_t> ids_; ///< All IDs that any layer in the list has ever had.
	bool is_assigning_ids_ = false;
};

} // namespace thicket
