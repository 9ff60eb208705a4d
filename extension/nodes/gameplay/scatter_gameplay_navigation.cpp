// This file adds all instances in a baked area to the source geometry of a navigation mesh, even if
// their tiles are not loaded.

#include "nodes/gameplay/scatter_gameplay.hpp"

#include "core/base/basis_scale.hpp"
#include "core/base/guard.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/gameplay/navigation_parse.hpp"

#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/variant/packed_vector3_array.hpp>

#include <glm/common.hpp>
#include <glm/matrix.hpp>

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

/// Returns the rectangle that contains the box of a bake, in the engine's x and z coordinates.
Rect ground_of(const NavigationBake &bake) {
	const glm::dmat3 inverse = glm::inverse(bake.basis);
	constexpr double infinity = std::numeric_limits<double>::infinity();
	Rect rect{glm::dvec2(infinity), glm::dvec2(-infinity)};
	for (unsigned corner = 0; corner < 8; ++corner) {
		const glm::dvec3 corner_position(corner & 1U ? bake.max.x : bake.min.x, corner & 2U ? bake.max.y : bake.min.y,
				corner & 4U ? bake.max.z : bake.min.z);
		const glm::dvec3 position = inverse * (corner_position - bake.origin);
		rect.min = glm::min(rect.min, glm::dvec2(position.x, position.z));
		rect.max = glm::max(rect.max, glm::dvec2(position.x, position.z));
	}
	return rect;
}

bool obstructs(const LayerSnapshot *layer, const NavigationBake &bake) {
	if (layer == nullptr) {
		return false;
	}
	const LayerCollision &collision = layer->gameplay.collision;
	return collision.shape != BodyShape::none && collision.affects_navigation &&
			(!bake.collision_mask || (collision.layer & *bake.collision_mask) != 0);
}

/// Returns true if an obstruction intersects the baked box.
bool overlaps(const NavigationBake &bake, const Obstruction &obstruction) {
	glm::dvec2 min = obstruction.outline.front();
	glm::dvec2 max = min;
	for (const glm::dvec2 corner : obstruction.outline) {
		min = glm::min(min, corner);
		max = glm::max(max, corner);
	}
	return min.x <= bake.max.x && max.x >= bake.min.x && min.y <= bake.max.z && max.y >= bake.min.z &&
			obstruction.bottom <= bake.max.y && obstruction.top >= bake.min.y;
}

void add(const Obstruction &obstruction, NavigationMeshSourceGeometryData3D &r_geometry) {
	const auto corner = [&obstruction](glm::dvec2 point) {
		return to_engine(glm::dvec3(point.x, obstruction.bottom, point.y));
	};
	const auto outline = packed<PackedVector3Array>(std::span<const glm::dvec2>(obstruction.outline), corner);
	// Do not carve the obstruction. The engine carves after it has applied the agent's radius, so
	// carved obstructions would ignore the radius.
	r_geometry.add_projected_obstruction(outline, static_cast<float>(obstruction.bottom),
			static_cast<float>(obstruction.top - obstruction.bottom), false);
}

/// Returns the IDs of a layer's hand-placed instances that may obstruct an area (world meters).
std::vector<std::uint64_t> hand_placed_ids(const InstanceState &state, std::uint16_t layer, const Rect &area,
		const InstanceShape &shape, const NavigationAgent &agent) {
	const double reach = obstruction_reach(shape, state.max_added_scale(layer), agent);
	if (reach > max_obstruction_reach) {
		// At least one instance is too large. Return all, so that it is found regardless of its
		// position.
		return state.added_ids(layer);
	}
	std::vector<std::uint64_t> ids;
	throw_if_out_of_memory(state.added_in(layer, grown(area, reach), ids));
	return ids;
}

void report_too_large(std::uint32_t layer, std::span<const std::uint64_t> ids) {
	if (ids.empty()) {
		return;
	}
	const std::string others_text = ids.size() > 1 ? " and " + std::to_string(ids.size() - 1) + " more" : "";
	ERR_PRINT(String(("TerrainScatter3D: a navigation mesh is baked without the hand-placed instance " +
			std::to_string(script_id(ids.front())) + others_text + " of layer " + std::to_string(layer) +
			". An obstruction may extend at most " + std::to_string(static_cast<int>(max_obstruction_reach)) +
			" m from its instance. Remove such instances, or place them with a smaller scale.")
					.c_str()));
}

