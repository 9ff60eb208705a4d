#include "nodes/scatter/scatter_tile.hpp"

#include "core/placement/instance_rows.hpp"
#include "core/placement/merged_mesh.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/engine_arrays.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/gameplay/instance_answers.hpp"

#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/memory.hpp>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

using namespace godot;

namespace thicket {

Ref<ScatterTile> ScatterTile::from_tile(
		CompactTile tile, const std::vector<Ref<Mesh>> &meshes, const WorldFrame &frame) {
	const Ref<ScatterTile> result(memnew(ScatterTile));
	const auto shared = std::make_shared<const CompactTile>(std::move(tile));
	result->tile_ = shared;
	result->origin_ = to_engine(shared->origin, frame);
	for (std::size_t mesh = 0; mesh < shared->meshes.size(); ++mesh) {
		result->parts_.push_back({mesh < meshes.size() ? meshes[mesh] : Ref<Mesh>(),
				std::shared_ptr<const CompactMesh>(shared, &shared->meshes[mesh]), {}});
	}
	return result;
}

Ref<ScatterTile> ScatterTile::from_display(const std::shared_ptr<const TileDisplay> &display, std::uint32_t layer,
		glm::ivec2 tile, const WorldFrame &frame) {
	const Ref<ScatterTile> result(memnew(ScatterTile));
	const std::vector<const DisplayedTile *> column = display->column(layer, tile);
	if (column.size() > 1) {
		result->merge(column);
		result->origin_ = to_engine(result->tile_->origin, frame);
	}
	if (column.size() != 1) {
		return result;
	}
	const DisplayedTile *displayed = column.front();
	result->tile_ = displayed->tile;
	result->origin_ = to_engine(displayed->tile->origin, frame);
	for (const DisplayedTile::Part &part : displayed->parts) {
		result->parts_.push_back({part.cells.empty() ? Ref<Mesh>() : part.lods.front().mesh, part.displayed_mesh, {}});
		for (const DisplayedTile::Cell &cell : part.cells) {
			result->parts_.back().multimeshes.push_back(cell.visual.multimesh());
		}
	}
	result->display_ = display;
	result->thread_guard().enter_scene(); // Only the main thread may read back buffers.
	result->layer_ = layer;
	result->coordinates_ = tile;
	return result;
}

/// Takes the merged instances of the cubes in a column. They are copies, so later changes to the
/// display do not affect them.
void ScatterTile::merge(std::span<const DisplayedTile *const> column) {
	const auto tile = std::make_shared<CompactTile>();
	tile->origin = column.front()->tile->origin;
	std::size_t count = 0;
	for (const DisplayedTile *cube : column) {
		count = std::max(count, cube->parts.size());
	}
	for (std::size_t mesh = 0; mesh < count; ++mesh) {
		std::vector<TileMesh> meshes;
		Part &merged_part = parts_.emplace_back();
		for (const DisplayedTile *cube : column) {
			if (mesh >= cube->parts.size()) {
				continue; // This cube could not be generated.
			}
			const DisplayedTile::Part &part = cube->parts[mesh];
			meshes.push_back({part.displayed_mesh.get(), cube->tile->origin});
			merged_part.mesh = part.cells.empty() ? merged_part.mesh : part.lods.front().mesh;
			for (const DisplayedTile::Cell &cell : part.cells) {
				merged_part.multimeshes.push_back(cell.visual.multimesh());
			}
		}
		tile->meshes.push_back(merged(meshes, tile->origin));
	}
	for (const DisplayedTile *cube : column) {
		tile->counts.sampled += cube->tile->counts.sampled;
		tile->counts.dense += cube->tile->counts.dense;
		tile->counts.placed += cube->tile->counts.placed;
	}
	for (std::size_t mesh = 0; mesh < parts_.size(); ++mesh) {
		parts_[mesh].instances = std::shared_ptr<const CompactMesh>(tile, &tile->meshes[mesh]);
	}
	tile_ = tile;
}

bool ScatterTile::is_empty() const {
	return std::ranges::all_of(parts_, [](const Part &part) { return part.instances->size() == 0; });
}

const ScatterTile::Part *ScatterTile::find(const char *p_method, int64_t p_index) const {
	if (p_index < 0 || p_index >= get_mesh_count()) {
		report((std::string("ScatterTile.") + p_method).c_str(),
				Status::out_of_range("index", p_index, between(0, get_mesh_count() - 1, "see get_mesh_count()")));
		return nullptr;
	}
	return &parts_[static_cast<std::size_t>(p_index)];
}

Ref<Mesh> ScatterTile::get_mesh(int64_t p_index) const {
	const Part *part = find("get_mesh", p_index);
	return part != nullptr ? part->mesh : Ref<Mesh>();
}

PackedFloat32Array ScatterTile::get_buffer(int64_t p_index) const {
	const Part *part = find("get_buffer", p_index);
	if (part == nullptr) {
		return {};
	}
	const std::shared_ptr<const TileDisplay> display = display_.lock();
	const DisplayedTile *current_tile = display != nullptr ? display->find(layer_, coordinates_) : nullptr;
	const auto index = static_cast<std::size_t>(p_index);
	const bool is_unchanged = current_tile != nullptr && index < current_tile->parts.size() &&
			current_tile->parts[index].displayed_mesh == part->instances;
	return is_unchanged && !current_tile->parts[index].cells.empty() ? read_back(current_tile->parts[index])
																	 : to_upload(*part->instances, 0.0F).buffer;
}

PackedInt64Array ScatterTile::get_ids(int64_t p_index) const {
	const Part *part = find("get_ids", p_index);
	return part != nullptr ? packed_ids(expanded(*part->instances).ids) : PackedInt64Array();
}

PackedByteArray ScatterTile::get_rows() const {
	std::vector<MeshInstances> instances;
	std::vector<const MeshInstances *> meshes;
	instances.reserve(parts_.size());
	for (const Part &part : parts_) {
		meshes.push_back(&instances.emplace_back(expanded(*part.instances)));
	}
	return packed_bytes(instance_rows(tile_ != nullptr ? tile_->origin : glm::dvec3(0.0), meshes));
}

RID ScatterTile::get_multimesh(int64_t p_index) const {
	const Part *part = find("get_multimesh", p_index);
	return part != nullptr && part->multimeshes.size() == 1 ? part->multimeshes.front() : RID();
}

TypedArray<RID> ScatterTile::get_multimeshes(int64_t p_index) const {
	TypedArray<RID> result;
	if (const Part *part = find("get_multimeshes", p_index)) {
		for (const RID &multimesh : part->multimeshes) {
			append(result, multimesh);
		}
	}
	return result;
}

int64_t ScatterTile::get_digest() const {
	if (tile_ == nullptr) {
		return 0;
	}
	TileInstances instances;
	instances.origin = tile_->origin;
	instances.counts = tile_->counts;
	for (int64_t index = 0; index < get_mesh_count(); ++index) {
		const PackedFloat32Array buffer = get_buffer(index);
		MeshInstances mesh = expanded(*parts_[static_cast<std::size_t>(index)].instances);
		mesh.buffer.assign(buffer.ptr(), buffer.ptr() + buffer.size());
		instances.meshes.push_back(std::move(mesh));
	}
	return static_cast<int64_t>(digest(instances));
}

void ScatterTile::_bind_methods() {
	using Self = ScatterTile;
	bind_guarded<&Self::is_empty>(D_METHOD("is_empty"));
	bind_guarded<&Self::get_origin>(D_METHOD("get_origin"));
	bind_guarded<&Self::get_mesh_count>(D_METHOD("get_mesh_count"));
	bind_guarded<&Self::get_mesh>(D_METHOD("get_mesh", "index"));
	bind_guarded<&Self::get_buffer>(ThreadUse::owner, D_METHOD("get_buffer", "index"));
	bind_guarded<&Self::get_ids>(D_METHOD("get_ids", "index"));
	bind_guarded<&Self::get_rows>(D_METHOD("get_rows"));
	bind_guarded<&Self::get_multimesh>(D_METHOD("get_multimesh", "index"));
	bind_guarded<&Self::get_multimeshes>(D_METHOD("get_multimeshes", "index"));
	bind_guarded<&Self::get_digest>(ThreadUse::owner, D_METHOD("get_digest"));
}

} // namespace thicket
