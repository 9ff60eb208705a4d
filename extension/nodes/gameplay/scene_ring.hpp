#pragma once

#include "core/near/near_set.hpp"
#include "nodes/gameplay/near_ring.hpp"
#include "nodes/gameplay/scene_pool.hpp"
#include "nodes/layer/layer_snapshot.hpp"

#include <godot_cpp/variant/string.hpp>

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <unordered_set>
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
/// Scripts run in the middle of it, and may change anything: remove instances, free a scene, take one, free the node with the
/// ring. After a step the caller has to ask `lifeline` before it touches the ring again. A scene that a script has freed, taken or
/// moved to another parent gives way to the mesh, and the instance gets no other one until it has been out of range.
class SceneRing : public NearRing {
public:
	explicit SceneRing(SceneHost host);
	~SceneRing() override = default;

	/// The layers by their places. Scenes of another PackedScene than their layer has now leave.
	void set_layers(std::vector<SceneLayer> layers);

	void look_around(std::span<const glm::dvec3> centers, const InstanceWorld &world) override;
	bool step() override;
	bool settled() const override;
	void drop(std::uint64_t id) override;
	void set_world_offset(glm::dvec3 offset) override;
	void clear() override;

	/// Takes the scenes of dropped instances out of the tree.
	void recycle();

	/// A child of the node has come or gone: looks for scenes that scripts have taken away.
	void children_changed();

	/// The scene that stands for an instance; null for none.
	godot::Node3D *find(std::uint64_t id) const;

	/// Hands the scene of an instance to the caller; null for none. Also one whose instance was dropped, until `recycle`. It stays where
	/// it is in the tree; the mesh comes back, unless the instance is removed.
	godot::Node3D *take(std::uint64_t id);

	std::size_t shown_count() const { return shown_.size(); }
	std::size_t idle_count() const { return pool_->idle_count(); }

	/// Expires with the ring.
	std::weak_ptr<const void> lifeline() const { return life_; }

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

	struct Place {
		SceneLayer layer;
		NearSet near; ///< Without an entry in shown_: what is to have no scene until it was out of range.
		NearChanges changes;
		std::size_t left = 0;    ///< How many of changes.leave,
		std::size_t entered = 0; ///< and of changes.enter are done.
		bool refused = false;    ///< The scene is of no use, and that was said.
	};

	void look(std::uint32_t at, std::span<const glm::dvec3> centers, const InstanceWorld &world);
	void move_changed(std::uint32_t at);
	bool leave_step(std::uint32_t at);
	bool enter_step(std::uint32_t at);

	bool ours(const Shown &shown) const;
	godot::Transform3D transform_of(const PlacedInstance &instance) const;
	void place_node(const Shown &shown) const;
	void refuse(Place &place);
	void show(const PlacedInstance &instance, const godot::Ref<godot::PackedScene> &scene, godot::Node3D *node);
	void move(Shown &shown, const PlacedInstance &instance);
	void put_last_back();
	void tell(SceneEvent event, const Shown &shown);
	void take_out(godot::Node3D *node);

	SceneHost host_;
	std::shared_ptr<const char> life_ = std::make_shared<const char>('\0');
	std::shared_ptr<ScenePool> pool_ = std::make_shared<ScenePool>();
	std::vector<Place> places_;
	std::map<Key, Shown> shown_;
	std::vector<Shown> leaving_;                    ///< Still in the tree, for those who want to take them.
	std::unordered_set<std::uint64_t> dropped_ids_; ///< Since the last look, while something was to enter.
	std::vector<PlacedInstance> standing_;
	std::vector<glm::dvec3> centers_;
	const InstanceWorld *world_ = nullptr; ///< That was looked at last.
	std::uint64_t version_ = 0;            ///< Of the world, at the last look; 0 if there has to be another one.
	std::uint64_t epoch_ = 0;              ///< Rises with each `clear`.
	int frames_ = 0;                       ///< Since then.
	glm::dvec3 offset_{0.0};
	bool recycle_due_ = false;
	bool moving_child_ = false; ///< The ring itself adds or removes a child,
	int child_changes_ = 0;     ///< and so many changes were seen since it began to.
};

} // namespace thicket
