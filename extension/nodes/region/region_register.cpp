#include "nodes/region/region_register.hpp"

#include "core/base/guard.hpp"
#include "nodes/layer/layer_reference.hpp"
#include "nodes/region/scatter_region_3d.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// The apparent movement in meters that rounding may cause when a scene is recentered.
constexpr double rounding_tolerance = 0.01;

/// Returns true if two shapes are the same except for rounding.
bool equal_except_rounding(const Shape &before, const Shape &after) {
	const auto is_close = [](const auto &a, const auto &b) {
		return glm::distance(a, b) <= rounding_tolerance;
	};
	Shape shape = before;
	if (is_close(shape.center, after.center)) {
		shape.center = after.center;
	}
	if (std::ranges::equal(shape.outline, after.outline, is_close)) {
		shape.outline = after.outline;
	}
	return shape == after;
}

} // namespace

bool RegionRegister::Entry::affects_layer(const TypedArray<ScatterLayer> &p_layers, std::size_t index) const {
	bool affects = shape.has_value() && layers.is_empty();
	for (int64_t i = 0; shape.has_value() && !affects && i < layers.size(); ++i) {
		std::uint32_t found_index = 0;
		affects = find_stored_layer(p_layers, layers[i], found_index).is_empty() && found_index == index;
	}
	return affects;
}

void RegionRegister::add(ScatterRegion3D *region) { entries_.emplace_back().node = region; }

void RegionRegister::remove(ScatterRegion3D *region) {
	std::erase_if(entries_, [region](const Entry &entry) { return entry.node == region; });
}

void RegionRegister::mark(const ScatterRegion3D *region) {
	for (Entry &entry : entries_) {
		entry.is_marked = entry.is_marked || entry.node == region;
	}
}

bool RegionRegister::paths_changed() {
	bool any_changed = false;
	for (Entry &entry : entries_) {
		const bool has_changed = entry.node->path_changed();
		entry.is_marked = entry.is_marked || has_changed;
		any_changed = any_changed || has_changed;
	}
	return any_changed;
}

bool RegionRegister::mark_all() {
	for (Entry &entry : entries_) {
		entry.is_marked = true;
	}
	return !entries_.empty();
}

void RegionRegister::update(bool was_recentered) {
	for (Entry &entry : entries_) {
		if (std::exchange(entry.is_marked, false)) {
			const std::optional<Shape> before = std::exchange(entry.last_read, entry.node->world_shape());
			const bool is_same = was_recentered && before && entry.last_read
					? equal_except_rounding(*before, *entry.last_read)
					: before == entry.last_read;
			if (!is_same || !entry.shape) {
				entry.shape = entry.last_read;
			}
			entry.layers = entry.node->get_layers();
		}
	}
}

std::shared_ptr<const ShapeSet> RegionRegister::set_for(const TypedArray<ScatterLayer> &p_layers, std::size_t index) {
	std::vector<Shape> shapes;
	for (const Entry &entry : entries_) {
		if (entry.affects_layer(p_layers, index)) {
			shapes.push_back(*entry.shape);
		}
	}
	sets_.resize(std::max(sets_.size(), index + 1));
	std::shared_ptr<const ShapeSet> &last_set = sets_[index];
	const auto is_same = [&shapes](const std::shared_ptr<const ShapeSet> &set) {
		return set != nullptr && std::ranges::equal(set->shapes(), shapes);
	};
	if (shapes.empty()) {
		last_set = nullptr;
		return last_set;
	}
	if (is_same(last_set)) {
		// The set is unchanged, so no tile is regenerated.
		return last_set;
	}
	if (const auto match = std::ranges::find_if(sets_, is_same); match != sets_.end()) {
		// Most regions affect all layers, so layers often share a set.
		last_set = *match;
		return last_set;
	}
	auto new_set = std::make_shared<ShapeSet>();
	const Status status = new_set->set(std::move(shapes));
	throw_if_out_of_memory(status);
	if (status.ok()) { // Always, because each shape was validated before.
		last_set = std::move(new_set);
	}
	return last_set;
}

std::vector<std::string> RegionRegister::names_for(const TypedArray<ScatterLayer> &p_layers, std::size_t index) const {
	std::vector<std::string> names;
	for (const Entry &entry : entries_) {
		if (entry.affects_layer(p_layers, index)) {
			names.emplace_back(String(entry.node->get_name()).utf8().get_data());
		}
	}
	return names;
}

void RegionRegister::change_references(const ReferenceChange &change) const {
	// Use a copy, because a changed region calls its host, which marks the entries.
	const std::vector<Entry> entries = entries_;
	for (const Entry &entry : entries) {
		entry.node->change_references(change);
	}
}

void RegionRegister::update_warnings() const {
	for (const Entry &entry : entries_) {
		entry.node->update_configuration_warnings();
	}
}

} // namespace thicket
