#include "nodes/drawing/drawn_layers.hpp"

#include <cstddef>

namespace thicket {

bool DrawnLayers::set(std::span<const SharedSnapshot> layers) {
	versions_.resize(layers.size());
	bool changed = false;
	for (std::size_t index = 0; index < layers.size(); ++index) {
		const SharedSnapshot before = index < layers_.size() ? layers_[index] : nullptr;
		const SharedSnapshot &now = layers[index];
		const bool same = before != nullptr && now != nullptr && before->drawing == now->drawing &&
				before->lod == now->lod && before->cells == now->cells;
		if (before != now && !same) {
			versions_[index] = ++last_version_;
			changed = true;
		}
	}
	layers_.assign(layers.begin(), layers.end());
	return changed;
}

} // namespace thicket
