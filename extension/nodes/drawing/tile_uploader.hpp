#pragma once

#include "core/base/status.hpp"
#include "core/base/world_frame.hpp"
#include "nodes/drawing/displayed_tile.hpp"
#include "nodes/layer/layer_snapshot.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace thicket {

/// Creates the visuals of tiles, which are hidden at first, and uploads their buffers. Use it only
/// on the main thread.
class TileUploader {
public:
	/// Sets the RenderingServer scenario of new visuals and the node that they belong to.
	void set_scenario(const godot::RID &scenario, std::uint64_t node_id);

	/// Sets the world position of the engine's origin, in meters, for new visuals.
	void set_world_frame(const WorldFrame &frame) { context_.frame = frame; }
	const WorldFrame &world_frame() const { return context_.frame; }

	/// Prepares a part of a tile for the upload of its cells. `cells_per_edge` is their number
	/// along each edge. Returns false if memory is insufficient.
	static bool divide_part(const DisplayedTile &tile, std::shared_ptr<const CompactMesh> displayed_mesh,
			std::vector<MeshAppearance> lods, std::uint32_t cells_per_edge, DisplayedTile::Part &r_part);

	DisplayedTile::Cell make_cell(const DisplayedTile &tile, const DisplayedTile::Part &part,
			const LayerDrawing &drawing, const MeshUpload &upload);

	/// Uploads the next cells of a part, as many as one small step permits.
	void upload_cells(
			const DisplayedTile &tile, std::size_t mesh, const LayerDrawing &drawing, DisplayedTile::Part &r_part);

	/// Adds a visual for one more LOD to a cell.
	void add_extra_visual(const DisplayedTile &tile, std::size_t mesh, const LayerDrawing &drawing,
			DisplayedTile::Part &r_part, std::size_t cell);

	/// Replaces the instances of a cell.
	void set_instances(const MeshUpload &upload, DisplayedTile::Cell &r_cell);

	/// Returns the number of buffers passed to the renderer since the last `reset_count`.
	std::uint64_t upload_count() const { return upload_count_; }
	void reset_count() { upload_count_ = 0; }

private:
	TileVisual make_visual(const DisplayedTile &tile, const DisplayedTile::Part &part, const LayerDrawing &drawing,
			const MeshUpload &upload);

	VisualContext context_;
	std::uint64_t upload_count_ = 0;
};

} // namespace thicket
