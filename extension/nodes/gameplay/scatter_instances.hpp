#pragma once

#include "core/base/world_frame.hpp"
#include "core/query/found_instances.hpp"
#include "nodes/common/guard.hpp"
#include "nodes/layer/layer_reference.hpp"

#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/classes/ref_counted.hpp>
#include <godot_cpp/core/memory.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/packed_int32_array.hpp>
#include <godot_cpp/variant/packed_int64_array.hpp>
#include <godot_cpp/variant/packed_vector3_array.hpp>
#include <godot_cpp/variant/transform3d.hpp>
#include <godot_cpp/variant/typed_array.hpp>
#include <godot_cpp/variant/variant.hpp>

#include <glm/vec3.hpp>

#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

namespace thicket {

/// The instances that a query has found, as they were at the time of the query. If an index is out
/// of range, methods print an error and return a default value. Any thread may call any method.
class ScatterInstances : public godot::RefCounted {
	GDCLASS(ScatterInstances, godot::RefCounted)
	THICKET_GUARDED_METHODS(any)

public:
	/// Creates the result of a rejected query.
	static godot::Ref<ScatterInstances> make_empty() { return memnew(ScatterInstances); }

	/// `frame` relates the engine's space to the world. It converts all positions that scripts
	/// receive. The layer indices of the instances refer to `layers`, which may be null if there
	/// are no instances.
	static godot::Ref<ScatterInstances> of(FoundInstances instances, const WorldFrame &frame, SharedLayers layers);

	int64_t size() const { return static_cast<int64_t>(instances_.size()); }
	bool is_empty() const { return instances_.empty(); }
	int64_t get_id(int64_t p_index) const;
	godot::Ref<ScatterLayer> get_layer(int64_t p_index) const;
	int64_t get_mesh(int64_t p_index) const;
	godot::Vector3 get_position(int64_t p_index) const;
	godot::Transform3D get_transform(int64_t p_index) const;

	// These methods return the values of all instances. The arrays are created on first use.
	godot::PackedInt64Array get_ids() const;

	/// Returns the layers that have instances, without duplicates, in the order of first
	/// occurrence.
	godot::TypedArray<ScatterLayer> get_layers() const;

	/// Returns the index of each instance's layer in `get_layers`.
	godot::PackedInt32Array get_layer_indices() const;
	godot::PackedInt32Array get_meshes() const;
	godot::PackedVector3Array get_positions() const;

	/// Returns 12 floats per instance, as in MultiMesh.buffer.
	godot::PackedFloat32Array get_transforms() const;

protected:
	static void _bind_methods();

private:
	bool has(const char *p_method, int64_t p_index) const;
	void list_layers() const;

	FoundInstances instances_;
	WorldFrame frame_;
	SharedLayers listed_layers_; ///< Null if there are no instances.
	mutable std::mutex mutex_;   ///< Guards the following members.
	mutable std::optional<godot::PackedInt64Array> ids_;
	mutable std::optional<godot::PackedInt32Array> layer_indices_;
	/// The result of get_layers. Valid once `layer_indices_` has a value.
	mutable std::vector<godot::Ref<ScatterLayer>> layers_;
	mutable std::optional<godot::PackedInt32Array> meshes_;
	mutable std::optional<godot::PackedVector3Array> positions_;
	mutable std::optional<godot::PackedFloat32Array> transforms_;
};

/// One instance, as it was at the time of the query. Any thread may call any method.
class ScatterInstance : public godot::RefCounted {
	GDCLASS(ScatterInstance, godot::RefCounted)
	THICKET_GUARDED_METHODS(any)

public:
	/// `distance` is in meters. `hit_position` is the point where a ray hits the instance, in world
	/// meters; it defaults to the position of the instance.
	static godot::Ref<ScatterInstance> of(const PlacedInstance &instance, const WorldFrame &frame,
			const godot::Ref<ScatterLayer> &p_layer, const godot::Variant &p_data, double distance = 0.0,
			std::optional<glm::dvec3> hit_position = {});

	int64_t get_id() const;
	godot::Ref<ScatterLayer> get_layer() const { return layer_; }
	int64_t get_mesh() const { return instance_.mesh; }
	godot::Transform3D get_transform() const;
	godot::Vector3 get_position() const;
	godot::Variant get_data() const { return data_; }
	bool is_added() const;

	/// Returns the distance in meters from the query's position or the start of the ray to the
	/// instance; 0 for a query by ID.
	double get_distance() const { return distance_; }

	/// Returns the point where the ray of `query_ray` hits the instance. After any other query,
	/// returns the position of the instance.
	godot::Vector3 get_hit_position() const;

protected:
	static void _bind_methods();

private:
	PlacedInstance instance_;
	WorldFrame frame_;
	godot::Ref<ScatterLayer> layer_;
	godot::Variant data_;
	double distance_ = 0.0;
	glm::dvec3 hit_position_{0.0};
};

} // namespace thicket
