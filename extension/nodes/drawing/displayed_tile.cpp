#include "nodes/drawing/displayed_tile.hpp"

#include "nodes/common/engine_arrays.hpp"

#include <glm/common.hpp>

#include <algorithm>

using namespace godot;

namespace thicket {

namespace {

glm::vec3 vector(const Vector3 &p_vector) {
	return {static_cast<float>(p_vector.x), static_cast<float>(p_vector.y), static_cast<float>(p_vector.z)};
}

} // namespace

void DisplayedTile::Cell::set_box(const AABB &box) {
	min = vector(box.position);
	max = vector(box.position + box.size);
}

void DisplayedTile::Cell::set_instances(const MeshUpload &upload) {
	for_each_visual([&](TileVisual &cell_visual) { cell_visual.set_instances(upload); });
	set_box(upload.aabb);
}

void DisplayedTile::grow(const AABB &box) {
	min = glm::min(min, vector(box.position));
	max = glm::max(max, vector(box.position + box.size));
}

void DisplayedTile::set_visible(bool visible) {
	for (Part &part : parts) {
		for (Cell &cell : part.cells) {
			cell.for_each_visual([visible](TileVisual &visual) { visual.set_visible(visible); });
		}
	}
}

void DisplayedTile::set_frame(const WorldFrame &frame) {
	for (Part &part : parts) {
		for (Cell &cell : part.cells) {
			cell.for_each_visual([&frame](TileVisual &visual) { visual.set_frame(frame); });
		}
	}
}

std::size_t DisplayedTile::Part::multimesh_count() const {
	std::size_t visuals = 0;
	for (const Cell &cell : cells) {
		visuals += 1 + cell.extra_visuals.size();
	}
	return visuals * multimeshes_per_cell();
}

std::size_t DisplayedTile::finest_lod() const {
	constexpr auto no_lod = std::numeric_limits<std::size_t>::max();
	std::size_t finest = no_lod;
	for (const Part &part : parts) {
		for (const Cell &cell : part.cells) {
			finest = std::min(finest, cell.drawing.lod);
		}
	}
	return finest != no_lod ? finest : 0;
}

void DisplayedTile::set_lod(std::size_t lod) {
	for (Part &part : parts) {
		for (Cell &cell : part.cells) {
			cell.drawing.lod = lod;
			cell.drawing.span = {lod, lod, false};
		}
	}
}

std::size_t DisplayedTile::cell_count() const {
	std::size_t count = 0;
	for (const Part &part : parts) {
		count += part.cells.size();
	}
	return count;
}

DrawAmounts DisplayedTile::amounts() const {
	DrawAmounts result;
	if (tile == nullptr) {
		return result;
	}
	result.bytes = tile->meshes.capacity() * sizeof(CompactMesh);
	for (std::size_t mesh = 0; mesh < parts.size(); ++mesh) {
		const Part &part = parts[mesh];
		const CompactMesh &generated_mesh = tile->meshes[mesh];
		result.bytes += generated_mesh.bytes() +
				(part.displayed_mesh.get() != &generated_mesh ? part.displayed_mesh->bytes() + sizeof(CompactMesh) : 0);
		result.bytes += part.division.bytes();
		result.instances += part.displayed_mesh->size();
		result.multimeshes += part.multimesh_count();
		for (const Cell &cell : part.cells) {
			result.drawn_count += cell.drawing.drawn_count;
			result.wanted_count += cell.drawing.wanted_count;
		}
	}
	return result;
}

std::size_t DisplayedTile::multimesh_count() const {
	std::size_t count = 0;
	for (const Part &part : parts) {
		count += part.multimesh_count();
	}
	return count;
}

std::size_t DisplayedTile::multimesh_bound(std::uint32_t next_cells_per_edge) const {
	std::size_t count = 0;
	for (const Part &part : parts) {
		const std::size_t cells =
				std::min(part.displayed_mesh->size(), std::size_t{next_cells_per_edge} * next_cells_per_edge);
		count += part.lods.empty() ? 0 : cells * part.multimeshes_per_cell();
	}
	return count;
}

MeshUpload to_upload(const DisplayedTile::Part &part, std::size_t cell, float reach) {
	if (part.division.empty()) {
		return to_upload(*part.displayed_mesh, reach);
	}
	const DrawCell &draw_cell = part.division.cells[cell];
	MeshUpload upload;
	upload.aabb = box_around(draw_cell.min, draw_cell.max, reach * part.displayed_mesh->max_scale());
	const auto floats = static_cast<int64_t>(draw_cell.size() * part.displayed_mesh->stride());
	gather(*part.displayed_mesh, part.division.order_of(draw_cell), resize(upload.buffer, floats));
	return upload;
}

PackedFloat32Array read_back(const DisplayedTile::Part &part) {
	if (part.division.empty()) {
		return part.cells.front().visual.read_back();
	}
	const std::size_t stride = part.displayed_mesh->stride();
	PackedFloat32Array result;
	const std::span<float> floats = resize(result, static_cast<int64_t>(part.displayed_mesh->size() * stride));
	for (std::size_t cell = 0; cell < part.cells.size(); ++cell) {
		const PackedFloat32Array buffer = part.cells[cell].visual.read_back();
		const std::span<const float> cell_floats(buffer.ptr(), static_cast<std::size_t>(buffer.size()));
		const std::span<const std::uint32_t> order = part.division.order_of(part.division.cells[cell]);
		spread(cell_floats, order.first(std::min(order.size(), cell_floats.size() / stride)), stride, floats);
	}
	return result;
}

} // namespace thicket
