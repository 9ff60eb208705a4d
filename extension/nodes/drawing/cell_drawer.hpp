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

/// Draws the cells of tiles: the square parts into which near tiles are divided and which are
/// culled separately. Applies the LODs and instance counts that the core chooses to the visuals of
/// the cells. Where LODs cross-fade, a cell has one visual per LOD, and the shaders divide the
/// pixels between them. Use it only on the main thread.
class CellDrawer {
public:
	/// The parts of a TileDisplay that the drawer needs. They must outlive the drawer.
	struct Display {
		const DrawnLayers &layers;
		const LodSchedule &schedule;
		DrawBudget &budget;
		TileUploader &uploader;
		LeavingVisuals &leaving_visuals;
	};
	explicit CellDrawer(const Display &display) : display_(display) {}

	LodFades &fades() { return fades_; }
	const LodFades &fades() const { return fades_; }

	/// Sets whether visuals that are added later are visible.
	void set_visible(bool visible) { visible_ = visible; }

	/// Updates the cells of a tile that are due (see CellVisits), or the whole tile if it is not
	/// divided into cells. Uploads no instances. The tile's layer must be displayed. Sets
	/// `r_margin` to the distance in meters that viewers may move before the next cell is due.
	/// Returns false if the limit on the instances of all tiles thins this tile.
	bool draw(const TileKey &key, DisplayedTile &r_tile, double &r_margin);

	/// Returns true if a cell of the tile lacks a visual for an LOD and the draw budget permits one
	/// more.
	bool lacks_visuals(const TileKey &key, const DisplayedTile &tile) const;

	/// Uploads some of the tile's missing visuals. Returns false if some are still missing; the
	/// next step then continues.
	bool add_visuals(const TileKey &key, DisplayedTile &r_tile);

	/// Uploads some visuals for the tile's new division into cells, whose parts are still hidden.
	/// All visuals exist before the division becomes visible, so that none pops in later. Returns
	/// false if some are still missing.
	bool add_visuals(const TileKey &key, const DisplayedTile &tile, std::span<DisplayedTile::Part> r_parts);

	/// Returns the number of times that an LOD was chosen for a cell or a whole tile since the last
	/// call to `reset_count`. Counts each mesh separately.
	std::uint64_t draw_count() const { return draw_count_; }
	void reset_count() { draw_count_ = 0; }

private:
	/// The settings for drawing the instances of one mesh at any distance.
	struct Drawing {
		std::uint32_t layer; ///< The index of the layer that the tile belongs to.
		const LodSettings &lod;
		/// The LOD chain of the mesh. Null if the chain is incomplete, or if its LODs differ from
		/// those that the tile is drawn with.
		const LodChain *chain;

		std::span<const LodStep> steps() const {
			return chain != nullptr ? chain->steps() : std::span<const LodStep>();
		}
		std::size_t extra_run_count(const LodSpan &span) const {
			return chain != nullptr ? chain->extra_run_count(span) : 0;
		}
	};
	Drawing drawing_of(const TileKey &key, const DisplayedTile &tile, std::size_t mesh) const;
	const LayerSnapshot &layer_of(const TileKey &key) const { return *display_.layers.find(key.layer); }
	DistanceRange distances_to(const DisplayedTile &tile, glm::vec3 min, glm::vec3 max, const LodSettings &lod) const;
	bool draw_cell(
			const Drawing &drawing, const DistanceRange &distance, DisplayedTile::Part &r_part, std::size_t cell);
	void show_lods(const Drawing &drawing, std::span<const std::uint32_t> ranks, const DisplayedTile::Part &part,
			DisplayedTile::Cell &r_cell);
	static const MeshAppearance &first_appearance(
			const Drawing &drawing, const DisplayedTile::Part &part, const DisplayedTile::Cell &cell);
	static std::size_t wanted_extra_count(const Drawing &drawing, const DisplayedTile::Cell &cell);

	Display display_;
	LodFades fades_;
	bool visible_ = true;
	std::uint64_t draw_count_ = 0;
};

} // namespace thicket
