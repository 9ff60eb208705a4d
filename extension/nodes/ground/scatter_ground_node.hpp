#pragma once

#include "nodes/common/guard.hpp"
#include "nodes/ground/ground_copy.hpp"
#include "nodes/ground/object_ground.hpp"
#include "nodes/ground/scatter_ground.hpp"

#include <godot_cpp/classes/node.hpp>
#include <godot_cpp/variant/aabb.hpp>
#include <godot_cpp/variant/node_path.hpp>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace thicket {

/// Ground from another node of the scene. Copies the ground of Terrain3D, HTerrain and TerraBrush
/// nodes (GroundCopy). Any other node needs a method get_height(Vector3), which is called for each
/// position (ObjectGround). While the node is missing or provides no ground, prints an error once,
/// and existing instances stay unchanged.
class ScatterGroundNode : public ScatterGround {
	GDCLASS(ScatterGroundNode, ScatterGround)
	THICKET_GUARDED_METHODS(owner)

public:
	bool moves_with_host() const override { return false; }
	bool has_textures() const override;
	bool has_surfaces() const override { return copy_ != nullptr; }
	bool is_available() const override;
	void search_again() override { is_stale_ = is_stale_ || !is_emitting_; }

	/// Sets the path of the node, relative to the TerrainScatter3D that uses this ground, or to the
	/// first one if there are several.
	void set_node(const godot::NodePath &p_node);
	godot::NodePath get_node() const;

	/// Sets whether any number of threads may call the node's methods concurrently. Has no effect
	/// if the ground is copied.
	void set_thread_safe(bool p_thread_safe);
	bool is_thread_safe() const;

	/// Limits the ground to a rectangle of the world's x and z, in meters. The node is not called
	/// for positions outside. An empty rectangle disables the limit. A rectangle that is not finite
	/// or has a negative size prints an error and is ignored. Has no effect if the ground is
	/// copied.
	void set_bounds(const godot::Rect2 &p_bounds);
	godot::Rect2 get_bounds() const;

	/// Sets whether a height that equals `no_ground_height` in single precision means that there is
	/// no ground. Has no effect if the ground is copied.
	void set_no_ground_enabled(bool p_enabled);
	bool is_no_ground_enabled() const;
	void set_no_ground_height(double p_height);
	double get_no_ground_height() const;

	/// Describes the recognized kind of node for the inspector. Returns an empty string if there is
	/// none.
	godot::String get_recognized() const;

protected:
	static void _bind_methods();
	std::shared_ptr<const Terrain> make_snapshot(const GroundHost &host) override;
	godot::String find_problem() override;
	godot::String find_remark() override;
	bool only_on_main_thread() override {
		return copy_ == nullptr && ground_ != nullptr && (!thread_safe_ || ground_->needs_main_thread());
	}
	Status sample_for(const GroundHost &host, std::span<const glm::dvec2> positions, const GroundNeeds &needs,
			std::span<Ground> r_ground) override;
	bool can_change_unreported() const override { return copy_ == nullptr; }
	Status recheck_for(const GroundHost &host, std::span<const glm::dvec2> positions,
			std::span<std::optional<float>> r_heights) override;
	void hosts_changed(bool first) override;
	void offset_changed(const GroundHost &host) override;

private:
	/// The result of examining a node: a copy, an object to call, or neither.
	struct Examination {
		godot::Variant target;
		CopyAttempt attempt;
		std::shared_ptr<ObjectGround> ground;
		GroundFingerprint fingerprint;
	};

	/// An object that a host has received. Tiles in progress may still use it.
	struct HostObject {
		std::uint64_t host = 0;
		std::weak_ptr<ObjectGround> ground;
	};

	GroundLimits limits() const;
	void find_ground();
	Examination find_source() const;
	void apply(const Examination &examination);
	void take_copy(const Examination &examination);
	void use_object(const std::shared_ptr<ObjectGround> &ground);
	std::shared_ptr<const Terrain> ground_for(const GroundHost &host) const;
	godot::String problem_of(const Examination &examination, bool in_tree, bool is_usable) const;
	void set_recognized(const godot::String &p_recognized);
	void close();

	// These methods track the node; see scatter_ground_node_follow.cpp.
	void follow_node(godot::Node *p_target, godot::Object *p_source);
	void unfollow_node();
	void connect_signals(bool p_connect);
	void follow_frames(bool p_follow);
	void change();
	void node_gone();
	void node_moved(const godot::Transform3D &p_transform);
	void emit_area(const godot::Rect2 &p_rect);
	void area_edited(const godot::AABB &p_area);
	void maps_changed();
	void map_edited(const godot::Variant &p_x, const godot::Variant &p_z, const godot::Variant &p_width,
			const godot::Variant &p_depth, const godot::Variant &p_channel);
	void source_edited(const godot::Variant &p_first, const godot::Variant &p_second);
	void poll();
	void update_copy();
	void notify();
	std::vector<glm::dvec3> host_offsets() const;
	std::optional<glm::dvec3> shift_since(std::span<const glm::dvec3> before) const;

	godot::NodePath node_;
	bool thread_safe_ = false;
	godot::Rect2 bounds_;
	bool no_ground_enabled_ = false;
	double no_ground_height_ = 0.0;

	/// The last usable ground: either a copy or an object, which is closed when its node is freed.
	std::shared_ptr<const GroundCopy> copy_;
	std::shared_ptr<ObjectGround> ground_;
	/// True if the copied node is in the tree.
	bool is_copy_present_ = false;
	/// The ground of each host by ID.
	std::map<std::uint64_t, std::shared_ptr<const Terrain>> grounds_;
	/// The offsets of all hosts when the ground was copied.
	std::vector<glm::dvec3> offsets_;
	std::vector<HostObject> host_objects_; ///< All objects of the node that must be closed.

	bool is_stale_ = true;     ///< True if the node must be searched for.
	bool is_finding_ = false;  ///< True during a search, which may run the node's script.
	bool is_emitting_ = false; ///< True while this object emits `ground_changed`.
	/// True if, since the last search, all users have been notified that the ground has changed
	/// everywhere.
	bool are_users_notified_ = false;
	bool is_request_missed_ = false; ///< True if a host requested the ground while there was none.
	bool must_copy_again_ = false;   ///< True if the ground must be copied again.
	std::vector<MapEdit> edits_;     ///< Reported edits of known areas.
	GroundChanges changes_;          ///< Changes whose signals have not been emitted yet.
	GroundFingerprint fingerprint_;  ///< The state of the node when it was last examined.

	godot::String problem_;
	godot::String printed_problem_; ///< The last printed problem.
	godot::String remark_;
	godot::String recognized_;
	godot::Variant followed_node_;
	godot::Variant followed_source_;
	godot::Variant followed_tree_;
};

} // namespace thicket
