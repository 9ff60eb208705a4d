#pragma once

#include "core/base/world_frame.hpp"
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

/// The scene that replaces the meshes of a layer near viewers and moving bodies.
struct SceneSettings {
	godot::Ref<godot::PackedScene> scene; ///< The scene; null if there is none.
	/// The distance in meters from a viewer or moving body within which scenes replace meshes; 0
	/// disables scenes.
	double distance = 0.0;
	godot::String name; ///< The layer's name, for error messages.

	bool operator==(const SceneSettings &other) const {
		return scene == other.scene && distance == other.distance && name == other.name;
	}
};

/// Returns the scene settings of a layer. A null layer has no scene.
SceneSettings scene_settings_of(const LayerSnapshot *layer);

/// The kind of change that a SceneRing makes to the scene of an instance.
enum class SceneEvent : std::uint8_t {
	shown, ///< The scene was added to the tree and replaces the mesh.
	/// The scene is about to leave the tree. The mesh is drawn again if the instance still exists.
	hidden,
};

/// The services that a SceneRing needs from its node. `notify` runs scripts, which may free the
/// node.
struct SceneHost {
	godot::Node3D *parent = nullptr;
	/// Hides or shows the mesh of an instance. Takes effect when this frame is drawn.
	std::function<void(const PlacedInstance &instance, bool hidden)> hide_mesh;
	std::function<godot::Ref<ScatterLayer>(std::uint32_t index)> layer_at;
	std::function<godot::Variant(std::uint64_t id)> data_of;
	std::function<void(SceneEvent event, std::uint64_t id, godot::Node3D *scene)> notify;
	/// Schedules a call to `recycle` before this frame is drawn and before the next physics step.
	std::function<void()> recycle_later;
};

/// Replaces the meshes of instances near viewers and moving bodies with scenes. Every nearby
/// instance gets a scene, even if distance thinning hides its mesh. A mesh is hidden in the frame in
/// which its scene is added and drawn again when the scene is removed. Unneeded scenes are kept in a
/// pool.
///
/// Many methods run scripts, which may remove instances, free or take a scene, or free the node.
/// The caller must keep the ring alive during these calls and must call `forget_host` when the node
/// is freed. If a script frees, takes or reparents a scene, the mesh is drawn again. The instance
/// gets a new scene only after it has been out of range.
class SceneRing : public NearRing {
public:
	explicit SceneRing(SceneHost host);
	~SceneRing() override = default;

	/// Sets the layers by their indices. If the PackedScene of a layer has changed, its previous
	/// scenes are removed step by step, nearest first.
	void set_layers(std::vector<SceneSettings> layers);

	/// Detaches the ring from the node, which it never accesses again. Call it when the node is
	/// freed along with its children.
	void forget_host() { life_ = nullptr; }

	/// Sets the positions around which scenes replace meshes. If `centers` is empty, all scenes stay,
	/// because a camera may be missing for a single frame.
	void find_changes(std::span<const glm::dvec3> centers, const InstanceWorld &world) override;
	bool step() override;
	bool settled() const override { return leaving_scenes_.empty() && queue_.settled(); }
	void drop(std::uint64_t id) override;
	void drop_if(const std::function<bool(std::uint64_t id)> &is_gone) override;
	void set_world_frame(const WorldFrame &frame) override;
	void clear() override;

	/// Takes at most `recycled_at_once` scenes of dropped instances (see `drop`) out of the tree.
	/// `step` takes the rest.
	void recycle();
	static constexpr int recycled_at_once = 128;

	/// Detects scenes that scripts have freed or reparented. Call it after a child of the node has
	/// been added or removed.
	void children_changed();

	/// Returns the scene of an instance; null if there is none.
	godot::Node3D *find(std::uint64_t id) const;

	/// Transfers ownership of an instance's scene to the caller. Returns null if there is none. The
	/// scene of a dropped instance can be taken until `recycle`. The scene stays in the tree. The
	/// mesh is drawn again unless the instance is removed.
	godot::Node3D *take(std::uint64_t id);

	std::size_t displayed_count() const { return displayed_scenes_.size(); }
	std::size_t idle_count() const { return pool_->idle_count(); }

private:
	/// Identifies an instance. The ID alone would not suffice, because layers with the same
	/// layer_id share IDs.
	struct Key {
		std::uint64_t id = 0;
		std::uint32_t layer = 0;

		friend auto operator<=>(const Key &, const Key &) = default;
	};

	struct DisplayedScene {
		PlacedInstance instance;
		godot::Ref<godot::PackedScene> scene;
		NodeHandle node;
		bool top_level = false; ///< The value of Node3D.top_level in the scene.
	};

	struct Layer {
		SceneSettings settings;
		bool is_rejected = false; ///< True if the scene cannot be used. The error has been printed.

		double distance() const { return settings.scene.is_valid() && !is_rejected ? settings.distance : 0.0; }
	};

	void update_distances();
	void move(const PlacedInstance &instance);
	bool remove_scene(const Key &key);
	bool remove_scene(const InstanceToRelease &release);
	bool remove_scene_of_removed();
	bool remove_outdated_scene();
	void add_scene(const PlacedInstance &instance);

	bool is_own_scene(const DisplayedScene &displayed_scene) const;
	godot::Transform3D transform_of(const PlacedInstance &instance) const;
	void move_node(const DisplayedScene &displayed_scene) const;
	void reject(Layer &layer);
	void show(const PlacedInstance &instance, const godot::Ref<godot::PackedScene> &scene, godot::Node3D *node);
	void return_last_to_pool();
	void notify(SceneEvent event, const DisplayedScene &displayed_scene);
	void remove_from_tree(godot::Node3D *node);

	SceneHost host_;
	std::shared_ptr<const char> life_ = std::make_shared<const char>('\0');
	std::shared_ptr<ScenePool> pool_ = std::make_shared<ScenePool>();
	std::vector<Layer> layers_;
	std::map<Key, DisplayedScene> displayed_scenes_;
	/// The scenes of dropped instances, which are still in the tree, so that callers can take them.
	std::vector<DisplayedScene> leaving_scenes_;
	std::uint64_t epoch_ = 0; ///< Incremented by `clear`.
	WorldFrame frame_;
	bool recycle_due_ = false;
	bool moving_child_ = false; ///< True while the ring adds or removes a child.
	int child_changes_ = 0;     ///< The number of child changes since `moving_child_` was set.
};

} // namespace thicket
