#pragma once

#include "nodes/layer/layer_snapshot.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// The layers as they are drawn now, by index, with a version of each layer's drawing settings. A tile with a different
/// version is still drawn with outdated settings.
class DrawnLayers {
public:
	/// True if a layer is now drawn differently.
	bool set(std::span<const SharedSnapshot> layers);

	std::span<const SharedSnapshot> all() const { return layers_; }

	/// Null for a layer that is not displayed.
	const LayerSnapshot *find(std::uint32_t index) const {
		return index < layers_.size() ? layers_[index].get() : nullptr;
	}
	/// The index of the layer that a tile belongs to. If the list of layers has changed since, this is not the `index`
	/// under which the tile is displayed. Returns the number of layers if the layer is no longer displayed.
	std::uint32_t index_of(std::uint64_t owner, std::uint32_t index) const;
	std::uint64_t version(std::uint32_t index) const { return index < versions_.size() ? versions_[index] : 0; }

private:
	std::vector<SharedSnapshot> layers_;
	std::vector<std::uint64_t> versions_; ///< One for each layer.
	std::uint64_t last_version_ = 0;
};

} // namespace thicket
