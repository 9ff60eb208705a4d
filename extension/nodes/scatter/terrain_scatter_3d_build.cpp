// What a TerrainScatter3D makes at once, for those who want to keep it.

#include "nodes/scatter/terrain_scatter_3d.hpp"

#include <godot_cpp/core/class_db.hpp>

#include <algorithm>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// All steps of a tile on this thread; a terrain that may only be asked on the main thread is asked there and then.
Status build_at_once(const LayerPlan &plan, const ScatterTerrain &terrain, const Rect &rect, TileInstances &r_tile) {
	TileBuilder builder;
	if (plan.terrain != nullptr) {
		return builder.build(*plan.settings, *plan.terrain, rect, r_tile);
	}
	Status status = builder.find_points(*plan.settings, rect);
	std::vector<Ground> ground(status.ok() ? builder.positions().size() : 0);
	for (std::size_t i = 0; status.ok() && i < builder.queries().size(); ++i) {
		const GroundQuery &query = builder.queries()[i];
		status = terrain.ask(builder.positions().subspan(query.first, query.count), query.textures,
				std::span(ground).subspan(query.first, query.count));
	}
	return status.ok() ? builder.place(ground, r_tile) : status;
}

PackedFloat32Array packed(const std::vector<float> &numbers) {
	PackedFloat32Array result;
	result.resize(static_cast<int64_t>(numbers.size()));
	std::copy(numbers.begin(), numbers.end(), result.ptrw());
	return result;
}

PackedInt64Array packed(const std::vector<std::uint64_t> &ids) {
	PackedInt64Array result;
	result.resize(static_cast<int64_t>(ids.size()));
	std::transform(ids.begin(), ids.end(), result.ptrw(), [](std::uint64_t id) { return static_cast<int64_t>(id); });
	return result;
}

} // namespace

Status TerrainScatter3D::find_streamed(int64_t p_layer, StreamedLayer &r_streamed) {
	if (p_layer < 0 || p_layer >= layers_.size() || layer_at(p_layer).is_null()) {
		return {ErrorCode::out_of_range, "layer", static_cast<double>(p_layer)};
	}
	if (dirty_) {
		refresh();
	}
	const auto place = static_cast<std::size_t>(p_layer);
	if (terrain_.is_null() || place >= plans_.streamed().size() || !terrain_->ready()) {
		return {ErrorCode::missing, "terrain", 0.0};
	}
	r_streamed = plans_.streamed()[place];
	return r_streamed.plan->wanted ? Status{} : Status{ErrorCode::missing, "layer", 0.0};
}

Dictionary TerrainScatter3D::build_rect(int64_t p_layer, const Rect2 &p_rect) {
	const glm::dvec2 corner{p_rect.position.x, p_rect.position.y};
	const Rect rect{corner, corner + glm::dvec2{p_rect.size.x, p_rect.size.y}};
	StreamedLayer layer;
	const Ref<ScatterTerrain> terrain = terrain_;
	Status status = find_streamed(p_layer, layer);
	TileInstances tile;
	if (status.ok()) {
		// A script that is asked for the ground may do away with this node.
		status = build_at_once(*layer.plan, *terrain.ptr(), rect, tile);
	}
	report("TerrainScatter3D", status);
	TypedArray<PackedFloat32Array> buffers;
	TypedArray<PackedInt64Array> ids;
	TypedArray<Mesh> meshes;
	for (std::size_t mesh = 0; status.ok() && mesh < tile.meshes.size(); ++mesh) {
		buffers.push_back(packed(tile.meshes[mesh].buffer));
		ids.push_back(packed(tile.meshes[mesh].ids));
		meshes.push_back(mesh < layer.look.meshes.size() ? layer.look.meshes[mesh] : Ref<Mesh>());
	}
	Dictionary result;
	result["origin"] = Vector3(
			static_cast<real_t>(tile.origin.x), static_cast<real_t>(tile.origin.y), static_cast<real_t>(tile.origin.z));
	result["buffers"] = buffers;
	result["ids"] = ids;
	result["meshes"] = meshes;
	return result;
}

} // namespace thicket
