#include "nodes/scatter/node_layers.hpp"

#include "nodes/common/engine_arrays.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

using Layers = std::vector<Ref<ScatterLayer>>;

void add_new(const TypedArray<ScatterLayer> &p_layers, Layers &r_layers) {
	for (int64_t index = 0; index < p_layers.size(); ++index) {
		const Ref<ScatterLayer> layer = p_layers[index];
		if (layer.is_valid() && std::ranges::find(r_layers, layer) == r_layers.end()) {
			r_layers.push_back(layer);
		}
	}
}

/// Assigns indices: layers of biomes keep their previous ones, and new layers get free ones.
Layers placed(const Layers &wanted, std::size_t own_count, const TypedArray<ScatterLayer> &p_before) {
	Layers result(wanted.begin(), wanted.begin() + static_cast<std::ptrdiff_t>(own_count));
	const auto count = std::max(static_cast<std::size_t>(p_before.size()), wanted.size());
	result.resize(count);
	Layers homeless;
	for (std::size_t i = own_count; i < wanted.size(); ++i) {
		std::size_t index = own_count;
		while (index < static_cast<std::size_t>(p_before.size()) &&
				Ref<ScatterLayer>(p_before[static_cast<int64_t>(index)]) != wanted[i]) {
			++index;
		}
		if (index < static_cast<std::size_t>(p_before.size())) {
			result[index] = wanted[i];
		} else {
			homeless.push_back(wanted[i]);
		}
	}
	auto free = result.begin() + static_cast<std::ptrdiff_t>(own_count);
	for (const Ref<ScatterLayer> &layer : homeless) {
		free = std::ranges::find_if(free, result.end(), [](const Ref<ScatterLayer> &entry) { return entry.is_null(); });
		*free = layer;
	}
	while (result.size() > own_count && result.back().is_null()) {
		result.pop_back();
	}
	return result;
}

} // namespace

void NodeLayers::update(const TypedArray<ScatterLayer> &p_own, const ScatterBiomeMap *biomes) {
	own_count_ = static_cast<std::size_t>(p_own.size());
	Layers wanted;
	if (biomes != nullptr) {
		for (int64_t index = 0; index < p_own.size(); ++index) {
			wanted.emplace_back(p_own[index]);
		}
		biomes->each_layers([&wanted](const TypedArray<ScatterLayer> &p_layers) { add_new(p_layers, wanted); });
	}
	if (wanted.size() <= own_count_) {
		by_index_ = p_own;
		seen_.clear();
		order_.resize(own_count_);
		std::iota(order_.begin(), order_.end(), std::size_t{0});
		return;
	}
	if (wanted == seen_) {
		// The indices are still valid.
		return;
	}
	const Layers layers = placed(wanted, own_count_, by_index_);
	TypedArray<ScatterLayer> next;
	for (const Ref<ScatterLayer> &layer : layers) {
		append(next, layer);
	}
	by_index_ = next;
	order_.clear();
	for (std::size_t i = 0; i < wanted.size(); ++i) {
		order_.push_back(i < own_count_
						? i
						: static_cast<std::size_t>(
								  std::ranges::find(layers.begin() + static_cast<std::ptrdiff_t>(own_count_),
										  layers.end(), wanted[i]) -
								  layers.begin()));
	}
	seen_ = std::move(wanted);
}

} // namespace thicket
