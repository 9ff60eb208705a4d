#pragma once

#include "nodes/biome/scatter_biome_map.hpp"
#include "nodes/layer/scatter_layer.hpp"

#include <godot_cpp/variant/typed_array.hpp>

#include <cstddef>
#include <vector>

namespace thicket {

/// All layers that a node shows, each once: its own, then those of its biomes, one biome after the other. Main thread only.
///
/// A layer of the node's own has the index that it has in the node's list. A layer of a biome has one behind those, and keeps it
/// as long as it is shown, whatever comes and goes beside it: then no tile of it has to be made anew.
class NodeLayers {
public:
	/// Takes in the layers as they are now. `biomes` may be null.
	void update(const godot::TypedArray<ScatterLayer> &p_own, const ScatterBiomeMap *biomes);

	/// By index, null where there is none. Without biomes it is the node's own list.
	const godot::TypedArray<ScatterLayer> &by_index() const { return by_index_; }

	/// Indices in the order in which layers give way to each other. It follows from the lists alone, and not from what was shown before.
	const std::vector<std::size_t> &order() const { return order_; }

	/// Layers before this index are the node's own.
	std::size_t own_count() const { return own_count_; }

private:
	godot::TypedArray<ScatterLayer> by_index_;
	std::vector<std::size_t> order_;
	std::vector<godot::Ref<ScatterLayer>> seen_; ///< Own ones, then those of biomes, of the last update.
	std::size_t own_count_ = 0;
};

} // namespace thicket
