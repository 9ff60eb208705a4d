#pragma once

#include "nodes/biome/scatter_biome_map.hpp"
#include "nodes/layer/scatter_layer.hpp"

#include <godot_cpp/variant/typed_array.hpp>

#include <cstddef>
#include <vector>

namespace thicket {

/// All layers that a node displays, without duplicates: its own, then those of its biomes, one biome after the other. Main thread only.
///
/// The node's own layers have their index in the node's list. Layers of biomes have higher indices. Such a layer keeps
/// its index as long as it is displayed, whichever other layers are added or removed, so that none of its tiles is
/// regenerated.
class NodeLayers {
public:
	/// Reads the current layers. `biomes` may be null.
	void update(const godot::TypedArray<ScatterLayer> &p_own, const ScatterBiomeMap *biomes);

	/// By index, null for an unused index. Without biomes, this is the node's own list.
	const godot::TypedArray<ScatterLayer> &by_index() const { return by_index_; }

	/// Indices in order of priority: earlier layers take priority over later ones. Depends only on the lists, not on
	/// earlier updates.
	const std::vector<std::size_t> &order() const { return order_; }

	/// Layers before this index are the node's own.
	std::size_t own_count() const { return own_count_; }

private:
	godot::TypedArray<ScatterLayer> by_index_;
	std::vector<std::size_t> order_;
	std::vector<godot::Ref<ScatterLayer>> seen_; ///< The node's own layers, then those of biomes, at the last update.
	std::size_t own_count_ = 0;
};

} // namespace thicket
