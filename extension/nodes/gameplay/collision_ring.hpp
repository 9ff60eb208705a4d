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

	/// As the bodies take them.
	struct Settings {
		std::int64_t layer = 1;
		std::int64_t mask = 1;
		double friction = 1.0; ///< Negative for a rough one, as StaticBody3D hands it over,
		double bounce = 0.0;   ///< and for one that absorbs.

		friend bool operator==(const Settings &, const Settings &) = default;
	} settings;
};

/// What a layer says of bodies; none for null.
CollisionLayer collision_of(const LayerSnapshot *layer);

/// A static body of the PhysicsServer3D for each instance near a viewer or another body. The bodies belong to the node: it is the
/// `collider` of what hits them, and the body's RID names the instance.
///
/// A body that goes loses its shape at once, and nothing meets it from then on. It leaves the physics space in the next frame or later, so
/// that areas and bodies hear of it even where it went in the middle of the physics server's signals, and rests for some frames
/// before it is used for a different instance: until then its RID names the one that has gone.
///
/// Whatever changes, `step` works on a few bodies at a time, those nearest to the viewers first: a new seed, layers without collision,
/// different shapes, a different world offset. These do not wait for it: `drop`, `drop_if`, and `set_world_offset` for bodies near the viewers.
class CollisionRing : public NearRing {
public:
	CollisionRing() = default;
	CollisionRing(const CollisionRing &) = delete;
	CollisionRing &operator=(const CollisionRing &) = delete;
	~CollisionRing() override { clear(); }

	/// The physics space to stand in, and the object that bodies lead to. Frees what stands in another one.
	void set_space(const godot::RID &space, std::uint64_t node_id);

	/// The bodies follow step by step.
	void set_layers(std::vector<CollisionLayer> layers);

	void look_around(std::span<const glm::dvec3> centers, const InstanceWorld &world) override;
	bool step() override;
	bool settled() const override { return !space_.is_valid() || queue_.settled(); }
	void drop(std::uint64_t id) override;
	void drop_if(const std::function<bool(std::uint64_t id)> &gone) override;
	void set_world_offset(glm::dvec3 offset) override;
	void clear() override;

	/// The instance that a body stands for, or stood for until some frames ago; 0 for none.
	std::uint64_t instance_of(const godot::RID &body) const;

	/// Bodies that stand.
	std::size_t body_count() const { return owners_.size() - pool_.size(); }
	std::size_t pooled_count() const { return pool_.size(); }

	/// The most bodies that wait for their next use, apart from those that rest,
	static constexpr std::size_t max_pooled = 256;
	/// and the frames that they rest.
	static constexpr std::uint64_t rest_frames = 128;

	/// The most bodies of a kind that a step frees, moves or takes out of the space: some ten microseconds.
	static constexpr int most_per_step = 16;

	/// Bodies that follow a new world offset in the call itself: those nearest to the viewers, within some meters.
	static constexpr std::size_t moved_at_once = 128;
	static constexpr double moved_reach = 16.0;

private:
	/// Without RID and shapes where there is nothing to bump into: a mesh without a volume, an instance that is flat.
	struct Body {
		PlacedInstance instance;
		godot::RID rid;
		std::vector<CollisionShapes::Placed> shapes;
		glm::mat3 rotation{1.0f};
		glm::dvec3 offset{0.0};             ///< The world offset that it is placed by,
		std::uint64_t settings_version = 0; ///< and of its layer, what it was made by.
		std::uint64_t shape_version = 0;
	};

	struct Pooled {
		godot::RID rid;
		std::uint64_t fell_at = 0; ///< Frame.
	};

	struct Layer {
		CollisionLayer is;
		std::uint64_t settings_version = 0; ///< Each a new number with every change.
		std::uint64_t shape_version = 0;
		std::unordered_map<std::uint64_t, Body> bodies; ///< By the instance's id.
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
	std::vector<glm::dvec3> offsets_before_; ///< By which some bodies may still be placed.
	std::uint64_t last_version_ = 0;
	std::vector<Layer> layers_; ///< The last ones may be gone from the node, and let go of their bodies.
	CollisionShapes shapes_;
	std::deque<Pooled> pool_;        ///< Without a shape, the longest there first.
	std::size_t still_in_space_ = 0; ///< The last so many of them.
	std::uint64_t frame_ = 0;
	std::unordered_map<std::int64_t, std::uint64_t> owners_; ///< Ids of instances by those of all bodies' RIDs.
};

} // namespace thicket
