#include "nodes/gameplay/scatter_instances.hpp"

#include "nodes/common/bind_value.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/gameplay/instance_answers.hpp"

#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/memory.hpp>

#include <algorithm>
#include <string>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// The values of all instances in a packed array, made on the first call.
template <class Array, class Value>
Array cached(std::optional<Array> &r_cache, const std::vector<PlacedInstance> &found, const Value &value_of) {
	if (!r_cache) {
		Array values;
		values.resize(static_cast<int64_t>(found.size()));
		std::ranges::transform(found, values.ptrw(), value_of);
		r_cache = values;
	}
	return *r_cache;
}

} // namespace

Ref<ScatterInstances> ScatterInstances::of(std::vector<PlacedInstance> found, glm::dvec3 offset) {
	const Ref<ScatterInstances> result(memnew(ScatterInstances));
	result->found_ = std::move(found);
	result->offset_ = offset;
	return result;
}

const PlacedInstance *ScatterInstances::find(const char *p_method, int64_t p_index) const {
	if (p_index < 0 || p_index >= size()) {
		report((std::string("ScatterInstances.") + p_method).c_str(),
				{ErrorCode::out_of_range, "index", static_cast<double>(p_index)});
		return nullptr;
	}
	return &found_[static_cast<std::size_t>(p_index)];
}

int64_t ScatterInstances::get_id(int64_t p_index) const {
	const PlacedInstance *instance = find("get_id", p_index);
	return instance != nullptr ? script_id(instance->id) : 0;
}

int64_t ScatterInstances::get_layer(int64_t p_index) const {
	const PlacedInstance *instance = find("get_layer", p_index);
	return instance != nullptr ? instance->layer : -1;
}

int64_t ScatterInstances::get_mesh(int64_t p_index) const {
	const PlacedInstance *instance = find("get_mesh", p_index);
	return instance != nullptr ? instance->mesh : -1;
}

Vector3 ScatterInstances::get_position(int64_t p_index) const {
	const PlacedInstance *instance = find("get_position", p_index);
	return instance != nullptr ? to_engine(instance->position, offset_) : Vector3();
}

Transform3D ScatterInstances::get_transform(int64_t p_index) const {
	const PlacedInstance *instance = find("get_transform", p_index);
	return instance != nullptr ? to_engine(*instance, offset_) : Transform3D();
}

PackedInt64Array ScatterInstances::get_ids() const {
	return cached(ids_, found_, [](const PlacedInstance &instance) { return script_id(instance.id); });
}

PackedInt32Array ScatterInstances::get_layers() const {
	return cached(
			layers_, found_, [](const PlacedInstance &instance) { return static_cast<std::int32_t>(instance.layer); });
}

PackedInt32Array ScatterInstances::get_meshes() const {
	return cached(
			meshes_, found_, [](const PlacedInstance &instance) { return static_cast<std::int32_t>(instance.mesh); });
}

PackedVector3Array ScatterInstances::get_positions() const {
	return cached(positions_, found_,
			[this](const PlacedInstance &instance) { return to_engine(instance.position, offset_); });
}

PackedFloat32Array ScatterInstances::get_transforms() const {
	if (transforms_) {
		return *transforms_;
	}
	PackedFloat32Array transforms;
	transforms.resize(size() * static_cast<int64_t>(transform_floats));
	float *floats = transforms.ptrw();
	for (const PlacedInstance &instance : found_) {
		const glm::vec3 position(instance.position - offset_);
		for (int row = 0; row < 3; ++row) {
			for (int column = 0; column < 3; ++column) {
				*floats++ = instance.basis[column][row];
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
	bind_guarded<&Self::get_meshes>(D_METHOD("get_meshes"));
	bind_guarded<&Self::get_positions>(D_METHOD("get_positions"));
	bind_guarded<&Self::get_transforms>(D_METHOD("get_transforms"));
	const char *owner = "ScatterInstances";
	bind_value(owner, PropertyInfo(Variant::PACKED_INT64_ARRAY, "ids"), "get_ids");
	bind_value(owner, PropertyInfo(Variant::PACKED_INT32_ARRAY, "layers"), "get_layers");
	bind_value(owner, PropertyInfo(Variant::PACKED_INT32_ARRAY, "meshes"), "get_meshes");
	bind_value(owner, PropertyInfo(Variant::PACKED_VECTOR3_ARRAY, "positions"), "get_positions");
	bind_value(owner, PropertyInfo(Variant::PACKED_FLOAT32_ARRAY, "transforms"), "get_transforms");
}

Ref<ScatterInstance> ScatterInstance::of(
		const PlacedInstance &found, glm::dvec3 offset, const Variant &p_data, double distance) {
	const Ref<ScatterInstance> result(memnew(ScatterInstance));
	result->found_ = found;
	result->offset_ = offset;
	result->data_ = p_data;
	result->distance_ = distance;
	return result;
}

int64_t ScatterInstance::get_id() const { return script_id(found_.id); }

Transform3D ScatterInstance::get_transform() const { return to_engine(found_, offset_); }

Vector3 ScatterInstance::get_position() const { return to_engine(found_.position, offset_); }

bool ScatterInstance::is_added() const { return thicket::is_added(found_.id); }

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
	const char *owner = "ScatterInstance";
	bind_value(owner, PropertyInfo(Variant::INT, "id"), "get_id");
	bind_value(owner, PropertyInfo(Variant::INT, "layer"), "get_layer");
	bind_value(owner, PropertyInfo(Variant::INT, "mesh"), "get_mesh");
	bind_value(owner, PropertyInfo(Variant::TRANSFORM3D, "transform"), "get_transform");
	bind_value(owner, PropertyInfo(Variant::VECTOR3, "position"), "get_position");
	bind_value(owner, PropertyInfo(Variant::NIL, "data", PROPERTY_HINT_NONE, "", PROPERTY_USAGE_NIL_IS_VARIANT),
			"get_data");
	bind_value(owner, PropertyInfo(Variant::BOOL, "added"), "is_added");
	bind_value(owner, PropertyInfo(Variant::FLOAT, "distance"), "get_distance");
}

} // namespace thicket
