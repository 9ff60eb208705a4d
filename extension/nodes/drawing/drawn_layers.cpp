#include "nodes/drawing/drawn_layers.hpp"

#include <algorithm>
#include <cstddef>

namespace thicket {

bool DrawnLayers::set(std::span<const SharedSnapshot> layers) {
	versions_.resize(layers.size());
	bool any_changed = false;
	for (std::size_t index = 0; index < layers.size(); ++index) {
		const SharedSnapshot previous = index < layers_.size() ? layers_[index] : nullptr;
		const SharedSnapshot &current = layers[index];
		const bool same_drawing = previous != nullptr && current != nullptr && previous->drawing == current->drawing &&
				previous->lod == current->lod && previous->cells == current->cells;
		if (previous != current && !same_drawing) {
			versions_[index] = ++last_version_;
			any_changed = true;
		}
	}
	layers_.assign(layers.begin(), layers.end());
	return any_changed;
}

std::uint32_t DrawnLayers::index_of(std::uint64_t owner, std::uint32_t index) const {
	const auto is_owner = [owner](const SharedSnapshot &layer) {
		return layer != nullptr && layer->links.identity == owner;
	};
	if (index < layers_.size() && is_owner(layers_[index])) {
		return index;
	}
	return static_cast<std::uint32_t>(std::ranges::find_if(layers_, is_owner) - layers_.begin());
}

} // namespace thicket
