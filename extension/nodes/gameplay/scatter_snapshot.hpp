#pragma once

#include "core/base/world_frame.hpp"
#include "core/query/instance_snapshot.hpp"
#include "nodes/common/guard.hpp"
#include "nodes/gameplay/scatter_instances.hpp"
#include "nodes/layer/layer_reference.hpp"

#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/ref_counted.hpp>
#include <godot_cpp/variant/callable.hpp>
#include <godot_cpp/variant/dictionary.hpp>
#include <godot_cpp/variant/rect2.hpp>
#include <godot_cpp/variant/variant.hpp>
#include <godot_cpp/variant/vector3.hpp>

#include <glm/vec3.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace thicket {

/// A function that runs the query that script_queries.hpp has prepared.
using PreparedQuery = std::function<Status(const InstanceQuery &query)>;

/// The world of a TerrainScatter3D at one moment, unaffected by later changes. Any number of
/// threads may query it concurrently. The methods match those of the node.
class ScatterSnapshot : public godot::RefCounted {
	GDCLASS(ScatterSnapshot, godot::RefCounted)
	THICKET_GUARDED_METHODS(any)

public:
	/// `frame` relates the engine's space to the world.
	static godot::Ref<ScatterSnapshot> of(
			std::shared_ptr<const InstanceSnapshot> snapshot, SharedLayers layers, const WorldFrame &frame);

	/// Creates a snapshot without a world.
	static godot::Ref<ScatterSnapshot> make_empty() { return memnew(ScatterSnapshot); }

	godot::Ref<ScatterInstances> query_rect(
			const godot::Rect2 &p_rect, const godot::Variant &p_layers, const godot::Callable &p_predicate) const;
	godot::Ref<ScatterInstances> query_sphere(const godot::Vector3 &p_center, double p_radius,
			const godot::Variant &p_layers, const godot::Callable &p_predicate) const;
	godot::Ref<ScatterInstance> query_ray(const godot::Vector3 &p_from, const godot::Vector3 &p_to,
			const godot::Variant &p_layers, const godot::Callable &p_predicate) const;
	godot::Ref<ScatterInstance> query_nearest(const godot::Vector3 &p_position, double p_max_distance,
			const godot::Variant &p_layers, const godot::Callable &p_predicate) const;
	godot::Ref<ScatterInstance> get_instance(int64_t p_id) const;
	bool has_instance(int64_t p_id) const;
	godot::Variant get_instance_data(int64_t p_id) const;

	// The templates of script_queries.hpp call these functions.
	const WorldFrame &world_frame() const { return frame_; }
	static std::string name_of(const char *p_method) { return std::string("ScatterSnapshot.") + p_method; }
	SharedLayers prepare(const char *p_method) const;
	godot::String find_queried_layers(const godot::Variant &p_layers, std::vector<std::uint32_t> &r_indices) const {
		return find_layers(*layers_, p_layers, r_indices);
	}
	bool answer(const char *p_method, const PreparedQuery &query) const;

protected:
	static void _bind_methods();

private:
	std::shared_ptr<const InstanceSnapshot> snapshot_; ///< Null for an empty snapshot.
	SharedLayers layers_;                              ///< Null for an empty snapshot.
	WorldFrame frame_;
};

} // namespace thicket
