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
	return lists_differ(p_layers) || std::ranges::any_of(seen_, [](const Seen &seen) {
		return seen.layer.is_valid() && seen.layer->meshes_differ();
	});
}

/// Applies changes that scripts have made to the layers' meshes in place. The layers then emit
/// `changed`, so scripts may run and change anything.
void LayerWatch::take_mesh_changes() const {
	const std::vector<Seen> layers = seen_;
	for (const Seen &seen : layers) {
		if (seen.layer.is_valid() && seen.layer->meshes_differ()) {
			seen.layer->take_mesh_changes();
		}
	}
}

bool LayerWatch::lists_differ(const TypedArray<ScatterLayer> &p_layers) const {
	bool same = p_layers.size() == static_cast<int64_t>(seen_.size());
	for (std::size_t index = 0; same && index < seen_.size(); ++index) {
		// Every query runs this loop, and a plain pointer avoids reference counting.
		const Object *layer = p_layers[static_cast<int64_t>(index)];
		same = layer == seen_[index].layer.ptr();
	}
	return !same;
}

bool LayerWatch::update(const TypedArray<ScatterLayer> &p_layers, std::size_t own_count, bool p_assign) {
	const bool changed = lists_differ(p_layers);
	if (changed) {
		const std::vector<Seen> before = seen_;
		listen(false);
		seen_.clear();
		for (int64_t index = 0; index < p_layers.size(); ++index) {
			Seen seen{p_layers[index], {}};
			const auto known = std::ranges::find(before, seen.layer, &Seen::layer);
			if (seen.layer.is_valid()) {
				seen.name = known != before.end() ? known->name : seen.layer->get_name();
			}
			seen_.push_back(std::move(seen));
		}
		listen(true);
	}
	take_mesh_changes();
	if (changed || p_assign) {
		assign_ids(own_count);
	}
	return changed;
}

void LayerWatch::listen(bool p_listen) const {
	for (const Seen &seen : seen_) {
		watch(seen.layer.ptr(), "changed", node_, "_mark_dirty", p_listen);
		watch(seen.layer.ptr(), "area_changed", node_, "_mark_area_edited", p_listen);
	}
}

void LayerWatch::assign_ids(std::size_t own_count) {
	if (std::exchange(giving_ids_, true)) {
		return; // A recursive call: a layer has emitted `changed` because of its new ID.
	}
	std::set<int64_t> taken;
	for (const Seen &seen : seen_) {
		if (seen.layer.is_valid()) {
			taken.insert(seen.layer->own_id());
		}
	}
	ids_.insert(taken.begin(), taken.end());
	const std::vector<Seen> layers = seen_; // Use a copy, because a signal handler may change the list.
	for (std::size_t index = 0; taken.count(-1) > 0 && index < layers.size(); ++index) {
		const Ref<ScatterLayer> &layer = layers[index].layer;
		if (layer.is_null() || layer->own_id() >= 0) {
			continue;
		}
		const std::set<int64_t> &others = index < own_count ? taken : ids_;
		auto id = static_cast<int64_t>(index);
		if (others.count(id) > 0 || id > max_state_layer) {
			for (id = 0; others.count(id) > 0; ++id) {}
		}
		if (id <= max_state_layer) {
			taken.insert(id);
			ids_.insert(id);
			layer->take_id(id);
		}
	}
	giving_ids_ = false;
}

bool LayerWatch::is_taken(const String &p_name, const Seen &by_other_than) const {
	return std::ranges::any_of(seen_, [&](const Seen &seen) {
		return seen.layer.is_valid() && !(seen.layer == by_other_than.layer) && seen.layer->get_name() == p_name;
	});
}

std::vector<LayerRename> LayerWatch::follow_names() {
	std::vector<LayerRename> renames;
	for (Seen &seen : seen_) {
		const String name = seen.layer.is_valid() ? seen.layer->get_name() : String();
		if (name.is_empty() || name == seen.name || is_taken(name, seen)) {
			continue;
		}
		const String before = std::exchange(seen.name, name);
		if (before.is_empty() || !is_taken(before, seen)) {
			renames.push_back({before, name});
		}
	}
	return renames;
}

void LayerWatch::change_references(const ReferenceChange &change) const {
	const std::vector<Seen> layers = seen_; // Use a copy, because a signal handler may change the list.
	for (const Seen &seen : layers) {
		if (seen.layer.is_valid()) {
			seen.layer->change_references(change);
		}
	}
}

} // namespace thicket
