#pragma once

#include "core/base/world_frame.hpp"
#include "core/near/near_queue.hpp"
#include "nodes/gameplay/collision_shapes.hpp"

#include <godot_cpp/variant/transform3d.hpp>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

namespace thicket {

/// The collision shapes and settings of a layer's instances.
struct CollisionLayer {
	ShapeSource shape;
	double distance = 0.0; ///< Bodies exist within this many meters of a viewer or moving body. 0 means no bodies.

	/// The properties of each body, as in StaticBody3D.
	struct Settings {
		std::int64_t layer = 1;
		std::int64_t mask = 1;
		double friction = 1.0; ///< The friction. A negative value means a rough PhysicsMaterial.
		double bounce = 0.0;   ///< The bounce. A negative value means an absorbent PhysicsMaterial.

		friend bool operator==(const Settings &, const Settings &) = default;
	} settings;
};

/// Returns the collision settings of a layer. A null layer has no bodies.
CollisionLayer collision_of(const LayerSnapshot *layer);

/// Keeps a static PhysicsServer3D body for each instance near a viewer or a moving body. In
/// collision results, `collider` is the node, and the body's RID identifies the instance.
///
/// A removed body loses its shapes immediately, so nothing collides with it anymore. It leaves the
/// physics space in the next frame or later. The delay lets the physics server notify areas and
/// bodies even if a signal handler removed the body. No instance reuses the body for `rest_frames`
/// after its removal. Until it is reused, its RID identifies the previous instance.
///
/// Changes to the seed, the shapes, the world frame or the collision settings take effect
/// gradually. Each call to `step` updates a few bodies, those nearest to the viewers first. `drop`,
/// `drop_if`, `clear` and changes to the space take effect immediately, and so does
/// `set_world_frame` for bodies near the viewers. If the world moves every frame, bodies farther
/// away are moved in rounds. Each lags behind by at most one round.
class CollisionRing : public NearRing {
public:
	CollisionRing() = default;
	CollisionRing(const CollisionRing &) = delete;
	CollisionRing &operator=(const CollisionRing &) = delete;
	~CollisionRing() override { clear(); }

	/// Sets the physics space of the bodies, and the object that collisions report. If either
	/// differs from the current one, frees all bodies.
	void set_space(const godot::RID &space, std::uint64_t node_id);

	/// Sets the layers by their indices. `step` updates the bodies.
	void set_layers(std::vector<CollisionLayer> layers);

	void find_changes(std::span<const glm::dvec3> centers, const InstanceWorld &world) override;
	bool step() override;
	bool settled() const override {
		return !space_.is_valid() ||
				(queue_.settled() && next_to_move_ == placed_bodies_.size() && round_frame_ == world_frame_);
	}
	void drop(std::uint64_t id) override;
	void drop_if(const std::function<bool(std::uint64_t id)> &is_gone) override;
	void set_world_frame(const WorldFrame &frame) override;
	void clear() override;

	/// Returns the ID of the instance that a body represents; 0 if the body is unknown. A removed
	/// body represents its last instance until it is reused.
	std::uint64_t instance_of(const godot::RID &body) const;

	/// Returns the number of bodies in use.
	std::size_t body_count() const { return instance_ids_.size() - pool_.size(); }
	std::size_t pooled_count() const { return pool_.size(); }

	/// The maximum number of bodies to keep for reuse, not counting those that are within
	/// `rest_frames` of their removal.
	static constexpr std::size_t max_pooled = 256;
	/// The number of frames for which a removed body is not reused.
	static constexpr std::uint64_t rest_frames = 128;

	/// The maximum number of bodies per step for each kind of work: removing, updating, moving and
	/// tidying up. Such a step takes tens of microseconds.
	static constexpr int max_per_step = 16;

	/// The maximum number of bodies that `set_world_frame` moves immediately: those nearest to the
	/// viewers, within `moved_radius` meters.
	static constexpr std::size_t max_moved_immediately = 128;
	static constexpr double moved_radius = 16.0;

private:
	/// The body of an instance. It has no RID and no shapes if the mesh has no volume or the
	/// instance is flat.
	struct Body {
		PlacedInstance instance;
		godot::RID rid;
		std::vector<CollisionShapes::PlacedShape> shapes;
		glm::mat3 rotation{1.0f};
		WorldFrame frame; ///< The world frame of the body's current transform.
		/// The version of the layer's settings that was applied to the body.
		std::uint64_t settings_version = 0;
		std::uint64_t shape_version = 0;
		std::size_t slot = 0; ///< The index in `placed_bodies_`, if the body has a RID.
	};

	struct PooledBody {
		godot::RID rid;
		std::uint64_t removed_frame = 0; ///< The frame in which the body was removed.
	};

	struct Layer {
		CollisionLayer config;
		// The versions of the settings and of the shape. Each change assigns a number that is
		// unique in the ring.
		std::uint64_t settings_version = 0;
		std::uint64_t shape_version = 0;
		std::unordered_map<std::uint64_t, Body> bodies; ///< The bodies of the layer's instances, keyed by instance ID.
	};

	void create_body(const PlacedInstance &instance);
	void remove_body(std::uint32_t layer, std::uint64_t id);
	void remove_released(const InstanceToRelease &release);
	bool remove_some();
	bool renew_some();
	bool move_some();
	void unlist(const Body &body);
	void find_nearest(std::span<const glm::dvec3> positions);
	void renew(std::uint32_t index, std::uint64_t id);
	void apply(const CollisionLayer::Settings &settings, const godot::RID &body);
	void place(Body &r_body);
	godot::RID take_body();
	bool is_reusable(const PooledBody &body) const { return body.removed_frame + rest_frames <= frame_; }
	bool tidy_pool();

	godot::RID space_;
	std::uint64_t node_id_ = 0;
	WorldFrame world_frame_;
	/// Earlier world frames that some bodies may still be placed with.
	std::vector<WorldFrame> earlier_frames_;
	/// The bodies that have a RID, in the order in which a round of moves visits them.
	std::vector<Body *> placed_bodies_;
	std::size_t next_to_move_ = 0;             ///< The index in `placed_bodies_` at which the round continues.
	WorldFrame round_frame_;                   ///< The world frame when the current round of moves began.
	std::vector<NearHeld> nearest_;            ///< The bodies that `set_world_frame` moves immediately.
	std::vector<glm::dvec3> search_positions_; ///< The positions around which `nearest_` was found.
	std::uint64_t search_frame_ = 0;           ///< The frame in which `nearest_` was found.
	std::uint64_t last_version_ = 0;
	/// The layers by index. Removed layers stay until their bodies are freed.
	std::vector<Layer> layers_;
	CollisionShapes shapes_;
	/// Removed bodies without shapes, oldest first.
	std::deque<PooledBody> pool_;
	/// The number of bodies at the end of `pool_` that are still in the space.
	std::size_t in_space_count_ = 0;
	std::uint64_t frame_ = 0;
	/// The instance that each body represents: maps the ID of the body's RID to an instance ID.
	std::unordered_map<std::int64_t, std::uint64_t> instance_ids_;
};

} // namespace thicket
