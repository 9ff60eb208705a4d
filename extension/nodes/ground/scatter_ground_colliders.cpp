#include "nodes/ground/scatter_ground_colliders.hpp"

#include "nodes/common/property_check.hpp"
#include "nodes/ground/collider_shapes.hpp"

#include <godot_cpp/classes/animatable_body3d.hpp>
#include <godot_cpp/classes/physics_direct_space_state3d.hpp>
#include <godot_cpp/classes/physics_ray_query_parameters3d.hpp>
#include <godot_cpp/classes/physics_server3d.hpp>
#include <godot_cpp/classes/static_body3d.hpp>
#include <godot_cpp/classes/world3d.hpp>
#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/variant/dictionary.hpp>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

using namespace godot;

namespace thicket {

namespace {

/// The depth inside a body that is not ground at which the next ray starts after a hit. The first
/// number is in meters; the second is relative to the height of the hit.
constexpr real_t body_margin = 1e-3F;
constexpr real_t relative_body_margin = 1e-6F;

/// The maximum number of bodies to skip at a position. If there are more, the position has no
/// ground.
constexpr int max_bodies = 64;

/// The precision of a hit, as a fraction of the ray's length.
constexpr double hit_error = 4e-7;

constexpr Status no_space =
		Status::missing("physics space of ScatterGroundColliders", "Add the node to a scene with a World3D");

/// Finds ground with rays straight down. Skips the bodies of instances, which are placed on the
/// ground and are not ground themselves.
class GroundRay {
public:
	/// `p_top` and `p_bottom` are world heights in meters. `offset` is the world position of the
	/// engine's origin.
	GroundRay(PhysicsDirectSpaceState3D *p_space, double p_top, double p_bottom, int64_t p_mask, glm::dvec3 offset) :
			space_(p_space), offset_(offset), top_(static_cast<real_t>(p_top - offset.y)),
			bottom_(static_cast<real_t>(p_bottom - offset.y)),
			ray_(PhysicsRayQueryParameters3D::create(Vector3(), Vector3(), static_cast<std::uint32_t>(p_mask))) {}

	/// Casts a ray at a position. Returns no ground if nothing is hit.
	Ground ground_at(glm::dvec2 position) { return ground_of(hit_at(position)); }

	/// Returns the world height of the ground, or NAN without ground. Returns nothing if a body
	/// that can move hides the ground.
	std::optional<float> static_height(glm::dvec2 position) {
		const Dictionary hit = hit_at(position);
		return hit.is_empty() || is_static(hit) ? std::optional(ground_of(hit).height) : std::nullopt;
	}

private:
	Dictionary hit_at(glm::dvec2 position) {
		const auto x = static_cast<real_t>(position.x - offset_.x);
		const auto z = static_cast<real_t>(position.y - offset_.z);
		return std::isfinite(x) && std::isfinite(z) ? first_ground(x, z) : Dictionary();
	}

	Ground ground_of(const Dictionary &hit) const {
		if (hit.is_empty()) {
			return {};
		}
		const auto point = static_cast<Vector3>(hit[position_key_]);
		const auto hit_normal = static_cast<Vector3>(hit[normal_key_]);
		const glm::vec3 normal{hit_normal.x, hit_normal.y, hit_normal.z};
		const float length = std::sqrt(glm::dot(normal, normal));
		if (!std::isfinite(length) || length == 0.0F) {
			return {};
		}
		// Back faces are ground as well. Their normals are flipped upward.
		return {static_cast<float>(point.y + offset_.y), normal / (normal.y < 0.0F ? -length : length)};
	}

	/// Returns true if the body of a hit does not move. Moving bodies such as characters and
	/// vehicles are not ground in re-checks.
	bool is_static(const Dictionary &hit) const {
		const Object *collider = hit[collider_key_];
		if (const auto *body = Object::cast_to<PhysicsBody3D>(collider)) {
			return Object::cast_to<StaticBody3D>(body) != nullptr && Object::cast_to<AnimatableBody3D>(body) == nullptr;
		}
		if (collider != nullptr && collider->is_class("SoftBody3D")) {
			return false;
		}
		return PhysicsServer3D::get_singleton()->body_get_mode(static_cast<RID>(hit[body_key_])) ==
				PhysicsServer3D::BODY_MODE_STATIC;
	}

