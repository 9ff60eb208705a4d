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

/// A layer was renamed: references to the old name now mean the new one.
struct LayerRename {
	godot::String from; ///< Empty if the layer had no name: other layers then stored the object.
	godot::String to;
};

/// The last seen state of a node's list of layers. Scripts share the list's array with the node, so layers can be added and removed without
/// a call of a setter. Therefore the node checks the list in every frame and before it answers a query. Main thread only.
class LayerWatch {
public:
	/// `node` has the methods `_mark_dirty` and `_mark_area_edited(rect)`, which are connected to the signals of the layers.
	explicit LayerWatch(godot::Object *node) : node_(node) {}

	/// True if the list has changed since the last `look`, or if a script has changed the meshes of a layer in place.
	bool differs(const godot::TypedArray<ScatterLayer> &p_layers) const;

	/// Reads the list: connects to new layers, and disconnects from removed ones. Gives an ID to each layer whose layer_id is -1: its index
	/// if no other layer has that ID, otherwise the lowest unused one. Layers from `own_count` on are added and removed by biomes. They get
	/// IDs that no layer has ever had, so that a layer that returns still has its own ID. Layers then emit `changed`. If the list is
	/// unchanged, IDs are given only if `p_give` is true. Applies changes that scripts have made to the layers' meshes. Returns whether the
	/// list differs from that of the last call.
	bool look(const godot::TypedArray<ScatterLayer> &p_layers, std::size_t own_count, bool p_give);

	/// The layers that were renamed since the last call, for references to them. Leaves out a new name that is empty or
	/// belongs to another layer, so that users may type a name letter by letter. Leaves out an old name that another
	/// layer has, because references then refer to that layer.
	std::vector<LayerRename> follow_names();

	/// Changes the references of all layers of the list.
	void change_references(const ReferenceChange &change) const;

private:
	struct Seen {
		godot::Ref<ScatterLayer> layer; ///< Null for an empty entry.
		godot::String name;             ///< The name that other layers use in references.
	};

	bool lists_differ(const godot::TypedArray<ScatterLayer> &p_layers) const;
	void take_mesh_changes() const;
	bool is_taken(const godot::String &p_name, const Seen &by_other_than) const;
	void listen(bool p_listen) const;
	void give_ids(std::size_t own_count);

	godot::Object *node_;
	std::vector<Seen> seen_;
	std::set<std::int64_t> ids_; ///< All IDs that any layer has ever had.
	bool giving_ids_ = false;
};

} // namespace thicket