/// Returns the rectangle of the world that contains a bake's box above the engine's `ground`.
Rect area_in_world(const Rect &ground, const NavigationBake &bake, const WorldFrame &frame) {
	glm::dvec2 low(std::numeric_limits<double>::max());
	glm::dvec2 high = -low;
	for (int corner = 0; corner < 8; ++corner) {
		const glm::dvec3 world = frame.to_world({corner & 1 ? ground.max.x : ground.min.x,
				corner & 2 ? bake.max.y : bake.min.y, corner & 4 ? ground.max.y : ground.min.y});
		low = glm::min(low, {world.x, world.z});
		high = glm::max(high, {world.x, world.z});
	}
	return {low, high};
}

} // namespace

void ScatterGameplay::add_obstructions(const NavigationBake &bake) {
	const bool has_area = bake.max.x > bake.min.x && bake.max.z > bake.min.z;
	if (!has_area || !alive() || !host_->prepare().ok()) {
		// A node without layers or a ground has no obstructions. The node's problems report this.
		return;
	}
	const std::vector<SharedSnapshot> layers = layers_;
	const Rect ground = ground_of(bake);
	for (std::uint32_t layer = 0; layer < layers.size(); ++layer) {
		if (obstructs(layers[layer].get(), bake)) {
			add_obstructions(bake, ground, layer, layers[layer]);
		}
	}
}

void ScatterGameplay::add_obstructions(
		const NavigationBake &bake, const Rect &ground, std::uint32_t layer, const SharedSnapshot &snapshot) {
	if (!alive() || layer >= layers_.size() || layers_[layer] != snapshot || layer >= world_.layers().size()) {
		return; // A script of the ground has changed the layers.
	}
	const QueryLayer &queried_layer = world_.layers()[layer];
	const InstanceShape shape = queried_layer.shape;
	const std::uint16_t layer_id = queried_layer.set.layer;
	const Ref<ScatterState> state = state_;
	const WorldFrame frame = world_frame();
	const Rect area = area_in_world(ground, bake, frame);
	const Rect rect = grown(area, obstruction_reach(shape, queried_layer.max_scale, bake.agent));
	const QueryFilter filter{.layers = {layer}, .accepts = {}};
	std::vector<PlacedInstance> instances;
	const Status status =
			world_.answer([&](const InstanceQuery &query) { return query.in_rect(rect, filter, instances); });
	if (!status.ok() && status.code != ErrorCode::cancelled) {
		ERR_PRINT(String(("TerrainScatter3D: a navigation mesh is baked without the instances of layer " +
				std::to_string(layer) + ": " + describe(status) +
				". Set the mesh's filter_baking_aabb to the area to bake.")
						.c_str()));
	}
	Obstruction obstruction;
	const auto obstructs_bake = [&](glm::dvec3 position, const glm::mat3 &basis) {
		const glm::dvec3 foot = bake.basis * frame.to_engine(position) + bake.origin;
		return obstruct(bake.basis * glm::dmat3(frame.rotated_back(basis)), foot, shape, bake.agent, obstruction) &&
				overlaps(bake, obstruction);
	};
	for (const PlacedInstance &instance : instances) {
		if (!is_added(instance.id) && obstructs_bake(instance.position, instance.basis)) {
			add(obstruction, *bake.geometry.ptr());
		}
	}
	if (state.is_null()) {
		return;
	}
	// Hand-placed instances may be larger than generated ones, so their search area is different.
	std::vector<std::uint64_t> too_large;
	for (const std::uint64_t id : hand_placed_ids(state->state(), layer_id, area, shape, bake.agent)) {
		const AddedInstance *added = state->state().added(id);
		if (added == nullptr || !obstructs_bake(added->position, added->basis)) {
			continue;
		}
		if (obstruction_reach(shape, largest_scale(added->basis), bake.agent) > max_obstruction_reach) {
			too_large.push_back(id);
		} else {
			add(obstruction, *bake.geometry.ptr());
		}
	}
	report_too_large(layer, too_large);
}

} // namespace thicket
