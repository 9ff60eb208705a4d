#pragma once

#include "nodes/layer/layer_snapshot.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// The current layers by index. Each change to a layer's drawing settings gives the layer a new
/// version. A tile that was drawn with another version must be updated.
class DrawnLayers {
public:
	/// Replaces the layers. Returns true if the drawing settings of any layer have changed.
	bool set(std::span<const SharedSnapshot> layers);

	std::span<const SharedSnapshot> all() const { return layers_; }

	/// Returns null for a layer that is not displayed.
	const LayerSnapshot *find(std::uint32_t index) const {
		return index < layers_.size() ? layers_[index].get() : nullptr;
	}
	/// Returns the current index of the layer that a tile belongs to. If the list of layers has
	/// changed, this index differs from `index`, under which the tile is displayed. Returns the
	/// number of layers if the layer is no longer displayed.
	std::uint32_t index_of(std::uint64_t owner, std::uint32_t index) const;
	std::uint64_t version(std::uint32_t index) const { return index < versions_.size() ? versions_[index] : 0; }

private:
	std::vector<SharedSnapshot> layers_;
	std::vector<std::uint64_t> versions_; ///< The version of each layer.
	std::uint64_t last_version_ = 0;
};

} // namespace thicket
