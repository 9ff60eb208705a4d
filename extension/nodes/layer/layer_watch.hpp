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

/// A layer has another name: what spoke of it by the old one means the new one.
struct LayerRename {
	godot::String from; ///< Empty for a layer that had no name, of which others spoke by itself.
	godot::String to;
};

/// What a node has seen of its list of layers. Scripts share the list's array with the node, so layers come and go without
/// a setter being called: the node looks in every frame and before it answers anything. Main thread only.
class LayerWatch {
public:
	/// `node` has the methods `_mark_dirty` and `_mark_area_edited(rect)`, which hear of changes of the layers.
	explicit LayerWatch(godot::Object *node) : node_(node) {}

	/// True if the list is not the one of the last `look`, or if a script has changed the meshes of a layer in place.
	bool differs(const godot::TypedArray<ScatterLayer> &p_layers) const;

	/// Takes in the list: listens to the layers that are new, and no longer to those that are gone, and gives each layer
	/// whose layer_id is -1 one of its own: its index if no other layer has that, else the lowest that none has. Layers
	/// from `own_count` on come and go with biomes: they get ids that none has had, so that one which comes back has kept its
	/// own. Layers emit `changed` for it. Where the list is the same, they get one only if `p_give`. Takes over what scripts have
	/// changed in the layers' meshes. Returns whether the list is another one than that of the last call.
	bool look(const godot::TypedArray<ScatterLayer> &p_layers, std::size_t own_count, bool p_give);

	/// Makes all layers of the list follow when one of them was renamed, and returns the renames. Nothing follows while the
	/// new name is empty or another layer has it, so that a name may be typed letter by letter; and nothing follows
	/// where another layer has the old name, since that one is meant from then on.
	std::vector<LayerRename> follow_names();

private:
	struct Seen {
		godot::Ref<ScatterLayer> layer; ///< Null for an empty entry.
		godot::String name;             ///< By which others speak of it.
	};

	bool lists_differ(const godot::TypedArray<ScatterLayer> &p_layers) const;
	void take_mesh_changes() const;
	bool is_taken(const godot::String &p_name, const Seen &by_other_than) const;
	void listen(bool p_listen) const;
	void give_ids(std::size_t own_count);

	godot::Object *node_;
	std::vector<Seen> seen_;
	std::set<std::int64_t> ids_; ///< That any layer has had.
	bool giving_ids_ = false;
};

} // namespace thicket
