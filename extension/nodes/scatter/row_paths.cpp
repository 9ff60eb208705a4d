#include "nodes/scatter/row_paths.hpp"

#include "core/base/split_mix.hpp"
#include "core/base/word_hash.hpp"
#include "core/rules/polyline.hpp"
#include "nodes/common/convert.hpp"

#include <godot_cpp/classes/curve3d.hpp>
#include <godot_cpp/classes/scene_tree.hpp>
#include <godot_cpp/classes/world3d.hpp>
#include <godot_cpp/core/object.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Maximum number of paths of a group that are checked in each frame.
constexpr std::size_t paths_per_frame = 64;

/// The tolerance, in meters, for simplifying the baked points of a path's curve.
constexpr double path_tolerance = 0.01;

/// The apparent movement in meters that rounding may cause when a scene is recentered.
constexpr double rounding_tolerance = 0.01;

/// Returns a number that identifies a node by the names on the path from `host` to it. The number is the
/// same whenever the scene is loaded, and wherever the scene is in the tree.
std::uint64_t identity_of(const Node &host, const Node &node) {
	std::vector<std::uint64_t> ancestors;
	for (const Node *ancestor = &host; ancestor != nullptr; ancestor = ancestor->get_parent()) {
		ancestors.push_back(ancestor->get_instance_id());
	}
	WordHash hash;
	const Node *ancestor = &node;
	auto common_ancestor = ancestors.end();
	while (ancestor != nullptr &&
			(common_ancestor = std::ranges::find(ancestors, ancestor->get_instance_id())) == ancestors.end()) {
		const CharString name = String(ancestor->get_name()).utf8();
		const char *text = name.get_data();
		for (std::size_t i = 0; i < std::strlen(text); ++i) {
			hash.add(static_cast<std::uint32_t>(static_cast<unsigned char>(text[i])));
		}
		hash.add(static_cast<std::uint32_t>('/'));
		ancestor = ancestor->get_parent();
	}
	hash.add(static_cast<std::uint32_t>(common_ancestor - ancestors.begin()));
	return split_mix(hash.value());
}

bool is_near(const RowLine &a, const RowLine &b) {
	const auto is_close = [](glm::dvec2 p, glm::dvec2 q) {
		return glm::distance(p, q) <= rounding_tolerance;
	};
	return a.identity == b.identity && is_close(a.anchor, b.anchor) && is_close(a.axis, b.axis) &&
			std::ranges::equal(a.points, b.points, is_close);
}

} // namespace

bool RowPaths::PathState::is_same(const PathState &other) const {
	return id == other.id && name == other.name && parent == other.parent && transform == other.transform &&
			points.ptr() == other.points.ptr();
}

/// Returns the current state of a path, without its node.
RowPaths::PathState RowPaths::state_of(const Path3D &path, const RegionHost &world) {
	PathState state;
	state.id = path.get_instance_id();
	state.name = path.get_name();
	state.parent = path.get_parent() != nullptr ? path.get_parent()->get_instance_id() : 0;
	const Transform3D transform = world.transform_of(path);
	const Ref<Curve3D> curve = path.get_curve();
	// A path whose transform is not finite has no points. Such a transform does not even equal itself.
	if (is_finite(transform) && curve.is_valid()) {
		state.transform = transform;
		state.points = curve->get_baked_points();
	}
	return state;
}

/// Checks some of the paths of a group.
void RowPaths::check(Group &r_group, const RegionHost &world) {
	const std::size_t count = r_group.paths.size();
	for (std::size_t check_count = 0; !r_group.is_outdated && check_count < std::min(paths_per_frame, count);
			++check_count) {
		r_group.next_index = (r_group.next_index + 1) % count;
		r_group.remaining_checks -= r_group.remaining_checks > 0 ? 1 : 0;
		const PathState &previous = r_group.paths[r_group.next_index];
		const auto *path = Object::cast_to<Path3D>(previous.node.get_validated_object());
		if (path == nullptr || !path->is_inside_tree() || !path->is_in_group(r_group.name)) {
			r_group.is_outdated = true;
		} else if (!previous.is_same(state_of(*path, world))) {
			r_group.remaining_checks =
					r_group.changed_indices.empty() && count > paths_per_frame ? count - 1 : r_group.remaining_checks;
			r_group.changed_indices.insert(r_group.next_index);
		}
	}
}

bool RowPaths::have_changed(const Node3D &host, const RegionHost &world) {
	bool any_changed = false;
	for (auto &[text, group] : groups_) {
		group.is_outdated = group.is_outdated || host.get_tree()->get_node_count_in_group(group.name) != group.count;
		check(group, world);
		any_changed =
				any_changed || group.is_outdated || (!group.changed_indices.empty() && group.remaining_checks == 0);
	}
	return any_changed;
}

void RowPaths::begin_update(const Node3D &host, const RegionHost &world, bool was_recentered) {
	host_ = &host;
	world_ = &world;
	was_recentered_ = was_recentered;
	former_set_count_ = sets_.size();
	for (auto &[text, group] : groups_) {
		group.is_used = false;
		group.is_outdated = group.is_outdated || was_recentered;
	}
}

