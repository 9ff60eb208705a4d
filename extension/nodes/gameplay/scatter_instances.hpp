#pragma once

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

/// The result of a query, as of the time of the query. Given an invalid index, methods print an error and return a
/// default.
class ScatterInstances : public godot::RefCounted {
	GDCLASS(ScatterInstances, godot::RefCounted)
	THICKET_GUARDED_METHODS(any)

public:
	/// The result of a refused call.
	static godot::Ref<ScatterInstances> make_empty() { return memnew(ScatterInstances); }

	/// `offset` is the world position of the engine's origin, in meters, for all positions that scripts get. `layers`
	/// are the layers of the instances; null is allowed if there are no instances.
	static godot::Ref<ScatterInstances> of(FoundInstances found, glm::dvec3 offset, SharedLayers layers);

	int64_t size() const { return static_cast<int64_t>(found_.size()); }
	bool is_empty() const { return found_.empty(); }
	int64_t get_id(int64_t p_index) const;
	godot::Ref<ScatterLayer> get_layer(int64_t p_index) const;
	int64_t get_mesh(int64_t p_index) const;
	godot::Vector3 get_position(int64_t p_index) const;
	godot::Transform3D get_transform(int64_t p_index) const;

	// All values together, packed on first use.
	godot::PackedInt64Array get_ids() const;

	/// The layers of all instances, each once, in the order of their first instances.
	godot::TypedArray<ScatterLayer> get_layers() const;

	/// For each instance the index of its layer in `get_layers`.
	godot::PackedInt32Array get_layer_indices() const;
	godot::PackedInt32Array get_meshes() const;
	godot::PackedVector3Array get_positions() const;

	/// 12 floats each, as in the buffer of a MultiMesh.
	godot::PackedFloat32Array get_transforms() const;

protected:
	static void _bind_methods();

private:
	bool has(const char *p_method, int64_t p_index) const;
	void list_layers() const;

	FoundInstances found_;
	glm::dvec3 offset_{0.0};
	SharedLayers listed_;      ///< Null if there are no instances.
	mutable std::mutex mutex_; ///< Guards the following members.
	mutable std::optional<godot::PackedInt64Array> ids_;
	mutable std::optional<godot::PackedInt32Array> layer_indices_;
	mutable std::vector<godot::Ref<ScatterLayer>> layers_; ///< Valid once `layer_indices_` is.
	mutable std::optional<godot::PackedInt32Array> meshes_;
	mutable std::optional<godot::PackedVector3Array> positions_;
	mutable std::optional<godot::PackedFloat32Array> transforms_;
};

/// One instance, as of the time of the query.
class ScatterInstance : public godot::RefCounted {
	GDCLASS(ScatterInstance, godot::RefCounted)
	THICKET_GUARDED_METHODS(any)

public:
	/// `met` is the point where a ray meets the instance, in world meters; without a ray, the position of the instance.
	static godot::Ref<ScatterInstance> of(const PlacedInstance &found, glm::dvec3 offset,
			const godot::Ref<ScatterLayer> &p_layer, const godot::Variant &p_data, double distance = 0.0,
			std::optional<glm::dvec3> met = {});

	int64_t get_id() const;
	godot::Ref<ScatterLayer> get_layer() const { return layer_; }
	int64_t get_mesh() const { return found_.mesh; }
	godot::Transform3D get_transform() const;
	godot::Vector3 get_position() const;
	godot::Variant get_data() const { return data_; }
	bool is_added() const;

	/// The distance in meters from the searched position or the start of the ray; 0 for a search by ID.
	double get_distance() const { return distance_; }

	/// The point where the ray of `query_ray` meets the instance; for all other searches, the position of the instance.
	godot::Vector3 get_hit_position() const;

protected:
	static void _bind_methods();

private:
	PlacedInstance found_;
	glm::dvec3 offset_{0.0};
	godot::Ref<ScatterLayer> layer_;
	godot::Variant data_;
	double distance_ = 0.0;
	glm::dvec3 met_{0.0};
};

} // namespace thicket
