// What a TerrainScatter3D makes at once, for those who want to keep it.

#include "nodes/gameplay/instance_answers.hpp"
#include "nodes/scatter/build_at_once.hpp"
#include "nodes/scatter/terrain_scatter_3d.hpp"

#include <godot_cpp/core/class_db.hpp>

#include <algorithm>
#include <utility>

using namespace godot;

namespace thicket {

Status TerrainScatter3D::find_snapshot(int64_t p_layer, SharedSnapshot &r_layer) {
	notice_layers();
	if (p_layer < 0 || p_layer >= layers_.size() || layer_at(p_layer).is_null()) {
		return {ErrorCode::out_of_range, "layer", static_cast<double>(p_layer)};
	}
	if (dirty_) {
		refresh();
	}
	const auto place = static_cast<std::size_t>(p_layer);
	if (terrain_.is_null() || place >= layer_list_.snapshots().size() || !terrain_->ready()) {
		return {ErrorCode::missing, "terrain", 0.0};
	}
	r_layer = layer_list_.snapshots()[place];
	return r_layer != nullptr ? Status{} : Status{ErrorCode::missing, "layer", 0.0};
}

Dictionary TerrainScatter3D::build_rect(int64_t p_layer, const Rect2 &p_rect) {
	const Rect rect = to_world(p_rect, world_offset_);
	SharedSnapshot layer;
	const Ref<ScatterTerrain> terrain = terrain_;
	Status status = find_snapshot(p_layer, layer);
	TileInstances tile;
	if (status.ok()) {
		// A script that is asked for the ground may do away with this node.
		const std::shared_ptr<const Terrain> ground = ground_;
		status = build_at_once(*layer->settings, ground.get(), *terrain.ptr(), rect, tile);
	}
	report("TerrainScatter3D", status);
	TypedArray<PackedFloat32Array> buffers;
	TypedArray<PackedInt64Array> ids;
	TypedArray<Mesh> meshes;
	for (std::size_t mesh = 0; status.ok() && mesh < tile.meshes.size(); ++mesh) {
		buffers.push_back(packed_floats(tile.meshes[mesh].buffer));
		ids.push_back(packed_ids(tile.meshes[mesh].ids));
		meshes.push_back(mesh < layer->drawing.meshes.size() ? layer->drawing.meshes[mesh] : Ref<Mesh>());
	}
	Dictionary result;
	result["origin"] = to_engine(tile.origin, world_offset_);
	result["buffers"] = buffers;
	result["ids"] = ids;
	result["meshes"] = meshes;
	return result;
}

} // namespace thicket
