// This file contains the methods of ScatterGameplay that add instances or remove many instances in
// one call.

#include "nodes/gameplay/scatter_gameplay.hpp"

#include "core/placement/layer.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/gameplay/instance_answers.hpp"
#include "nodes/layer/layer_reference.hpp"

#include <godot_cpp/core/error_macros.hpp>

#include <cstddef>
#include <span>
#include <string>

using namespace godot;

namespace thicket {

namespace {

constexpr std::size_t transform_size = 12; ///< The number of floats per transform.

Status check_mesh(int64_t mesh) {
	const bool is_valid = mesh >= 0 && mesh < static_cast<int64_t>(max_meshes);
	return is_valid ? Status{}
					: Status::out_of_range("mesh", mesh, between(0, max_meshes - 1, "an index of ScatterLayer.meshes"));
}

/// Reads a transform from a buffer: three rows of the basis, each followed by one coordinate of the
/// origin.
AddedInstance read_transform(const float *floats, const WorldFrame &frame) {
	glm::mat3 basis;
	glm::vec3 origin;
	for (int row = 0; row < 3; ++row) {
		for (int column = 0; column < 3; ++column) {
			basis[column][row] = floats[4 * row + column];
		}
		origin[row] = floats[4 * row + 3];
	}
	return to_added(Transform3D(to_engine(basis), to_engine(origin)), frame);
}

void report_at(std::size_t index, const Status &status) {
	report(("TerrainScatter3D.add_instances: transform " + std::to_string(index)).c_str(), status);
}

} // namespace

/// Finds the layer of an instance to add, and binds the state to the layer's points. If nothing can
/// be added to the layer, prints an error and returns false.
bool ScatterGameplay::find_layer_to_add_to(const char *p_method, const Variant &p_layer, std::uint32_t &r_layer) {
	const SharedLayers layers = prepare(p_method);
	if (layers == nullptr) {
		return false;
	}
	const std::string name = name_of(p_method);
	if (const String problem = find_layer(*layers, p_layer, r_layer); !problem.is_empty()) {
		ERR_PRINT(String((name + ": ").c_str()) + problem);
		return false;
	}
	const bool is_displayed = r_layer < world_.layers().size() && world_.layers()[r_layer].wanted;
	const Status status = is_displayed ? claim(r_layer) : refused_layer();
	report(name.c_str(), status);
	return status.ok();
}

int64_t ScatterGameplay::add_instance(const Variant &p_layer, const Transform3D &p_transform, int64_t p_mesh) {
	std::uint32_t layer = 0;
	std::uint64_t id = 0;
	Status status = check_mesh(p_mesh);
	if (status.ok()) {
		if (!find_layer_to_add_to("add_instance", p_layer, layer)) {
			return 0;
		}
		AddedInstance added = to_added(p_transform, world_frame());
		added.layer = world_.layers()[layer].set.layer;
		added.mesh = static_cast<std::uint8_t>(p_mesh);
		const Ref<ScatterState> state = state_;
		status = state->add(added, id);
	}
	report("TerrainScatter3D.add_instance", status);
	return status.ok() ? script_id(id) : 0;
}

PackedInt64Array ScatterGameplay::add_instances(
		const Variant &p_layer, const PackedFloat32Array &p_transforms, const PackedInt32Array &p_meshes) {
	const auto floats = static_cast<std::size_t>(p_transforms.size());
	const std::size_t count = floats / transform_size;
	const bool uses_first_mesh = p_meshes.size() == 0;
	if (floats % transform_size != 0) {
		report("TerrainScatter3D.add_instances",
				Status::wrong_size("transforms", floats, at_least(0, "a multiple of 12: 12 floats per instance")));
		return {};
	}
	if (!uses_first_mesh && p_meshes.size() != static_cast<int64_t>(count)) {
		report("TerrainScatter3D.add_instances",
				Status::wrong_size("meshes", p_meshes.size(), exactly(count, "one per instance, or none")));
		return {};
	}
	std::uint32_t layer = 0;
	if (!find_layer_to_add_to("add_instances", p_layer, layer)) {
		return {};
	}
	const WorldFrame frame = world_frame();
	std::vector<AddedInstance> added;
	added.reserve(count);
	for (std::size_t index = 0; index < count; ++index) {
		const int64_t mesh = uses_first_mesh ? 0 : p_meshes.ptr()[index];
		if (const Status status = check_mesh(mesh); !status.ok()) {
			report_at(index, status);
			return {};
		}
		added.push_back(read_transform(p_transforms.ptr() + index * transform_size, frame));
		added.back().layer = world_.layers()[layer].set.layer;
		added.back().mesh = static_cast<std::uint8_t>(mesh);
	}
	std::vector<std::uint64_t> ids;
	const Ref<ScatterState> state = state_;
	const Status status = state->add_all(added, ids);
	if (!status.ok()) {
		report_at(ids.size(), status);
		return {};
	}
	return packed_ids(ids);
}

PackedInt64Array ScatterGameplay::remove_instances(const PackedInt64Array &p_ids) {
	if (prepare("remove_instances") == nullptr) {
		return {};
	}
	const Ref<ScatterState> state = state_;
	std::vector<PlacedInstance> instances;
	const auto find_all = [&](const InstanceQuery &query) -> Status {
		std::vector<PlacedInstance> matches;
		for (const int64_t id : std::span(p_ids.ptr(), static_cast<std::size_t>(p_ids.size()))) {
			if (const Status status = query.by_id(core_id(id), matches); !status.ok()) {
				return status;
			}
			instances.insert(instances.end(), matches.begin(), matches.end());
		}
		return {};
	};
	report("TerrainScatter3D.remove_instances", world_.answer(find_all));
	return packed_ids(remove_all(instances));
}

} // namespace thicket
