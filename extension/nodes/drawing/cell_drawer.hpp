#pragma once

#include "core/drawing/draw_budget.hpp"
#include "core/drawing/lod_schedule.hpp"
#include "nodes/drawing/displayed_tile.hpp"
#include "nodes/drawing/drawn_layers.hpp"
#include "nodes/drawing/leaving_visuals.hpp"
#include "nodes/drawing/lod_fades.hpp"
#include "nodes/drawing/tile_uploader.hpp"

#include <cstddef>
#include <cstdint>
#include <span>

namespace thicket {

/// Draws the cells of tiles. Passes the core's decisions to the visuals of cells, and adds visuals for LODs that
/// cross-fade: both LODs are then drawn, and their shaders divide the pixels between them. Main thread only.
class CellDrawer {
public:
	/// The parts of a display that drawing needs. They outlive the drawer.
	struct Display {
		const DrawnLayers &layers;
		const LodSchedule &schedule;
		DrawBudget &budget;
		TileUploader &uploader;
		LeavingVisuals &leaving;
	};
	explicit CellDrawer(const Display &display) : display_(display) {}

	LodFades &fades() { return fades_; }
	const LodFades &fades() const { return fades_; }

	/// Whether further visuals are visible.
	void set_visible(bool visible) { visible_ = visible; }

	/// Draws those cells of a tile that are due, or a tile that is not divided into cells. Uploads nothing. The layer
	/// of the tile must be displayed. Returns false if the limit for all tiles thins the tile. `r_margin` gets the
	/// distance in meters that viewers may move until a cell is due.
	bool draw(const TileKey &key, DisplayedTile &r_tile, double &r_margin);

	/// True if a cell of a tile lacks a visual for an LOD, and there is room for one.
	bool lacks_visuals(const TileKey &key, const DisplayedTile &tile) const;

	/// Uploads some of the missing visuals. Returns false if some are left for the next step.
	bool add_visuals(const TileKey &key, DisplayedTile &r_tile);

	/// Uploads some visuals of a tile's new division, whose parts are still hidden, so that nothing pops when they are
	/// shown.
	bool add_visuals(const TileKey &key, const DisplayedTile &tile, std::span<DisplayedTile::Part> r_parts);

	/// The number of draws since the last `reset_count`, counted for each mesh, of cells and of tiles that are drawn as
	/// a whole.
	std::uint64_t draw_count() const { return draw_count_; }
	void reset_count() { draw_count_ = 0; }

private:
	/// How the instances of a mesh are drawn at any distance.
	struct Drawing {
		std::uint32_t layer; ///< The one that the tile belongs to.
		const LodSettings &lod;
		const LodChain *chain; ///< Null unless it belongs to the looks that the tile is drawn with, and is complete.

		std::span<const LodStep> steps() const {
			return chain != nullptr ? chain->steps() : std::span<const LodStep>();
		}
		std::size_t looks_beyond_first(const LodSpan &span) const {
			return chain != nullptr ? chain->looks_beyond_first(span) : 0;
		}
	};
	Drawing drawing_of(const TileKey &key, const DisplayedTile &tile, std::size_t mesh) const;
	const LayerSnapshot &layer_of(const TileKey &key) const { return *display_.layers.find(key.layer); }
	DistanceRange distances_to(const DisplayedTile &tile, glm::vec3 min, glm::vec3 max, const LodSettings &lod) const;
	bool draw_cell(
			const Drawing &drawing, const DistanceRange &distance, DisplayedTile::Part &r_part, std::size_t cell);
	void show_lods(const Drawing &drawing, std::span<const std::uint32_t> ranks, const DisplayedTile::Part &part,
			DisplayedTile::Cell &r_cell);
	static const MeshLook &first_look(
			const Drawing &drawing, const DisplayedTile::Part &part, const DisplayedTile::Cell &cell);
	static std::size_t wanted_others(const Drawing &drawing, const DisplayedTile::Cell &cell);

	Display display_;
	LodFades fades_;
	bool visible_ = true;
	std::uint64_t draw_count_ = 0;
};

} // namespace thicket
