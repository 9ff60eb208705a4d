#include "nodes/scatter/node_layers.hpp"

#include "nodes/common/engine_arrays.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

using Layers = std::vector<Ref<ScatterLayer>>;

void append_unique(const TypedArray<ScatterLayer> &p_layers, Layers &r_layers) {
	for (int64_t index = 0; index < p_layers.size(); ++index) {
		const Ref<ScatterLayer> layer = p_layers[index];
		if (layer.is_valid() && std::ranges::find(r_layers, layer) == r_layers.end()) {
			r_layers.push_back(layer);
		}
	}
}

/// Assigns indices: layers of biomes keep their previous ones, and new layers get free ones.
Layers assign_indices(const Layers &layers, std::size_t own_count, const TypedArray<ScatterLayer> &p_previous) {
	Layers result(layers.begin(), layers.begin() + static_cast<std::ptrdiff_t>(own_count));
	const auto count = std::max(static_cast<std::size_t>(p_previous.size()), layers.size());
	result.resize(count);
	Layers new_layers;
	for (std::size_t i = own_count; i < layers.size(); ++i) {
		std::size_t index = own_count;
		while (index < static_cast<std::size_t>(p_previous.size()) &&
				Ref<ScatterLayer>(p_previous[static_cast<int64_t>(index)]) != layers[i]) {
			++index;
		}
		if (index < static_cast<std::size_t>(p_previous.size())) {
			result[index] = layers[i];
		} else {
			new_layers.push_back(layers[i]);
		}
	}
	auto free_entry = result.begin() + static_cast<std::ptrdiff_t>(own_count);
	for (const Ref<ScatterLayer> &layer : new_layers) {
		free_entry = std::ranges::find_if(
				free_entry, result.end(), [](const Ref<ScatterLayer> &entry) { return entry.is_null(); });
		*free_entry = layer;
	}
	while (result.size() > own_count && result.back().is_null()) {
		result.pop_back();
	}
	return result;
}

} // namespace

void NodeLayers::update(const TypedArray<ScatterLayer> &p_own_layers, const ScatterBiomeMap *biomes) {
	own_count_ = static_cast<std::size_t>(p_own_layers.size());
	Layers all_layers;
	if (biomes != nullptr) {
		for (int64_t index = 0; index < p_own_layers.size(); ++index) {
			all_layers.emplace_back(p_own_layers[index]);
		}
		biomes->each_layers(
				[&all_layers](const TypedArray<ScatterLayer> &p_layers) { append_unique(p_layers, all_layers); });
	}
	if (all_layers.size() <= own_count_) {
		by_index_ = p_own_layers;
		last_layers_.clear();
		order_.resize(own_count_);
		std::iota(order_.begin(), order_.end(), std::size_t{0});
		return;
	}
	if (all_layers == last_layers_) {
		// The indices are still valid.
		return;
	}
	const Layers indexed_layers = assign_indices(all_layers, own_count_, by_index_);
	TypedArray<ScatterLayer> new_by_index;
	for (const Ref<ScatterLayer> &layer : indexed_layers) {
		append(new_by_index, layer);
	}
	by_index_ = new_by_index;
	order_.clear();
	for (std::size_t i = 0; i < all_layers.size(); ++i) {
		order_.push_back(i < own_count_
						? i
						: static_cast<std::size_t>(
								  std::ranges::find(indexed_layers.begin() + static_cast<std::ptrdiff_t>(own_count_),
										  indexed_layers.end(), all_layers[i]) -
								  indexed_layers.begin()));
	}
	last_layers_ = std::move(all_layers);
}

} // namespace thicket
