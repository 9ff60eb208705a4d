#pragma once

#include "nodes/common/guard.hpp"
#include "nodes/terrain/object_ground.hpp"
#include "nodes/terrain/scatter_terrain.hpp"

#include <godot_cpp/classes/node.hpp>
#include <godot_cpp/variant/aabb.hpp>
#include <godot_cpp/variant/node_path.hpp>

#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace thicket {

/// Ground that another node of the scene gives: Terrain3D, HTerrain, or anything that has get_height(Vector3). See
/// ObjectGround for the methods. While the node is away or gives no ground, one error says so, and what stands stays.
class ScatterTerrainObject : public ScatterTerrain {
	GDCLASS(ScatterTerrainObject, ScatterTerrain)
	THICKET_GUARDED_METHODS

public:
	bool has_textures() const override { return ground_ != nullptr && ground_->has_textures(); }
	bool is_available() const override;
	void look_again() override { stale_ = stale_ || !telling_; }

	/// From the TerrainScatter3D that uses this ground; of several, from the first.
	void set_node(const godot::NodePath &p_node);
	godot::NodePath get_node() const;

	/// True if the node's methods may be called on any thread, several at once.
	void set_thread_safe(bool p_thread_safe);
	bool is_thread_safe() const;

protected:
	static void _bind_methods();
	std::shared_ptr<const Terrain> make_snapshot(const GroundHost &host) override;
	godot::String find_problem() override;
	bool only_on_main_thread() override { return !thread_safe_ && ground_ != nullptr; }
	Status sample_for(const GroundHost &host, std::span<const glm::dvec2> positions,
			std::span<const std::int32_t> textures, std::span<Ground> r_ground) override;
	void hosts_changed(bool first) override;
	void offset_changed(const GroundHost &host) override;

private:
	void find();
	void take(const godot::Variant &p_target, const std::shared_ptr<ObjectGround> &found);
	std::shared_ptr<const ObjectGround> ground_for(const GroundHost &host) const;
	godot::String problem_of(const godot::Node *p_target, bool p_usable) const;
	void follow(godot::Node *p_target);
	void unfollow();
	void connect_signals(bool p_connect);
	void close();
	void change();
	void node_gone();
	void node_moved(const godot::Transform3D &p_transform);
	void emit_area(const godot::Rect2 &p_rect);
	void area_edited(const godot::AABB &p_area);
	void maps_changed();
	void map_edited(const godot::Variant &p_x, const godot::Variant &p_z, const godot::Variant &p_width,
			const godot::Variant &p_depth, const godot::Variant &p_channel);

	godot::NodePath node_;
	bool thread_safe_ = false;

	/// The ground as a host was given it, for tiles that are still under way.
	struct Given {
		std::uint64_t host = 0;
		std::weak_ptr<ObjectGround> ground;
	};

	std::shared_ptr<ObjectGround>
			ground_; ///< The last that could be used, as of the engine's space. Closed when its node is gone.
	std::map<std::uint64_t, std::shared_ptr<ObjectGround>> grounds_; ///< The same for each host, by its id.
	std::vector<Given> given_;                                       ///< All of that node; closed when it is gone.
	bool stale_ = true;                                              ///< The node has to be looked for.
	bool finding_ = false; ///< It is being looked for, which may run its script.
	bool telling_ = false; ///< What is told of an edit is known here already.
	godot::String problem_;
	godot::String reported_; ///< The problem that was printed last.
	godot::Variant followed_node_;
	godot::Variant followed_source_;
};

} // namespace thicket
