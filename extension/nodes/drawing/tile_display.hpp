#pragma once

#include "core/drawing/division_queue.hpp"
#include "core/drawing/draw_budget.hpp"
#include "core/drawing/lod_schedule.hpp"
#include "core/drawing/redraw_queue.hpp"
#include "core/drawing/tile_key_order.hpp"
#include "core/near/tile_overlay.hpp"
#include "core/streaming/tile_streamer.hpp"
#include "nodes/drawing/cell_drawer.hpp"
#include "nodes/drawing/displayed_tile.hpp"
#include "nodes/drawing/draw_figures.hpp"
#include "nodes/drawing/drawn_layers.hpp"
#include "nodes/drawing/leaving_visuals.hpp"
#include "nodes/drawing/tile_uploader.hpp"
#include "nodes/drawing/upload_queue.hpp"

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <unordered_set>
#include <vector>

namespace thicket {

/// The visible tiles. Carries out what core/drawing decides: uploads their parts, divides them into cells, changes
/// meshes and counts with distance, and redraws tiles that a game has changed. Main thread only. Its steps are small,
/// so that the caller can stop when the frame's time is spent.
class TileDisplay {
public:
	TileDisplay() = default;
	~TileDisplay() = default;
	TileDisplay(const TileDisplay &) = delete;
	TileDisplay &operator=(const TileDisplay &) = delete;

	/// Sets the changes of a game. They apply to all future tiles; visible tiles are updated only where they are
	/// marked. The state must outlive the display.
	void set_state(const InstanceState *state) { state_ = state; }

	/// If `hidden`, other code draws this instance from now on; otherwise the display draws it again. Its point lies in
	/// `area`.
	void set_hidden(std::uint32_t layer, std::uint64_t id, const Rect &area, bool hidden);

	/// Marks an area of a layer (world meters, edges included), or everything, where the overlay may have changed.
	void mark(std::uint32_t layer, const Rect &area) { redraws_.mark(layer, area); }
	void mark_all() { redraws_.mark_all(); }

	/// Redraws the tiles whose overlay has changed in a marked area, with one upload for each tile. Call it before the
	/// frame is drawn.
	void patch();

	/// Marks an area of a layer, or everything, for `patch_step`, which redraws tile by tile.
	void mark_later(std::uint32_t layer, const Rect &area);
	void mark_all_later();

	/// Redraws one such tile. False if there is none.
	bool patch_step();
	bool has_patches() const { return redraws_.has_later(); }

	/// The scenario of the RenderingServer for new tiles, and the node that they belong to.
	void set_scenario(const godot::RID &scenario, std::uint64_t node_id) { uploader_.set_scenario(scenario, node_id); }

	/// The world position of the engine's origin, in meters. Moves all tiles immediately.
	void set_world_offset(glm::dvec3 offset);

	/// Shows or hides all tiles, including future ones.
	void set_visible(bool visible);

	/// Sets the layers by index. If a layer is now drawn differently, `lod_step` updates its tiles step by step. New
	/// meshes of a layer apply to future tiles only.
	void set_layers(const std::vector<SharedSnapshot> &layers);

	/// How much to draw; tiles follow as above.
	void set_limits(const DrawLimits &limits) { budget_.set_limits(limits); }
	const DrawLimits &limits() const { return budget_.limits(); }

	/// Sets the viewers for this frame. How a tile is drawn depends on its distance to the nearest viewer.
	void set_viewers(std::span<const Viewer> viewers);

	/// Updates some tiles to their distances, layers and limits. Uploads nothing. Returns false if all tiles are up to
	/// date.
	bool lod_step();

	/// Works on one tile that changes its division: into cells, into different cells, or back to a whole. Uploads some
	/// of the new cells, hidden. Once all are uploaded, shows them and hides the cells that they replace. So no frame
	/// draws an instance twice or not at all. Returns false if no tile changes its division.
	bool divide_step();

	/// True if there is such a tile.
	bool has_divisions() const { return divisions_.has_work(all_multimeshes()); }

	/// Uploads some visuals of LODs that will fade in, or creates fading meshes. Returns false if nothing is left to
	/// do.
	bool fade_step();
	bool has_fades() const { return !to_fade_.empty() || !drawer_.fades().is_made(); }

	/// True if `lod_step`, `divide_step` and `fade_step` would find no work, and no removed tile is still visible.
	bool settled() const;

	/// Uploads the next part of an incomplete tile. While `others_wait`, a tile that replaces no other is uploaded as a
	/// whole; it is divided later, when there is time.
	void upload_some(TileUpload &r_upload, bool others_wait);

	/// Shows a complete tile, in place of the one with its key.
	void show(TileUpload upload);

	/// Discards a tile that was never shown. `free_step` frees its content step by step.
	void discard(TileUpload upload) { leave(std::move(upload.tile)); }

	/// True if the tile with this key is visible.
	bool holds(const TileKey &key) const;

	/// Removes a tile. Its content is hidden and then freed step by step, by `free_step`. False if it is not visible.
	bool drop(const TileKey &key);
	bool free_step() { return leaving_.free_step(); }

	/// Removes all tiles. Their content is hidden and then freed step by step, by `free_step`.
	void retire();

