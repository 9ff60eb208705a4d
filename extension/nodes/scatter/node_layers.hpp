#pragma once

#include "nodes/biome/scatter_biome_map.hpp"
#include "nodes/layer/scatter_layer.hpp"

#include <godot_cpp/variant/typed_array.hpp>

#include <cstddef>
#include <vector>

namespace thicket {

/// Lists all layers of a node: its own layers, followed by those of its biomes without duplicates.
/// Use it only on the main thread.
///
/// The node's own layers have the same index as in the node's list. Layers of biomes have higher
/// indices, which stay the same while other layers of biomes are added or removed. Such changes
/// therefore regenerate no tiles of the remaining layers.
class NodeLayers {
public:
	/// Reads the current layers. `biomes` may be null.
	void update(const godot::TypedArray<ScatterLayer> &p_own_layers, const ScatterBiomeMap *biomes);

	/// Returns the layers by index; null for an unused index. If there are no layers of biomes,
	/// this is the node's own array.
	const godot::TypedArray<ScatterLayer> &by_index() const { return by_index_; }

	/// Returns the indices in order of priority, the highest first. The order of the layers depends
	/// only on the current lists, not on earlier updates.
	const std::vector<std::size_t> &order() const { return order_; }

	/// Returns the number of the node's own layers, which come first.
	std::size_t own_count() const { return own_count_; }

private:
	godot::TypedArray<ScatterLayer> by_index_;
	std::vector<std::size_t> order_;
	std::vector<godot::Ref<ScatterLayer>> last_layers_; ///< All layers at the last update.
	std::size_t own_count_ = 0;
};

} // namespace thicket
