#include "nodes/layer/layer_watch.hpp"

#include "core/state/instance_state.hpp"
#include "nodes/common/watch.hpp"

#include <godot_cpp/core/object.hpp>

#include <algorithm>
#include <cstdint>
#include <set>
#include <utility>

using namespace godot;

namespace thicket {

bool LayerWatch::differs(const TypedArray<ScatterLayer> &p_layers) const {
	return lists_differ(p_layers) || std::ranges::any_of(watched_layers_, [](const WatchedLayer &watched) {
		return watched.layer.is_valid() && watched.layer->meshes_differ();
	});
}

/// Applies changes that scripts have made to the layers' meshes in place. The layers then emit
/// `changed`, so scripts may run and change anything.
void LayerWatch::take_mesh_changes() const {
	const std::vector<WatchedLayer> layers = watched_layers_;
	for (const WatchedLayer &watched : layers) {
		if (watched.layer.is_valid() && watched.layer->meshes_differ()) {
			watched.layer->take_mesh_changes();
		}
	}
}

bool LayerWatch::lists_differ(const TypedArray<ScatterLayer> &p_layers) const {
	bool is_same = p_layers.size() == static_cast<int64_t>(watched_layers_.size());
	for (std::size_t index = 0; is_same && index < watched_layers_.size(); ++index) {
		// Every query runs this loop, and a plain pointer avoids reference counting.
		const Object *layer = p_layers[static_cast<int64_t>(index)];
		is_same = layer == watched_layers_[index].layer.ptr();
	}
	return !is_same;
}

bool LayerWatch::update(const TypedArray<ScatterLayer> &p_layers, std::size_t own_count, bool p_assign) {
	const bool list_changed = lists_differ(p_layers);
	if (list_changed) {
		const std::vector<WatchedLayer> previous_layers = watched_layers_;
		listen(false);
		watched_layers_.clear();
		for (int64_t index = 0; index < p_layers.size(); ++index) {
			WatchedLayer watched{p_layers[index], {}};
			const auto previous = std::ranges::find(previous_layers, watched.layer, &WatchedLayer::layer);
			if (watched.layer.is_valid()) {
				watched.name = previous != previous_layers.end() ? previous->name : watched.layer->get_name();
			}
			watched_layers_.push_back(std::move(watched));
		}
		listen(true);
	}
	take_mesh_changes();
	if (list_changed || p_assign) {
		assign_ids(own_count);
	}
	return list_changed;
}

void LayerWatch::listen(bool p_listen) const {
	for (const WatchedLayer &watched : watched_layers_) {
		watch(watched.layer.ptr(), "changed", node_, "_mark_dirty", p_listen);
		watch(watched.layer.ptr(), "area_changed", node_, "_mark_area_edited", p_listen);
	}
}

void LayerWatch::assign_ids(std::size_t own_count) {
	if (std::exchange(is_assigning_ids_, true)) {
		return; // A recursive call: a layer has emitted `changed` because of its new ID.
	}
	std::set<int64_t> used_ids;
	for (const WatchedLayer &watched : watched_layers_) {
		if (watched.layer.is_valid()) {
			used_ids.insert(watched.layer->own_id());
		}
	}
	ids_.insert(used_ids.begin(), used_ids.end());
	// Use a copy, because a signal handler may change the list.
	const std::vector<WatchedLayer> layers = watched_layers_;
	for (std::size_t index = 0; used_ids.count(-1) > 0 && index < layers.size(); ++index) {
		const Ref<ScatterLayer> &layer = layers[index].layer;
		if (layer.is_null() || layer->own_id() >= 0) {
			continue;
		}
		const std::set<int64_t> &reserved_ids = index < own_count ? used_ids : ids_;
		auto id = static_cast<int64_t>(index);
		if (reserved_ids.count(id) > 0 || id > max_state_layer) {
			for (id = 0; reserved_ids.count(id) > 0; ++id) {}
		}
		if (id <= max_state_layer) {
			used_ids.insert(id);
			ids_.insert(id);
			layer->take_id(id);
		}
	}
	is_assigning_ids_ = false;
}

bool LayerWatch::is_name_of_other(const String &p_name, const WatchedLayer &layer) const {
	return std::ranges::any_of(watched_layers_, [&](const WatchedLayer &watched) {
		return watched.layer.is_valid() && !(watched.layer == layer.layer) && watched.layer->get_name() == p_name;
	});
}

std::vector<LayerRename> LayerWatch::follow_names() {
	std::vector<LayerRename> renames;
	for (WatchedLayer &watched : watched_layers_) {
		const String name = watched.layer.is_valid() ? watched.layer->get_name() : String();
		if (name.is_empty() || name == watched.name || is_name_of_other(name, watched)) {
			continue;
		}
		const String previous_name = std::exchange(watched.name, name);
		if (previous_name.is_empty() || !is_name_of_other(previous_name, watched)) {
			renames.push_back({previous_name, name});
		}
	}
	return renames;
}

void LayerWatch::change_references(const ReferenceChange &change) const {
	// Use a copy, because a signal handler may change the list.
	const std::vector<WatchedLayer> layers = watched_layers_;
	for (const WatchedLayer &watched : layers) {
		if (watched.layer.is_valid()) {
			watched.layer->change_references(change);
		}
	}
}

} // namespace thicket
