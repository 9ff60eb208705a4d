#include "nodes/region/scatter_region_3d.hpp"

#include "core/rules/polyline.hpp"
#include "core/rules/shape_frame.hpp"
#include "nodes/common/convert.hpp"

#include <godot_cpp/classes/curve3d.hpp>
#include <godot_cpp/core/object.hpp>

#include <algorithm>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// The tolerance, in meters, for simplifying the baked points of a path's curve.
constexpr double path_tolerance = 0.01;

/// Returns the mean of positions, which must not be empty.
glm::dvec3 mean_of(const std::vector<glm::dvec3> &positions) {
	glm::dvec3 sum(0.0);
	for (const glm::dvec3 &position : positions) {
		sum += position;
	}
	return sum / static_cast<double>(positions.size());
}

} // namespace

ScatterRegion3D::ScatterRegion3D() { set_notify_transform(true); }

void ScatterRegion3D::_notification(int p_what) {
	guarded_call("ScatterRegion3D._notification", [this, p_what] { handle_notification(p_what); });
}

void ScatterRegion3D::handle_notification(int p_what) {
	switch (p_what) {
		case NOTIFICATION_ENTER_TREE: enter(); break;
		case NOTIFICATION_EXIT_TREE: leave(); break;
		case NOTIFICATION_TRANSFORM_CHANGED:
			// A host with local coordinates may only have moved together with the region.
			if (const Transform3D transform = transform_of(*this); !(transform == reported_transform_)) {
				reported_transform_ = transform;
				notify_change();
			}
			break;
		case NOTIFICATION_VISIBILITY_CHANGED: notify_change(); break;
		case NOTIFICATION_EXTENSION_RELOADED:
			if (is_inside_tree()) {
				enter();
			}
			break;
		default: break;
	}
}

void ScatterRegion3D::enter() {
	thread_guard().enter_scene();
	for (Node *node = get_parent(); node != nullptr && host_ == nullptr; node = node->get_parent()) {
		host_ = dynamic_cast<RegionHost *>(node);
	}
	reported_transform_ = transform_of(*this);
	if (host_ != nullptr) {
		host_->add_region(this);
	}
	update_configuration_warnings();
}

void ScatterRegion3D::leave() {
	thread_guard().leave_scene();
	if (host_ != nullptr) {
		std::exchange(host_, nullptr)->remove_region(this);
	}
	last_path_ = {};
}

/// Returns a node's transform in the world of the host, without its offset.
Transform3D ScatterRegion3D::transform_of(const Node3D &node) const {
	return host_ != nullptr ? host_->transform_of(node) : node.get_global_transform();
}

void ScatterRegion3D::notify_change() {
	if (host_ != nullptr) {
		host_->region_changed(this);
	}
	update_gizmos();
	update_configuration_warnings();
}

/// Returns true unless the node, or a node between it and its host, is hidden. A hidden host makes
/// no difference, because its regions still have an effect.
bool ScatterRegion3D::is_visible_below_host() const {
	for (const Node3D *node = this; node != nullptr && dynamic_cast<const RegionHost *>(node) != host_;
			node = cast_to<Node3D>(node->get_parent())) {
		if (!node->is_visible()) {
			return false;
		}
	}
	return true;
}

Path3D *ScatterRegion3D::followed_path() const {
	Path3D *path = cast_to<Path3D>(path_.is_empty() ? get_parent() : get_node_or_null(path_));
	return path != nullptr && path->is_inside_tree() ? path : nullptr;
}

bool ScatterRegion3D::path_changed() {
	if (shape_ != SHAPE_PATH && last_path_.id == 0) {
		// The region neither follows a path nor followed one in the last call.
		return false;
	}
	PathState path_state;
	if (const Path3D *path = shape_ == SHAPE_PATH ? followed_path() : nullptr) {
		path_state.id = path->get_instance_id();
		path_state.transform = transform_of(*path);
		if (const Ref<Curve3D> curve = path->get_curve(); curve.is_valid()) {
			path_state.points = curve->get_baked_points();
		}
	}
	const bool is_same = path_state.id == last_path_.id && path_state.transform == last_path_.transform &&
			path_state.points.ptr() == last_path_.points.ptr();
	if (!is_same) {
		last_path_ = std::move(path_state);
		update_gizmos();
		update_configuration_warnings();
	}
	return !is_same;
}

/// Converts a position from the space of a frame (see transform_of) to the host's world.
glm::dvec3 ScatterRegion3D::to_world(const Transform3D &frame, glm::dvec3 position) const {
	const glm::dvec3 rotated = to_core(frame.basis) * position + to_core(frame.origin);
	const bool has_offset = host_ != nullptr && !host_->world_frame().local;
	return has_offset ? rotated + host_->world_frame().offset : rotated;
}

