#pragma once

#include "core/near/near_queue.hpp"
#include "nodes/gameplay/scene_pool.hpp"
#include "nodes/layer/layer_snapshot.hpp"

#include <godot_cpp/variant/string.hpp>

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <utility>
#include <vector>

namespace thicket {

/// The scenes of a layer.
struct SceneLayer {
	godot::Ref<godot::PackedScene> scene; ///< Null for none.
	double distance = 0.0; ///< Meters to the nearest viewer or body within which they stand; 0 for never.
	godot::String name;    ///< Of the layer, for errors.

	bool operator==(const SceneLayer &other) const {
		return scene == other.scene && distance == other.distance && name == other.name;
	}
};

/// What a layer says of scenes; none for null.
SceneLayer scenes_of(const LayerSnapshot *layer);

/// What a SceneRing has done with an instance's scene.
enum class SceneEvent : std::uint8_t {
	shown,  ///< It stands in the tree, in place of the mesh.
	hidden, ///< It is about to leave the tree. The mesh is back, if the instance still stands.
};

/// What a SceneRing needs of the node that it works for. `tell` runs scripts, which may free the node.
struct SceneHost {
	godot::Node3D *parent = nullptr;
	std::function<void(const PlacedInstance &instance, bool hidden)> hide_mesh; ///< In the picture of this frame.
	std::function<godot::Variant(std::uint64_t id)> data_of;
	std::function<void(SceneEvent event, std::uint64_t id, godot::Node3D *scene)> tell;
	std::function<void()> recycle_later; ///< Calls `recycle` before this frame is drawn and before bodies move again.
};

/// Scenes in place of the meshes that are near: one for every instance that stands, also for one that thinning does not draw. The mesh
/// goes in the frame in which the scene comes, and the other way round. Scenes that are not needed wait in a pool.
///
/// Scripts run in the middle of it, and may change anything: remove instances, free a scene, take one, free the node. Whoever
/// calls the ring keeps it alive meanwhile, and calls `forget_host` when the node goes. A scene that a script has freed, taken
/// or moved to another parent gives way to the mesh, and the instance gets no other one until it has been out of range.
class SceneRing : public NearRing {
public:
	explicit SceneRing(SceneHost host);
	~SceneRing() override = default;

	/// The layers by their indices. Scenes of a PackedScene that is not the one of their layer leave step by step, nearest first.
	void set_layers(std::vector<SceneLayer> layers);

	/// The node is gone, and all its children with it: nothing of it is touched from now on.
	void forget_host() { life_ = nullptr; }

	/// Without anybody to be near to, what stands stays: a camera may be gone for a frame.
	void look_around(std::span<const glm::dvec3> centers, const InstanceWorld &world) override;
	bool step() override;
	bool settled() const override { return leaving_.empty() && queue_.settled(); }
	void drop(std::uint64_t id) override;
	void drop_if(const std::function<bool(std::uint64_t id)> &gone) override;
	void set_world_offset(glm::dvec3 offset) override;
	void clear() override;

	/// Takes scenes of dropped instances out of the tree, at most `recycled_at_once`; `step` takes the rest.
	void recycle();
	static constexpr int recycled_at_once = 128;

	/// A child of the node has come or gone: looks for scenes that scripts have taken away.
	void children_changed();

	/// The scene that stands for an instance; null for none.
	godot::Node3D *find(std::uint64_t id) const;

	/// Hands the scene of an instance to the caller; null for none. Also one whose instance was dropped, until `recycle`. It stays where
	/// it is in the tree; the mesh comes back, unless the instance is removed.
	godot::Node3D *take(std::uint64_t id);

	std::size_t shown_count() const { return shown_.size(); }
	std::size_t idle_count() const { return pool_->idle_count(); }

private:
	/// Layers that share a layer_id share ids.
	struct Key {
		std::uint64_t id = 0;
		std::uint32_t layer = 0;

		friend auto operator<=>(const Key &, const Key &) = default;
	};

	struct Shown {
		PlacedInstance instance;
		godot::Ref<godot::PackedScene> scene;
		NodeHandle node;
		bool top_level = false; ///< As its scene has it.
	};

	struct Layer {
		SceneLayer is;
		bool refused = false; ///< The scene is of no use, and that was said.

		double distance() const { return is.scene.is_valid() && !refused ? is.distance : 0.0; }
	};

	void update_distances();
	void move(const PlacedInstance &instance);
	bool leave(const Key &key);
	bool leave(const Leaving &leaving);
	bool leave_gone();
	bool leave_outdated();
	void enter(const PlacedInstance &instance);

	bool ours(const Shown &shown) const;
	godot::Transform3D transform_of(const PlacedInstance &instance) const;
	void move_node(const Shown &shown) const;
	void refuse(Layer &layer);
	void show(const PlacedInstance &instance, const godot::Ref<godot::PackedScene> &scene, godot::Node3D *node);
	void put_last_back();
	void tell(SceneEvent event, const Shown &shown);
	void take_out(godot::Node3D *node);

	SceneHost host_;
	std::shared_ptr<const char> life_ = std::make_shared<const char>('\0');
	std::shared_ptr<ScenePool> pool_ = std::make_shared<ScenePool>();
	std::vector<Layer>
			layers_; ///< What the queue holds without an entry in shown_ is to have no scene until it was out of range.
	std::map<Key, Shown> shown_;
	std::vector<Shown> leaving_; ///< Still in the tree, for those who want to take them.
	std::uint64_t epoch_ = 0;    ///< Rises with each `clear`.
	glm::dvec3 offset_{0.0};
	bool recycle_due_ = false;
	bool moving_child_ = false; ///< The ring itself adds or removes a child,
	int child_changes_ = 0;     ///< and so many changes were seen since it began to.
};

} // namespace thicket
