#pragma once

#include "core/base/status.hpp"
#include "nodes/drawing/displayed_tile.hpp"
#include "nodes/layer/layer_snapshot.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace thicket {

/// Creates the visuals of tiles, hidden, and uploads their buffers. Main thread only.
class TileUploader {
public:
	/// The scenario of the RenderingServer for new visuals, and the node that they belong to.
	void set_scenario(const godot::RID &scenario, std::uint64_t node_id);

	/// The world position of the engine's origin, in meters, for new visuals.
	void set_world_offset(glm::dvec3 offset) { context_.offset = offset; }
	glm::dvec3 world_offset() const { return context_.offset; }

	/// Prepares a part of a tile for the upload of its cells, `across` along a side. False if there is not enough memory.
	static bool begin_part(const DisplayedTile &tile, std::shared_ptr<const CompactMesh> shown,
			std::vector<MeshLook> lods, std::uint32_t across, DisplayedTile::Part &r_part);

	DisplayedTile::Cell make_cell(const DisplayedTile &tile, const DisplayedTile::Part &part,
			const LayerDrawing &drawing, const MeshUpload &upload);

	/// Uploads the next cells of a part, as many as fit into a small part of a frame's time.
	void upload_cells(
			const DisplayedTile &tile, std::size_t mesh, const LayerDrawing &drawing, DisplayedTile::Part &r_part);

	/// Adds a visual for a further LOD to a cell.
	void add_other(const DisplayedTile &tile, std::size_t mesh, const LayerDrawing &drawing,
			DisplayedTile::Part &r_part, std::size_t cell);

	/// Replaces the instances of a cell.
	void set_instances(const MeshUpload &upload, DisplayedTile::Cell &r_cell);

	/// Buffers passed to the renderer since the last `reset_count`.
	std::uint64_t upload_count() const { return upload_count_; }
	void reset_count() { upload_count_ = 0; }

private:
	TileVisual make_visual(const DisplayedTile &tile, const DisplayedTile::Part &part, const LayerDrawing &drawing,
			const MeshUpload &upload);

	VisualContext context_;
	std::uint64_t upload_count_ = 0;
};

} // namespace thicket
