#pragma once

#include "core/near/near_queue.hpp"
#include "nodes/gameplay/scene_pool.hpp"
#include "nodes/layer/layer_snapshot.hpp"
#include "nodes/layer/scatter_layer.hpp"

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
	godot::Ref<godot::PackedScene> scene; ///< Null if there is none.
	double distance = 0.0; ///< Meters. A scene replaces a mesh if a viewer or body is nearer than this; 0 for never.
	godot::String name;    ///< The layer's name, for errors.

	bool operator==(const SceneLayer &other) const {
		return scene == other.scene && distance == other.distance && name == other.name;
	}
};

/// The scene settings of a layer; without a scene for null.
SceneLayer scenes_of(const LayerSnapshot *layer);

/// A change of an instance's scene by a SceneRing.
enum class SceneEvent : std::uint8_t {
	shown,  ///< It is in the tree, in place of the mesh.
	hidden, ///< It is about to leave the tree. The mesh is drawn again, if the instance still exists.
};

/// The services of a node that a SceneRing needs. `tell` runs scripts, which may free the node.
struct SceneHost {
	godot::Node3D *parent = nullptr;
	std::function<void(const PlacedInstance &instance, bool hidden)> hide_mesh; ///< In the drawing of this frame.
	std::function<godot::Ref<ScatterLayer>(std::uint32_t index)> layer_at;
	std::function<godot::Variant(std::uint64_t id)> data_of;
	std::function<void(SceneEvent event, std::uint64_t id, godot::Node3D *scene)> tell;
	std::function<void()> recycle_later; ///< Calls `recycle` before this frame is drawn and before bodies move again.
};

/// Scenes that replace meshes near viewers. Every nearby instance gets one, even if thinning does not draw its mesh. A
/// mesh is hidden in the same frame in which its scene is added, and drawn again when the scene is removed. Unneeded
/// scenes wait in a pool.
///
/// Many methods run scripts, which may remove instances, free or take a scene, or free the node. The caller keeps the
/// ring alive in the meantime, and calls `forget_host` when the node is freed. If a script has freed or taken a scene,
/// or moved it to a different parent, the mesh replaces it. The instance then gets no new scene until it has been out
/// of range.
class SceneRing : public NearRing {
public:
	explicit SceneRing(SceneHost host);
	~SceneRing() override = default;

	/// Sets the layers by their indices. If a layer has a different PackedScene now, its previous scenes are removed
	/// step by step, the nearest first.
	void set_layers(std::vector<SceneLayer> layers);

	/// Call this when the node is freed, with all its children. The ring never accesses the node again.
	void forget_host() { life_ = nullptr; }

	/// Without centers, scenes stay: a camera may be missing for a frame.
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

	/// Call this after a child of the node was added or removed. Finds scenes that scripts have taken away.
	void children_changed();

	/// The scene that replaces an instance; null if there is none.
	godot::Node3D *find(std::uint64_t id) const;

	/// Passes the ownership of an instance's scene to the caller; returns null if there is none. Until `recycle`, this
	/// includes the scene of a dropped instance. The scene stays in the tree. The mesh is drawn again, unless the
	/// instance is removed.
	godot::Node3D *take(std::uint64_t id);

	std::size_t shown_count() const { return shown_.size(); }
	std::size_t idle_count() const { return pool_->idle_count(); }

private:
	/// Needed because layers that share a layer_id share IDs.
	struct Key {
		std::uint64_t id = 0;
		std::uint32_t layer = 0;

		friend auto operator<=>(const Key &, const Key &) = default;
	};

	struct Shown {
		PlacedInstance instance;
		godot::Ref<godot::PackedScene> scene;
		NodeHandle node;
		bool top_level = false; ///< As in its scene.
	};

	struct Layer {
		SceneLayer is;
		bool refused = false; ///< True if the scene cannot be used, and the error was printed.

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
			layers_; ///< Entries in the queue that are not in shown_ get no scene until they were out of range.
	std::map<Key, Shown> shown_;
	std::vector<Shown> leaving_; ///< Still in the tree, for callers that want to take them.
	std::uint64_t epoch_ = 0;    ///< Rises with each `clear`.
	glm::dvec3 offset_{0.0};
	bool recycle_due_ = false;
	bool moving_child_ = false; ///< True while the ring itself adds or removes a child.
	int child_changes_ = 0;     ///< Changes of children that the ring has seen.
};

} // namespace thicket
