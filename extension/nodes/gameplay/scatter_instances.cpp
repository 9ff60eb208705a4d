#include "nodes/gameplay/scatter_instances.hpp"

#include "nodes/common/bind_value.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/engine_arrays.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/gameplay/instance_answers.hpp"

#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/memory.hpp>

#include <cstddef>
#include <map>
#include <string>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Returns a packed array with one value per instance. The first call creates the array.
template <class Array, class Value>
Array cached(
		std::mutex &r_mutex, std::optional<Array> &r_cache, const FoundInstances &instances, const Value &value_of) {
	const std::lock_guard lock(r_mutex);
	if (r_cache) {
		// The instances never change, so the array stays valid.
		return *r_cache;
	}
	Array values;
	const auto out = resize(values, static_cast<int64_t>(instances.size()));
	for (std::size_t i = 0; i < instances.size(); ++i) {
		out[i] = value_of(i);
	}
	r_cache = values;
	return values;
}

std::size_t index_of(int64_t p_index) { return static_cast<std::size_t>(p_index); }

} // namespace

Ref<ScatterInstances> ScatterInstances::of(FoundInstances instances, const WorldFrame &frame, SharedLayers layers) {
	const Ref<ScatterInstances> result(memnew(ScatterInstances));
	result->instances_ = std::move(instances);
	result->frame_ = frame;
	result->listed_layers_ = std::move(layers);
	return result;
}

bool ScatterInstances::has(const char *p_method, int64_t p_index) const {
	if (p_index < 0 || p_index >= size()) {
		report((std::string("ScatterInstances.") + p_method).c_str(),
				Status::out_of_range("index", p_index, between(0, size() - 1, "see size()")));
		return false;
	}
	return true;
}

int64_t ScatterInstances::get_id(int64_t p_index) const {
	return has("get_id", p_index) ? script_id(instances_.id(index_of(p_index))) : 0;
}

Ref<ScatterLayer> ScatterInstances::get_layer(int64_t p_index) const {
	return has("get_layer", p_index) ? listed_layers_->at(instances_.layer(index_of(p_index))) : Ref<ScatterLayer>();
}

int64_t ScatterInstances::get_mesh(int64_t p_index) const {
	return has("get_mesh", p_index) ? instances_.mesh(index_of(p_index)) : -1;
}

Vector3 ScatterInstances::get_position(int64_t p_index) const {
	return has("get_position", p_index) ? to_engine(instances_.position(index_of(p_index)), frame_) : Vector3();
}

Transform3D ScatterInstances::get_transform(int64_t p_index) const {
	return has("get_transform", p_index) ? to_engine(instances_[index_of(p_index)], frame_) : Transform3D();
}

PackedInt64Array ScatterInstances::get_ids() const {
	return cached(mutex_, ids_, instances_, [this](std::size_t i) { return script_id(instances_.id(i)); });
}

/// Fills `layers_` and `layer_indices_` on the first call. The caller must hold the mutex.
void ScatterInstances::list_layers() const {
	if (layer_indices_) {
		// The instances never change, so the array stays valid.
		return;
	}
	std::map<std::uint32_t, std::int32_t> list_indices; // Keyed by the index in the node's list.
	std::vector<Ref<ScatterLayer>> layers;
	PackedInt32Array indices;
	const auto out = resize(indices, size());
	for (std::size_t i = 0; i < instances_.size(); ++i) {
		const auto [entry, is_new] =
				list_indices.try_emplace(instances_.layer(i), static_cast<std::int32_t>(list_indices.size()));
		if (is_new) {
			layers.push_back(listed_layers_->at(entry->first));
		}
		out[i] = entry->second;
	}
	layers_ = std::move(layers);
	layer_indices_ = indices;
}

TypedArray<ScatterLayer> ScatterInstances::get_layers() const {
	const std::lock_guard lock(mutex_);
	list_layers();
	// A new array per call, because scripts share arrays by reference.
	TypedArray<ScatterLayer> layers;
	for (const Ref<ScatterLayer> &layer : layers_) {
		append(layers, layer);
	}
	return layers;
}

PackedInt32Array ScatterInstances::get_layer_indices() const {
	const std::lock_guard lock(mutex_);
	list_layers();
	return *layer_indices_;
}

PackedInt32Array ScatterInstances::get_meshes() const {
	return cached(mutex_, meshes_, instances_,
			[this](std::size_t i) { return static_cast<std::int32_t>(instances_.mesh(i)); });
}

PackedVector3Array ScatterInstances::get_positions() const {
	return cached(mutex_, positions_, instances_,
			[this](std::size_t i) { return to_engine(instances_.position(i), frame_); });
}

PackedFloat32Array ScatterInstances::get_transforms() const {
	const std::lock_guard lock(mutex_);
	if (transforms_) {
		// The instances never change, so the array stays valid.
		return *transforms_;
	}
	PackedFloat32Array transforms;
	auto floats = resize(transforms, size() * static_cast<int64_t>(transform_floats)).begin();
	for (std::size_t i = 0; i < instances_.size(); ++i) {
		const PlacedInstance instance = instances_[i];
		const glm::vec3 position(frame_.to_engine(instance.position));
		const glm::mat3 basis = frame_.rotated_back(instance.basis);
		for (int row = 0; row < 3; ++row) {
			for (int column = 0; column < 3; ++column) {
				*floats++ = basis[column][row];
			}
			*floats++ = position[row];
		}
	}
	transforms_ = transforms;
	return transforms;
}

