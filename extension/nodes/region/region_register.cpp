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
constexpr double rounding = 0.01;

/// Returns whether two shapes are the same except for rounding.
bool equal_except_rounding(const Shape &before, const Shape &now) {
	const auto near = [](const auto &a, const auto &b) {
		return glm::distance(a, b) <= rounding;
	};
	Shape moved = before;
	if (near(moved.center, now.center)) {
		moved.center = now.center;
	}
	if (std::ranges::equal(moved.outline, now.outline, near)) {
		moved.outline = now.outline;
	}
	return moved == now;
}

} // namespace

bool RegionRegister::Entry::counts_for(const TypedArray<ScatterLayer> &p_layers, std::size_t index) const {
	bool counts = shape.has_value() && layers.is_empty();
	for (int64_t i = 0; shape.has_value() && !counts && i < layers.size(); ++i) {
		std::uint32_t found = 0;
		counts = find_stored_layer(p_layers, layers[i], found).is_empty() && found == index;
	}
	return counts;
}

void RegionRegister::add(ScatterRegion3D *region) { entries_.emplace_back().node = region; }

void RegionRegister::remove(ScatterRegion3D *region) {
	std::erase_if(entries_, [region](const Entry &entry) { return entry.node == region; });
}

void RegionRegister::mark(const ScatterRegion3D *region) {
	for (Entry &entry : entries_) {
		entry.marked = entry.marked || entry.node == region;
	}
}

bool RegionRegister::paths_changed() {
	bool any = false;
	for (Entry &entry : entries_) {
		const bool changed = entry.node->path_changed();
		entry.marked = entry.marked || changed;
		any = any || changed;
	}
	return any;
}

bool RegionRegister::mark_all() {
	for (Entry &entry : entries_) {
		entry.marked = true;
	}
	return !entries_.empty();
}

void RegionRegister::update(bool recentered) {
	for (Entry &entry : entries_) {
		if (std::exchange(entry.marked, false)) {
			const std::optional<Shape> before = std::exchange(entry.read, entry.node->world_shape());
			const bool same = recentered && before && entry.read ? equal_except_rounding(*before, *entry.read)
																 : before == entry.read;
			if (!same || !entry.shape) {
				entry.shape = entry.read;
			}
			entry.layers = entry.node->get_layers();
		}
	}
}

std::shared_ptr<const ShapeSet> RegionRegister::set_for(const TypedArray<ScatterLayer> &p_layers, std::size_t index) {
	std::vector<Shape> shapes;
	for (const Entry &entry : entries_) {
		if (entry.counts_for(p_layers, index)) {
			shapes.push_back(*entry.shape);
		}
	}
	sets_.resize(std::max(sets_.size(), index + 1));
	std::shared_ptr<const ShapeSet> &last = sets_[index];
	const auto is_same = [&shapes](const std::shared_ptr<const ShapeSet> &set) {
		return set != nullptr && std::ranges::equal(set->shapes(), shapes);
	};
	if (shapes.empty()) {
		last = nullptr;
		return last;
	}
	if (is_same(last)) {
		// The set is unchanged, so no tile is regenerated.
		return last;
	}
	if (const auto shared = std::ranges::find_if(sets_, is_same); shared != sets_.end()) {
		// Most regions affect all layers, so layers often share a set.
		last = *shared;
		return last;
	}
	auto next = std::make_shared<ShapeSet>();
	const Status status = next->set(std::move(shapes));
	throw_if_out_of_memory(status);
	if (status.ok()) { // Always, because each shape was validated before.
		last = std::move(next);
	}
	return last;
}

std::vector<std::string> RegionRegister::names_for(const TypedArray<ScatterLayer> &p_layers, std::size_t index) const {
	std::vector<std::string> names;
	for (const Entry &entry : entries_) {
		if (entry.counts_for(p_layers, index)) {
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
