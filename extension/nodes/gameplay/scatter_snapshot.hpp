#pragma once

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

/// A query, for script_queries.hpp.
using AskedQuery = std::function<Status(const InstanceQuery &query)>;

/// The instances around a TerrainScatter3D at one moment, unaffected by later changes. Any thread may query them, and
/// several threads at once. The methods are the same as the node's.
class ScatterSnapshot : public godot::RefCounted {
	GDCLASS(ScatterSnapshot, godot::RefCounted)
	THICKET_GUARDED_METHODS(any)

public:
	/// `offset` is the world position of the engine's origin, in meters.
	static godot::Ref<ScatterSnapshot> of(
			std::shared_ptr<const InstanceSnapshot> snapshot, SharedLayers layers, glm::dvec3 offset);

	/// A snapshot without instances.
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
	glm::dvec3 world_offset() const { return offset_; }
	static std::string name_of(const char *p_method) { return std::string("ScatterSnapshot.") + p_method; }
	SharedLayers prepare(const char *p_method) const;
	godot::String find_queried(const godot::Variant &p_layers, std::vector<std::uint32_t> &r_indices) const {
		return find_layers(*layers_, p_layers, r_indices);
	}
	bool ask(const char *p_method, const AskedQuery &query) const;

protected:
	static void _bind_methods();

private:
	std::shared_ptr<const InstanceSnapshot> snapshot_; ///< Null for an empty snapshot.
	SharedLayers layers_;                              ///< Null for an empty snapshot.
	glm::dvec3 offset_{0.0};
};

} // namespace thicket