	/// Returns the first hit that is not an instance. Relies on rays not hitting bodies in which
	/// they start.
	Dictionary first_ground(real_t x, real_t z) {
		ray_->set_to(Vector3(x, bottom_, z));
		real_t top = top_;
		for (int skipped_count = 0; skipped_count < max_bodies; ++skipped_count) {
			ray_->set_from(Vector3(x, top, z));
			const Dictionary hit = space_->intersect_ray(ray_);
			if (hit.is_empty() || !is_instance(hit)) {
				return hit;
			}
			top = static_cast<Vector3>(hit[position_key_]).y;
			top -= std::max(body_margin, relative_body_margin * std::abs(top));
		}
		return {};
	}

	bool is_instance(const Dictionary &hit) {
		const auto id = static_cast<std::uint64_t>(hit[id_key_]);
		if (id == collider_id_) {
			// The last hit was on the same body.
			return collider_is_scatter_;
		}
		const Object *collider = hit[collider_key_];
		collider_id_ = id;
		collider_is_scatter_ = collider != nullptr &&
				(collider->is_class("TerrainScatter3D") || belongs_to_scatter(Object::cast_to<Node>(collider)));
		return collider_is_scatter_;
	}

	PhysicsDirectSpaceState3D *space_;
	glm::dvec3 offset_;
	real_t top_;
	real_t bottom_;
	Ref<PhysicsRayQueryParameters3D> ray_;
	Variant position_key_ = "position";
	Variant normal_key_ = "normal";
	Variant body_key_ = "rid";
	Variant id_key_ = "collider_id";
	Variant collider_key_ = "collider";
	std::uint64_t collider_id_ = 0; ///< The collider of the last hit.
	bool collider_is_scatter_ = false;
};

} // namespace

std::shared_ptr<const Terrain> ScatterGroundColliders::make_snapshot(const GroundHost &) {
	report(class_name, check());
	return nullptr;
}

String ScatterGroundColliders::find_problem() {
	if (const Status status = check(); !status.ok()) {
		return sentence(class_name, status);
	}
	return collision_mask_ != 0 ? String()
								: "ScatterGroundColliders.collision_mask is 0, so no body is ground. Select a layer.";
}

Status ScatterGroundColliders::check() const {
	return ray_top_ > ray_bottom_ ? Status{}
								  : Status{ErrorCode::inverted, "ray_bottom", ray_bottom_, {},
											at_most(ray_top_, "ray_top"), "Lower ray_bottom or raise ray_top"};
}

bool ScatterGroundColliders::is_available() const {
	return first_node() != nullptr && first_node()->is_inside_tree() && check().ok();
}

PhysicsDirectSpaceState3D *ScatterGroundColliders::space_of(const GroundHost &host) const {
	const bool in_scene = host.node != nullptr && host.node->is_inside_tree() && check().ok();
	const Ref<World3D> world = in_scene ? host.node->get_world_3d() : Ref<World3D>();
	return world.is_valid() ? world->get_direct_space_state() : nullptr;
}

Status ScatterGroundColliders::sample_for(const GroundHost &host, std::span<const glm::dvec2> positions,
		const GroundNeeds &, std::span<Ground> r_ground) {
	PhysicsDirectSpaceState3D *space = space_of(host);
	if (space == nullptr) {
		return no_space;
	}
	GroundRay ray(space, ray_top_, ray_bottom_, collision_mask_, host.offset);
	for (std::size_t i = 0; i < positions.size(); ++i) {
		r_ground[i] = ray.ground_at(positions[i]);
	}
	return {};
}

Status ScatterGroundColliders::recheck_for(
		const GroundHost &host, std::span<const glm::dvec2> positions, std::span<std::optional<float>> r_heights) {
	PhysicsDirectSpaceState3D *space = space_of(host);
	if (space == nullptr) {
		return no_space;
	}
	GroundRay ray(space, ray_top_, ray_bottom_, collision_mask_, host.offset);
	for (std::size_t i = 0; i < positions.size(); ++i) {
		r_heights[i] = ray.static_height(positions[i]);
		const glm::dvec2 engine_position = positions[i] - glm::dvec2(host.offset.x, host.offset.z);
		if (r_heights[i] && !std::isfinite(*r_heights[i]) &&
				!volumes_.is_loaded(engine_position, ray_bottom_ - host.offset.y, ray_top_ - host.offset.y)) {
			r_heights[i] = std::nullopt;
		}
	}
	return {};
}

double ScatterGroundColliders::recheck_tolerance() const {
	return ScatterGround::recheck_tolerance() + hit_error * (ray_top_ - ray_bottom_);
}

void ScatterGroundColliders::set_collision_mask(int64_t p_mask) {
	if (accept_number(class_name, "collision_mask", static_cast<double>(p_mask), 0.0,
				std::numeric_limits<std::uint32_t>::max())) {
		collision_mask_ = p_mask;
		start_over();
		emit_changed();
	}
}

int64_t ScatterGroundColliders::get_collision_mask() const { return collision_mask_; }

void ScatterGroundColliders::set_ray_top(double p_height) {
	if (accept_number(class_name, "ray_top", p_height, -height_limit, height_limit)) {
		ray_top_ = p_height;
		emit_changed();
	}
}

double ScatterGroundColliders::get_ray_top() const { return ray_top_; }

void ScatterGroundColliders::set_ray_bottom(double p_height) {
	if (accept_number(class_name, "ray_bottom", p_height, -height_limit, height_limit)) {
		ray_bottom_ = p_height;
		emit_changed();
	}
}

double ScatterGroundColliders::get_ray_bottom() const { return ray_bottom_; }

void ScatterGroundColliders::set_rays_per_frame(int64_t p_rays) {
	if (accept_number(class_name, "rays_per_frame", static_cast<double>(p_rays), 1.0, 1e6)) {
		rays_per_frame_ = p_rays;
	}
}

int64_t ScatterGroundColliders::get_rays_per_frame() const { return rays_per_frame_; }

void ScatterGroundColliders::_bind_methods() {
	using Self = ScatterGroundColliders;
	bind_guarded<&Self::set_collision_mask>(D_METHOD("set_collision_mask", "mask"));
	bind_guarded<&Self::get_collision_mask>(D_METHOD("get_collision_mask"));
	bind_guarded<&Self::set_ray_top>(D_METHOD("set_ray_top", "height"));
	bind_guarded<&Self::get_ray_top>(D_METHOD("get_ray_top"));
	bind_guarded<&Self::set_ray_bottom>(D_METHOD("set_ray_bottom", "height"));
	bind_guarded<&Self::get_ray_bottom>(D_METHOD("get_ray_bottom"));
	bind_guarded<&Self::set_rays_per_frame>(D_METHOD("set_rays_per_frame", "rays"));
	bind_guarded<&Self::get_rays_per_frame>(D_METHOD("get_rays_per_frame"));
	bind_guarded<&Self::source_changed>(ThreadUse::relayed, D_METHOD("_source_changed", "source"));
	bind_guarded<&Self::node_added>(ThreadUse::relayed, D_METHOD("_node_added", "node"));
	ADD_PROPERTY(PropertyInfo(Variant::INT, "collision_mask", PROPERTY_HINT_LAYERS_3D_PHYSICS), "set_collision_mask",
			"get_collision_mask");
	ADD_PROPERTY(
			PropertyInfo(Variant::FLOAT, "ray_top", PROPERTY_HINT_RANGE, "-1000,9000,0.1,or_less,or_greater,suffix:m"),
			"set_ray_top", "get_ray_top");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "ray_bottom", PROPERTY_HINT_RANGE,
						 "-1000,9000,0.1,or_less,or_greater,suffix:m"),
			"set_ray_bottom", "get_ray_bottom");
	ADD_PROPERTY(PropertyInfo(Variant::INT, "rays_per_frame", PROPERTY_HINT_RANGE, "1,5000,1,or_greater"),
			"set_rays_per_frame", "get_rays_per_frame");
}

} // namespace thicket