void RowPaths::end_update() {
	std::erase_if(groups_, [](const auto &group) { return !group.second.is_used; });
	sets_.erase(sets_.begin(), sets_.begin() + static_cast<std::ptrdiff_t>(former_set_count_));
	host_ = nullptr;
	world_ = nullptr;
}

/// Returns the line of a path in the host's world.
RowLine RowPaths::line_of(const PathState &path) const {
	const bool has_offset = !world_->world_frame().local;
	const glm::dmat3 basis = to_core(path.transform.basis);
	const glm::dvec3 origin =
			to_core(path.transform.origin) + (has_offset ? world_->world_frame().offset : glm::dvec3(0.0));
	RowLine line;
	line.identity = identity_of(*host_, *Object::cast_to<Node>(path.node.get_validated_object()));
	line.anchor = {origin.x, origin.z};
	const glm::dvec2 axis(basis[0].x, basis[0].z);
	const double length = std::sqrt(axis.x * axis.x + axis.y * axis.y);
	line.axis = length > 0.0 ? axis / length : glm::dvec2(1.0, 0.0);
	for (const Vector3 &point : path.points) {
		const glm::dvec3 position = basis * to_core(point) + origin;
		line.points.emplace_back(position.x, position.z);
	}
	line.points = simplified(line.points, path_tolerance);
	return line;
}

/// Reads the paths of a group that have changed, if none has been added or removed.
void RowPaths::read_changed(Group &r_group) const {
	for (const std::size_t index : r_group.changed_indices) {
		PathState &path = r_group.paths[index];
		const auto *node = Object::cast_to<Path3D>(path.node.get_validated_object());
		if (node == nullptr || !node->is_inside_tree() || !(node->get_world_3d() == host_->get_world_3d())) {
			r_group.is_outdated = true; // The path has been removed since it was checked, or is in another world.
			return;
		}
		PathState state = state_of(*node, *world_);
		state.node = path.node;
		path = std::move(state);
		r_group.lines[index] = std::make_shared<const RowLine>(line_of(path));
	}
	r_group.changed_indices.clear();
	r_group.remaining_checks = 0;
}

/// Reads all paths of a group.
void RowPaths::read(Group &r_group) const {
	if (!host_->is_inside_tree()) {
		return; // The paths are read once the host enters the tree.
	}
	std::vector<PathState> paths;
	std::vector<SharedRowLine> lines;
	std::map<std::uint64_t, std::size_t> index_of;
	for (std::size_t i = 0; i < r_group.paths.size(); ++i) {
		index_of.emplace(r_group.paths[i].id, i);
	}
	const TypedArray<Node> nodes = host_->get_tree()->get_nodes_in_group(r_group.name);
	for (std::int64_t i = 0; i < nodes.size(); ++i) {
		const auto *path = Object::cast_to<Path3D>(nodes[i].get_validated_object());
		if (path == nullptr || !(path->get_world_3d() == host_->get_world_3d())) {
			continue;
		}
		PathState state = state_of(*path, *world_);
		state.node = nodes[i];
		const auto entry = index_of.find(state.id);
		const bool is_known = entry != index_of.end();
		if (is_known && r_group.paths[entry->second].is_same(state) && !was_recentered_) {
			lines.push_back(r_group.lines[entry->second]);
		} else {
			lines.push_back(std::make_shared<const RowLine>(line_of(state)));
			if (was_recentered_ && is_known && is_near(*r_group.lines[entry->second], *lines.back())) {
				lines.back() = r_group.lines[entry->second];
			}
		}
		paths.push_back(std::move(state));
	}
	r_group.count = nodes.size();
	r_group.paths = std::move(paths);
	r_group.lines = std::move(lines);
	r_group.is_outdated = false;
	r_group.changed_indices.clear();
	r_group.remaining_checks = 0;
}

Status RowPaths::rows_for(
		const std::string &group_name, const RowSettings &settings, std::shared_ptr<const RowSet> &r_rows) {
	Group &group = groups_[group_name];
	group.is_used = true;
	if (!group.is_outdated && host_->is_inside_tree()) {
		read_changed(group);
	}
	if (group.is_outdated) {
		group.name = String::utf8(group_name.c_str());
		read(group);
	}
	const auto is_same = [&](const std::shared_ptr<const RowSet> &set) {
		bool is_equal = set->settings() == settings && set->line_count() == group.lines.size();
		for (std::size_t i = 0; is_equal && i < group.lines.size(); ++i) {
			is_equal = set->line(i) == group.lines[i] || *set->line(i) == *group.lines[i];
		}
		return is_equal;
	};
	if (const auto match = std::ranges::find_if(sets_, is_same); match != sets_.end()) {
		r_rows = *match;
	} else {
		auto new_set = std::make_shared<RowSet>();
		if (const Status status = new_set->set_shared(settings, group.lines, r_rows.get()); !status.ok()) {
			return status;
		}
		r_rows = std::move(new_set);
	}
	sets_.push_back(r_rows);
	return {};
}

std::size_t RowPaths::path_count(const std::string &group) const {
	const auto entry = groups_.find(group);
	return entry != groups_.end() ? entry->second.paths.size() : 0;
}

} // namespace thicket
