#include "nodes/drawing/tile_uploader.hpp"

#include "core/drawing/upload_step.hpp"
#include "nodes/common/property_check.hpp"

#include <utility>

using namespace godot;

namespace thicket {

void TileUploader::set_scenario(const RID &scenario, std::uint64_t node_id) {
	context_.scenario = scenario;
	context_.node_id = node_id;
}

bool TileUploader::divide_part(const DisplayedTile &tile, std::shared_ptr<const CompactMesh> displayed_mesh,
		std::vector<MeshAppearance> lods, std::uint32_t cells_per_edge, DisplayedTile::Part &r_part) {
	r_part.displayed_mesh = std::move(displayed_mesh);
	r_part.lods = std::move(lods);
	if (cells_per_edge == 1 || r_part.lods.empty()) {
		return true;
	}
	const CellAxes axes = cell_axes(tile.space, tile.settings->planet);
	const Status status =
			divide(*r_part.displayed_mesh, tile.tile->origin, tile.space, cells_per_edge, r_part.division, axes);
	report("TerrainScatter3D", status);
	return status.ok();
}

TileVisual TileUploader::make_visual(const DisplayedTile &tile, const DisplayedTile::Part &part,
		const LayerDrawing &drawing, const MeshUpload &upload) {
	VisualContext context = context_;
	context.origin = tile.tile->origin;
	TileVisual visual(context, tile.settings->instance_data, part.lods, upload);
	visual.apply(drawing);
	++upload_count_;
	return visual;
}

DisplayedTile::Cell TileUploader::make_cell(const DisplayedTile &tile, const DisplayedTile::Part &part,
		const LayerDrawing &drawing, const MeshUpload &upload) {
	DisplayedTile::Cell cell(make_visual(tile, part, drawing, upload));
	cell.set_box(upload.aabb);
	return cell;
}

void TileUploader::upload_cells(
		const DisplayedTile &tile, std::size_t mesh, const LayerDrawing &drawing, DisplayedTile::Part &r_part) {
	UploadStep step;
	while (r_part.is_open() && !step.is_full()) {
		const std::size_t cell = r_part.cells.size();
		r_part.cells.push_back(make_cell(tile, r_part, drawing, to_upload(r_part, cell, tile.reach_of(mesh))));
		step.add(r_part.ranks_of(cell).size());
	}
}

void TileUploader::add_extra_visual(const DisplayedTile &tile, std::size_t mesh, const LayerDrawing &drawing,
		DisplayedTile::Part &r_part, std::size_t cell) {
	const MeshUpload upload = to_upload(r_part, cell, tile.reach_of(mesh));
	r_part.cells[cell].extra_visuals.push_back(make_visual(tile, r_part, drawing, upload));
}

void TileUploader::set_instances(const MeshUpload &upload, DisplayedTile::Cell &r_cell) {
	r_cell.set_instances(upload);
	++upload_count_;
}

} // namespace thicket