	/// Visuals that wait to be freed.
	std::size_t leaving_count() const { return leaving_.size(); }

	/// Frees everything immediately.
	void clear();

	/// The visible tile of a layer, or null. If several grids have one, returns the tile of the newest grid.
	const DisplayedTile *find(std::uint32_t layer, glm::ivec2 tile) const;
	std::vector<glm::ivec2> tiles(std::uint32_t layer) const;

	std::size_t tile_count() const { return tiles_.size(); }
	std::uint64_t instance_count() const { return budget_.amounts().instances; }

	/// The number of instances of one layer.
	std::uint64_t instance_count(std::uint32_t layer) const;

	/// Main memory that all instances take, in bytes, without the renderer's copies.
	std::uint64_t instance_bytes() const { return budget_.amounts().bytes; }

	/// The number of instances that are drawn when in view, after all limits.
	std::uint64_t drawn_count() const { return budget_.amounts().drawn; }

	/// The share of a layer's instances that is drawn at this distance from a viewer (meters), including all limits: 0 to 1.
	double drawn_share(const LodSettings &lod, double distance) const { return budget_.drawn_share(lod, distance); }

	/// Visible multimeshes: one for each mesh of a tile that is drawn as a whole, more for a tile in cells.
	std::uint64_t multimesh_count() const { return budget_.amounts().multimeshes; }

	/// The approximate world y of the tiles' instances, in meters; 0 if there are none.
	double usual_height() const;

	/// Adds up everything that is drawn now.
	void count_drawn(DrawCounter &r_counter) const;

	/// The number of buffers passed to the renderer since the display was created or cleared.
	std::uint64_t upload_count() const { return uploader_.upload_count(); }

	/// The number of tiles that were updated, without an upload, after a change of their layer's drawing settings.
	std::uint64_t redrawn_count() const { return redrawn_count_; }

	/// How often an LOD was chosen by distance for a cell, or for a tile that is drawn as a whole. Counted for each
	/// mesh.
	std::uint64_t lod_look_count() const { return drawer_.draw_count(); }

private:
	using Tiles = std::map<TileKey, DisplayedTile, TileKeyOrder>;
	Tiles::const_iterator first_of(std::uint32_t layer) const;
	void leave(DisplayedTile &&tile);
	void leave(std::vector<DisplayedTile::Cell> &&cells);
	void visit_all();
	void apply_drawing(const TileKey &key, DisplayedTile &r_tile);
	void refine(const TileKey &key, DisplayedTile &r_tile);
	Sight sight_of(std::uint32_t layer) const;
	DistanceRange distances_to(std::uint32_t layer, const DisplayedTile &tile) const;
	double distance_to(std::uint32_t layer, const DisplayedTile &tile) const { return distances_to(layer, tile).near; }
	void begin(TileUpload &r_upload, bool others_wait) const;
	void redraw(const TileKey &key, DisplayedTile &r_tile);
	bool patch_part(const DisplayedTile &tile, std::size_t mesh, const LayerSnapshot *layer,
			DisplayedTile::Part &r_part, std::shared_ptr<const CompactMesh> shown);
	void patch(const TileKey &key, DisplayedTile &r_tile);
	bool patch_parts(const TileKey &key, DisplayedTile &r_tile);
	std::vector<std::shared_ptr<const CompactMesh>> overlay(const DisplayedTile &tile) const;

	// How tiles are divided into cells.

	/// The visible tiles, for `divisions_`.
	class TileMeasures : public DivisionQueue::Tiles {
	public:
		explicit TileMeasures(const TileDisplay &display) : display_(display) {}

		double distance(const TileKey &key) const override;
		std::uint32_t shown(const TileKey &key) const override { return tile(key).across; }
		std::uint32_t wanted(const TileKey &key) const override;
		std::uint64_t multimeshes(const TileKey &key) const override { return tile(key).multimesh_count(); }
		std::uint64_t most_multimeshes(const TileKey &key, std::uint32_t across) const override {
			return tile(key).most_multimeshes(across);
		}

	private:
		const DisplayedTile &tile(const TileKey &key) const { return display_.tiles_.at(key); }
		const TileDisplay &display_;
	};
	DivisionQueue::Multimeshes all_multimeshes() const {
		return {budget_.amounts().multimeshes, budget_.max_multimeshes()};
	}
	std::uint32_t division_of(const TileKey &key, const DisplayedTile &tile, std::uint32_t shown) const;
	void continue_division();
	void finish_division(DisplayedTile &r_tile);
	void cancel_division();

	TileUploader uploader_;
	bool visible_ = true;
	DrawnLayers layers_;
	Tiles tiles_;
	LeavingVisuals leaving_;
	std::uint64_t redrawn_count_ = 0;

	LodSchedule schedule_;
	DrawBudget budget_;
	CellDrawer drawer_{{layers_, schedule_, budget_, uploader_, leaving_}};

	DivisionQueue divisions_;
	std::vector<DisplayedTile::Part> next_parts_; ///< The parts of the current division uploaded until now, hidden.

	std::vector<TileKey> to_fade_; ///< Tiles that wait for visuals of LODs. No duplicates.

	const InstanceState *state_ = nullptr;
	std::unordered_set<std::uint64_t> hidden_;
	RedrawQueue redraws_;
};

} // namespace thicket