void ScatterInstances::_bind_methods() {
	using Self = ScatterInstances;
	bind_guarded<&Self::size>(D_METHOD("size"));
	bind_guarded<&Self::is_empty>(D_METHOD("is_empty"));
	bind_guarded<&Self::get_id>(D_METHOD("get_id", "index"));
	bind_guarded<&Self::get_layer>(D_METHOD("get_layer", "index"));
	bind_guarded<&Self::get_mesh>(D_METHOD("get_mesh", "index"));
	bind_guarded<&Self::get_position>(D_METHOD("get_position", "index"));
	bind_guarded<&Self::get_transform>(D_METHOD("get_transform", "index"));
	bind_guarded<&Self::get_ids>(D_METHOD("get_ids"));
	bind_guarded<&Self::get_layers>(D_METHOD("get_layers"));
	bind_guarded<&Self::get_layer_indices>(D_METHOD("get_layer_indices"));
	bind_guarded<&Self::get_meshes>(D_METHOD("get_meshes"));
	bind_guarded<&Self::get_positions>(D_METHOD("get_positions"));
	bind_guarded<&Self::get_transforms>(D_METHOD("get_transforms"));
	const char *owner = "ScatterInstances";
	bind_value(owner, PropertyInfo(Variant::PACKED_INT64_ARRAY, "ids"), "get_ids");
	bind_value(owner,
			PropertyInfo(Variant::ARRAY, "layers", PROPERTY_HINT_ARRAY_TYPE,
					vformat("%d/%d:ScatterLayer", Variant::OBJECT, PROPERTY_HINT_RESOURCE_TYPE)),
			"get_layers");
	bind_value(owner, PropertyInfo(Variant::PACKED_INT32_ARRAY, "layer_indices"), "get_layer_indices");
	bind_value(owner, PropertyInfo(Variant::PACKED_INT32_ARRAY, "meshes"), "get_meshes");
	bind_value(owner, PropertyInfo(Variant::PACKED_VECTOR3_ARRAY, "positions"), "get_positions");
	bind_value(owner, PropertyInfo(Variant::PACKED_FLOAT32_ARRAY, "transforms"), "get_transforms");
}

Ref<ScatterInstance> ScatterInstance::of(const PlacedInstance &instance, const WorldFrame &frame,
		const Ref<ScatterLayer> &p_layer, const Variant &p_data, double distance,
		std::optional<glm::dvec3> hit_position) {
	const Ref<ScatterInstance> result(memnew(ScatterInstance));
	result->instance_ = instance;
	result->frame_ = frame;
	result->layer_ = p_layer;
	result->data_ = p_data;
	result->distance_ = distance;
	result->hit_position_ = hit_position.value_or(instance.position);
	return result;
}

int64_t ScatterInstance::get_id() const { return script_id(instance_.id); }

Transform3D ScatterInstance::get_transform() const { return to_engine(instance_, frame_); }

Vector3 ScatterInstance::get_position() const { return to_engine(instance_.position, frame_); }

Vector3 ScatterInstance::get_hit_position() const { return to_engine(hit_position_, frame_); }

bool ScatterInstance::is_added() const { return thicket::is_added(instance_.id); }

void ScatterInstance::_bind_methods() {
	using Self = ScatterInstance;
	bind_guarded<&Self::get_id>(D_METHOD("get_id"));
	bind_guarded<&Self::get_layer>(D_METHOD("get_layer"));
	bind_guarded<&Self::get_mesh>(D_METHOD("get_mesh"));
	bind_guarded<&Self::get_transform>(D_METHOD("get_transform"));
	bind_guarded<&Self::get_position>(D_METHOD("get_position"));
	bind_guarded<&Self::get_data>(D_METHOD("get_data"));
	bind_guarded<&Self::is_added>(D_METHOD("is_added"));
	bind_guarded<&Self::get_distance>(D_METHOD("get_distance"));
	bind_guarded<&Self::get_hit_position>(D_METHOD("get_hit_position"));
	const char *owner = "ScatterInstance";
	bind_value(owner, PropertyInfo(Variant::INT, "id"), "get_id");
	bind_value(owner, PropertyInfo(Variant::OBJECT, "layer", PROPERTY_HINT_RESOURCE_TYPE, "ScatterLayer"), "get_layer");
	bind_value(owner, PropertyInfo(Variant::INT, "mesh"), "get_mesh");
	bind_value(owner, PropertyInfo(Variant::TRANSFORM3D, "transform"), "get_transform");
	bind_value(owner, PropertyInfo(Variant::VECTOR3, "position"), "get_position");
	bind_value(owner, PropertyInfo(Variant::NIL, "data", PROPERTY_HINT_NONE, "", PROPERTY_USAGE_NIL_IS_VARIANT),
			"get_data");
	bind_value(owner, PropertyInfo(Variant::BOOL, "added"), "is_added");
	bind_value(owner, PropertyInfo(Variant::FLOAT, "distance"), "get_distance");
	bind_value(owner, PropertyInfo(Variant::VECTOR3, "hit_position"), "get_hit_position");
}

} // namespace thicket
