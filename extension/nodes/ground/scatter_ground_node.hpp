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

/// Ground that another node of the scene provides. The ground of Terrain3D and HTerrain is copied (GroundCopy). Any
/// other node needs get_height(Vector3), which is called for each position (ObjectGround). While the node is missing or
/// provides no ground, one error is printed, and existing instances stay.
class ScatterGroundNode : public ScatterGround {
	GDCLASS(ScatterGroundNode, ScatterGround)
	THICKET_GUARDED_METHODS(owner)

public:
	bool has_textures() const override;
	bool is_available() const override;
	void look_again() override { stale_ = stale_ || !telling_; }

	/// A path relative to the TerrainScatter3D that uses this ground; to the first one if there are several.
	void set_node(const godot::NodePath &p_node);
	godot::NodePath get_node() const;

	/// True if the node's methods may be called on any thread, several at once. Ignored if the ground is copied.
	void set_thread_safe(bool p_thread_safe);
	bool is_thread_safe() const;

	/// Limits the ground to this rectangle of the world, in meters of x and z. The node is not called outside of it. A
	/// rectangle without an area sets no limit. A rectangle that is not finite or has a negative size prints an error
	/// and is ignored. Has no effect if the ground is copied.
	void set_bounds(const godot::Rect2 &p_bounds);
	godot::Rect2 get_bounds() const;

	/// Whether the height `no_ground_height` (finite, compared exactly) means that the node has no ground at a
	/// position.
	void set_no_ground_enabled(bool p_enabled);
	bool is_no_ground_enabled() const;
	void set_no_ground_height(double p_height);
	double get_no_ground_height() const;

	/// A description of the kind of node that was recognized; empty if there is none.
	godot::String get_recognized() const;

protected:
	static void _bind_methods();
	std::shared_ptr<const Terrain> make_snapshot(const GroundHost &host) override;
	godot::String find_problem() override;
	godot::String find_remark() override;
	bool only_on_main_thread() override { return copy_ == nullptr && ground_ != nullptr && !thread_safe_; }
	Status sample_for(const GroundHost &host, std::span<const glm::dvec2> positions, const GroundNeeds &needs,
			std::span<Ground> r_ground) override;
	bool can_change_unreported() const override { return copy_ == nullptr; }
	void hosts_changed(bool first) override;
	void offset_changed(const GroundHost &host) override;

private:
	/// The result of checking a node: a copy, an object to call, or neither.
	struct Found {
		godot::Variant target;
		CopyAttempt attempt;
		std::shared_ptr<ObjectGround> ground;
		GroundGlance glance;
	};

	/// The ground that a host has received, for tiles that are still in progress.
	struct Given {
		std::uint64_t host = 0;
		std::weak_ptr<ObjectGround> ground;
	};

	GroundLimits limits() const;
	void find();
	Found look() const;
	void take(const Found &found);
	void take_copy(const Found &found);
	void give(const std::shared_ptr<ObjectGround> &ground);
	std::shared_ptr<const Terrain> ground_for(const GroundHost &host) const;
	godot::String problem_of(const Found &found, bool in_tree, bool usable) const;
	void set_recognized(const godot::String &p_recognized);
	void close();

	// Following the node: scatter_ground_node_follow.cpp.
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
	void copy_again();
	void tell();
	std::vector<glm::dvec3> host_offsets() const;
	std::optional<glm::dvec3> shift_since(std::span<const glm::dvec3> before) const;

	godot::NodePath node_;
	bool thread_safe_ = false;
	godot::Rect2 bounds_;
	bool no_ground_enabled_ = false;
	double no_ground_height_ = 0.0;

	/// The last usable ground: a copy, or an object in the engine's space. The object is closed when its node is freed.
	std::shared_ptr<const GroundCopy> copy_;
	std::shared_ptr<ObjectGround> ground_;
	bool present_ = false;                                            ///< True if the copied node exists.
	std::map<std::uint64_t, std::shared_ptr<const Terrain>> grounds_; ///< The ground of each host, by the host's ID.
	std::vector<glm::dvec3> offsets_;                                 ///< The offsets of all hosts, when it was copied.
	std::vector<Given> given_; ///< All objects of that node; closed when it is freed.

	bool stale_ = true;          ///< True if the node must be found.
	bool finding_ = false;       ///< True while the node is being found, which may run its script.
	bool telling_ = false;       ///< True while this object itself emits an edit.
	bool told_ = false;          ///< True if all users of the ground were notified that all of it has changed.
	bool missed_ = false;        ///< True if the ground was requested while there was none.
	bool edited_ = false;        ///< True if the plug-in has reported that some part of its ground has changed.
	std::vector<MapEdit> edits_; ///< The edits that the plug-in has reported in detail.
	GroundChanges changes_;      ///< Changes to emit.
	GroundGlance glance_;        ///< The state of the node when it was found.

	godot::String problem_;
	godot::String reported_; ///< The problem that was printed last.
	godot::String remark_;
	godot::String recognized_;
	godot::Variant followed_node_;
	godot::Variant followed_source_;
	godot::Variant followed_tree_;
};

} // namespace thicket