std::vector<glm::dvec3> ScatterRegion3D::polygon_corners() const {
	std::vector<glm::dvec3> corners;
	const Transform3D frame = transform_of(*this);
	for (const Vector2 &corner : polygon_) {
		corners.push_back(to_world(frame, {corner.x, 0.0, corner.y}));
	}
	return corners;
}

std::vector<glm::dvec3> ScatterRegion3D::path_points() const {
	std::vector<glm::dvec3> points;
	const Path3D *path = followed_path();
	const Ref<Curve3D> curve = path != nullptr ? path->get_curve() : Ref<Curve3D>();
	if (curve.is_null()) {
		return points;
	}
	const Transform3D frame = transform_of(*path);
	for (const Vector3 &point : curve->get_baked_points()) {
		points.push_back(to_world(frame, to_core(point)));
	}
	return points;
}

/// Sets the outline of a polygon or a path and, on a planet, the center of the outline.
void ScatterRegion3D::build_outline(const Planet &planet, thicket::Shape &r_shape) const {
	const std::vector<glm::dvec3> points = shape_ == SHAPE_POLYGON ? polygon_corners() : path_points();
	if (points.empty()) {
		return;
	}
	PlanetMap map;
	if (planet.exists()) {
		r_shape.center = mean_of(points);
		map = PlanetMap(planet, r_shape.center);
	}
	for (const glm::dvec3 &point : points) {
		r_shape.outline.push_back(map.exists() ? map.at(point) : glm::dvec2(point.x, point.z));
	}
	if (shape_ == SHAPE_PATH) {
		r_shape.outline = simplified(r_shape.outline, path_tolerance);
	}
}

/// Sets the position, axes and size of a box, a sphere or a cylinder.
Status ScatterRegion3D::build_solid(thicket::Shape &r_shape) const {
	const Transform3D transform = transform_of(*this);
	ShapeFrame frame;
	if (const Status status = decompose(to_core(transform.basis), frame); !status.ok()) {
		return status;
	}
	r_shape.center = to_world(transform, glm::dvec3(0.0));
	r_shape.axes = frame.axes;
	const glm::dvec3 scale = frame.scale;
	if (shape_ == SHAPE_BOX) {
		r_shape.kind = ShapeKind::box;
		r_shape.half_size = 0.5 * to_core(size_) * scale;
	} else if (shape_ == SHAPE_SPHERE) {
		r_shape.kind = ShapeKind::sphere;
		r_shape.half_size = {numbers_.radius * std::max({scale.x, scale.y, scale.z}), 0.0, 0.0};
	} else {
		r_shape.kind = ShapeKind::cylinder;
		r_shape.half_size = {numbers_.radius * std::max(scale.x, scale.z), 0.5 * numbers_.height * scale.y, 0.0};
	}
	return {};
}

Status ScatterRegion3D::build(thicket::Shape &r_shape) const {
	r_shape.exclude = exclude_;
	r_shape.ignore_height = ignore_height_;
	r_shape.falloff = numbers_.falloff;
	r_shape.planet = is_flat() || ignore_height_ ? planet() : Planet();
	if (is_flat()) {
		r_shape.kind = shape_ == SHAPE_POLYGON ? ShapeKind::polygon : ShapeKind::path;
		r_shape.half_size.x = shape_ == SHAPE_PATH ? 0.5 * numbers_.width : 0.0;
		build_outline(r_shape.planet, r_shape);
	} else if (const Status status = build_solid(r_shape); !status.ok()) {
		return status;
	}
	const bool is_incomplete = (shape_ == SHAPE_POLYGON && r_shape.outline.size() < 3) ||
			(shape_ == SHAPE_PATH && r_shape.outline.size() < 2);
	return is_incomplete ? Status{ErrorCode::missing, "outline", 0.0} : validate(r_shape);
}

std::optional<thicket::Shape> ScatterRegion3D::world_shape() {
	if (!is_inside_tree() || !is_visible_below_host()) {
		return std::nullopt;
	}
	thicket::Shape shape;
	const Status status = build(shape);
	if (status.code == ErrorCode::missing) {
		return std::nullopt; // The region's warnings report the missing outline.
	}
	if (std::exchange(reported_error_, status.code) != status.code) {
		report(class_name, status);
	}
	return status.ok() ? std::optional(std::move(shape)) : std::nullopt;
}

} // namespace thicket
