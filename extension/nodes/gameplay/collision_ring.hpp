#pragma once

#include "core/near/near_queue.hpp"
#include "nodes/gameplay/collision_shapes.hpp"

#include <godot_cpp/variant/transform3d.hpp>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <unordered_map>
#include <vector>

namespace thicket {

/// How the instances of a layer collide.
struct CollisionLayer {
	ShapeSource shape;
	double distance = 0.0; ///< Meters; 0 for no bodies.

	/// In the format of the bodies.
	struct Settings {
		std::int64_t layer = 1;
		std::int64_t mask = 1;
		double friction = 1.0; ///< Negative for a rough material, as in StaticBody3D.
		double bounce = 0.0;   ///< Negative for an absorbent material.

		friend bool operator==(const Settings &, const Settings &) = default;
	} settings;
};

/// The collision settings of a layer; without bodies for null.
CollisionLayer collision_of(const LayerSnapshot *layer);

/// A static body of the PhysicsServer3D for each instance near a viewer or another body. The bodies belong to the node:
/// the node is the `collider` in collisions, and the body's RID identifies the instance.
///
/// A removed body loses its shape immediately, so nothing collides with it any more. It leaves the physics space in the
/// next frame or later. The physics server therefore notifies areas and bodies even if a body was removed in the middle
/// of its signals. A removed body rests for some frames before it is reused for a different instance; until then its
/// RID identifies the previous one.
///
/// After a change, `step` works on a few bodies at a time, those nearest to the viewers first. Such changes are a new
/// seed, layers without collision, different shapes, and a different world offset. Three calls do not wait for `step`:
/// `drop`, `drop_if`, and `set_world_offset` for bodies near the viewers.
class CollisionRing : public NearRing {
public:
	CollisionRing() = default;
	CollisionRing(const CollisionRing &) = delete;
	CollisionRing &operator=(const CollisionRing &) = delete;
	~CollisionRing() override { clear(); }

	/// Sets the physics space of the bodies, and the object that collisions report. If the space is different, frees
	/// all bodies.
	void set_space(const godot::RID &space, std::uint64_t node_id);

	/// The bodies are updated step by step.
	void set_layers(std::vector<CollisionLayer> layers);

	void look_around(std::span<const glm::dvec3> centers, const InstanceWorld &world) override;
	bool step() override;
	bool settled() const override { return !space_.is_valid() || queue_.settled(); }
	void drop(std::uint64_t id) override;
	void drop_if(const std::function<bool(std::uint64_t id)> &gone) override;
	void set_world_offset(glm::dvec3 offset) override;
	void clear() override;

	/// The instance that a body represents, or 0. A removed body still represents its last instance for some frames.
	std::uint64_t instance_of(const godot::RID &body) const;

	/// Bodies in use.
	std::size_t body_count() const { return owners_.size() - pool_.size(); }
	std::size_t pooled_count() const { return pool_.size(); }

	/// The largest number of bodies that wait for reuse, not counting those that still rest.
	static constexpr std::size_t max_pooled = 256;
	/// The number of frames that they rest.
	static constexpr std::uint64_t rest_frames = 128;

	/// The largest number of bodies that a step frees, moves or takes out of the space, for each of these kinds of
	/// work. A step takes some ten microseconds.
	static constexpr int most_per_step = 16;

	/// The largest number of bodies that `set_world_offset` moves immediately: those nearest to the viewers, within
	/// some meters.
	static constexpr std::size_t moved_at_once = 128;
	static constexpr double moved_reach = 16.0;

private:
	/// Has neither RID nor shapes if there is nothing to collide with: if the mesh has no volume, or the instance is
	/// flat.
	struct Body {
		PlacedInstance instance;
		godot::RID rid;
		std::vector<CollisionShapes::Placed> shapes;
		glm::mat3 rotation{1.0f};
		glm::dvec3 offset{0.0};             ///< The world offset that it is placed with.
		std::uint64_t settings_version = 0; ///< The layer's settings that it was created with.
		std::uint64_t shape_version = 0;
	};

	struct Pooled {
		godot::RID rid;
		std::uint64_t fell_at = 0; ///< The frame in which it was removed.
	};

	struct Layer {
		CollisionLayer is;
		std::uint64_t settings_version = 0; ///< Each version gets a new number with every change.
		std::uint64_t shape_version = 0;
		std::unordered_map<std::uint64_t, Body> bodies; ///< By the instance's ID.
	};

	void stand(const PlacedInstance &instance);
	void fall(std::uint32_t layer, std::uint64_t id);
	void leave(const Leaving &leaving);
	bool remove_some();
	bool renew_some();
	void renew(const PlacedInstance &instance);
	void apply(const CollisionLayer::Settings &settings, const godot::RID &body);
	void place(Body &r_body);
	godot::RID take_body();
	bool rested(const Pooled &pooled) const { return pooled.fell_at + rest_frames <= frame_; }
	bool tidy_some();

	godot::RID space_;
	std::uint64_t node_id_ = 0;
	glm::dvec3 offset_{0.0};
	std::vector<glm::dvec3> offsets_before_; ///< Offsets that some bodies may still be placed with.
	std::uint64_t last_version_ = 0;
	std::vector<Layer> layers_; ///< The last layers may be removed from the node already, until all bodies are freed.
	CollisionShapes shapes_;
	std::deque<Pooled> pool_;        ///< Without a shape, the oldest first.
	std::size_t still_in_space_ = 0; ///< The number of bodies at the end of `pool_` that are still in the space.
	std::uint64_t frame_ = 0;
	std::unordered_map<std::int64_t, std::uint64_t> owners_; ///< Instance IDs, by the IDs of all bodies' RIDs.
};

} // namespace thicket
