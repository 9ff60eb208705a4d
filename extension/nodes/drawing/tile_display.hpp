#pragma once

#include "core/base/world_frame.hpp"
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

/// Displays tiles according to the decisions of core/drawing. Uploads the parts of tiles, divides
/// near tiles into cells, and chooses meshes and instance counts by distance. Also redraws tiles
/// that a game has changed. Works in small steps, so that the caller can stop when the frame budget
/// is spent. Use it only on the main thread.
class TileDisplay {
public:
	TileDisplay() = default;
	~TileDisplay() = default;
	TileDisplay(const TileDisplay &) = delete;
	TileDisplay &operator=(const TileDisplay &) = delete;

	/// Sets a game's changes (the overlay), or null for none. The changes apply to all tiles that
	/// are uploaded afterward. Displayed tiles change only in areas that `mark` or `mark_later` has
	/// marked. The state must outlive the display.
	void set_state(const InstanceState *state) { state_ = state; }

	/// Hides an instance while other code draws it, or displays it again. `area` must contain the
	/// instance's point.
	void set_hidden(std::uint32_t layer, std::uint64_t id, const Rect &area, bool hidden);

	/// Marks an area of a layer (world meters, edges included), or everything. `patch` then redraws
	/// the tiles in which a game has changed instances.
	void mark(std::uint32_t layer, const Rect &area) { redraws_.mark(layer, area); }
	void mark_all() { redraws_.mark_all(); }

	/// Redraws the tiles in marked areas whose instances a game has changed. Uploads each tile at
	/// most once. Call it before the frame is drawn.
	void patch();

	/// Marks an area of a layer, or everything, to be redrawn by `patch_step`.
	void mark_later(std::uint32_t layer, const Rect &area);
	void mark_all_later();

	/// Redraws one tile that `mark_later` or `mark_all_later` has marked. Returns false if there is
	/// none.
	bool patch_step();
	bool has_patches() const { return redraws_.has_queued(); }

	/// Sets the RenderingServer scenario of new tiles and the node that they belong to.
	void set_scenario(const godot::RID &scenario, std::uint64_t node_id) { uploader_.set_scenario(scenario, node_id); }

	/// Sets the world position of the engine's origin, in meters. Moves all tiles immediately.
	void set_world_frame(const WorldFrame &frame);

	/// Shows or hides all tiles, including future ones.
	void set_visible(bool visible);

	/// Sets the layers by index. If the drawing settings of a layer have changed, `lod_step`
	/// updates its tiles step by step. New meshes of a layer apply to future tiles only.
	void set_layers(const std::vector<SharedSnapshot> &layers);

	/// Sets how much to draw. `lod_step` updates the tiles step by step.
	void set_limits(const DrawLimits &limits) { budget_.set_limits(limits); }
	const DrawLimits &limits() const { return budget_.limits(); }

	/// Sets the viewers for this frame. The LOD and density of a tile depend on its distance to the
	/// nearest viewer.
	void set_viewers(std::span<const Viewer> viewers);

	/// Updates some tiles to the current distances, layers and limits. Uploads nothing. Returns
	/// false if all tiles are up to date.
	bool lod_step();

	/// Continues to change how one tile is divided into cells. Uploads some of the new cells while
	/// they are still hidden. Once all are uploaded, shows them and hides the cells that they
	/// replace, so that no frame draws an instance twice or not at all. Returns false if no tile
	/// needs another division.
	bool divide_step();

	/// Returns true if the division of a tile is changing or must change.
	bool has_divisions() const { return divisions_.has_work(total_multimeshes()); }

	/// Uploads some visuals for LODs that will fade in, or creates fading meshes. Returns false if
	/// there is nothing to do.
	bool fade_step();
	bool has_fades() const { return !tiles_to_fade_.empty() || !drawer_.fades().is_complete(); }

	/// Returns true if `lod_step`, `divide_step` and `fade_step` have nothing to do and no removed
	/// tile is still visible.
	bool settled() const;

	/// Uploads the next part of an incomplete tile. If `others_wait` is true, a tile that replaces
	/// no other tile is uploaded as a whole and divided later.
	void upload_some(TileUpload &r_upload, bool others_wait);

	/// Displays a complete tile in place of the previous one with its key, if any.
	void show(TileUpload upload);

	/// Discards a tile that was never displayed. `free_step` frees its content step by step.
	void discard(TileUpload upload) { release_visuals(std::move(upload.tile)); }

	/// Returns true if a tile with this key is displayed.
	bool contains(const TileKey &key) const;

	/// Removes a tile. `free_step` hides its content and then frees it step by step. Returns false
	/// if the tile is not displayed.
	bool drop(const TileKey &key);
	bool free_step() { return leaving_visuals_.free_step(); }

	/// Removes all tiles. `free_step` hides their content and then frees it step by step.
	void retire();

	/// Returns the number of visuals of removed tiles that have not been freed yet.
	std::size_t leaving_count() const { return leaving_visuals_.size(); }

	/// Frees everything immediately.
	void clear();

	/// Returns the displayed tile of a layer, or null. If several grids have one, returns the tile
	/// of the newest grid. If cubes are displayed above each other, returns the lowest one.
	const DisplayedTile *find(std::uint32_t layer, glm::ivec2 tile) const;

	/// Returns all displayed tiles with these coordinates, of the newest grid that has any: one
	/// tile, or the cubes above each other, lowest first. Empty if none is displayed.
	std::vector<const DisplayedTile *> column(std::uint32_t layer, glm::ivec2 tile) const;

	/// Returns the displayed tile in a slab, or null. If the layer's tiles are not cubes, `slab`
	/// must be all_slabs.
	const DisplayedTile *find(std::uint32_t layer, glm::ivec2 tile, std::int32_t slab) const;
	std::vector<glm::ivec2> tiles(std::uint32_t layer) const;

	std::size_t tile_count() const { return tiles_.size(); }
	std::uint64_t instance_count() const { return budget_.amounts().instances; }

	/// Returns the number of instances of one layer.
	std::uint64_t instance_count(std::uint32_t layer) const;

	/// Returns the main memory in bytes that all instances take, without the renderer's copies.
	std::uint64_t instance_bytes() const { return budget_.amounts().bytes; }

	/// Returns the number of instances that are drawn if in view, after all limits.
	std::uint64_t drawn_count() const { return budget_.amounts().drawn_count; }

	/// Returns the fraction of a layer's instances that is drawn at a distance in meters from a
	/// viewer, after all limits: 0 to 1.
	double drawn_fraction(const LodSettings &lod, double distance) const {
		return budget_.drawn_fraction(lod, distance);
	}

	/// Returns the number of multimeshes. There is one for each mesh of a tile that is drawn as a
	/// whole. A tile that is divided into cells has more.
	std::uint64_t multimesh_count() const { return budget_.amounts().multimeshes; }

	/// Returns the average height (world y) of the displayed tiles in meters; 0 if there are none.
	double average_height() const;

	/// Adds everything that is currently drawn to `r_counter`.
	void count_drawn(DrawCounter &r_counter) const;

	/// Returns the number of buffers passed to the renderer since the display was created or
	/// cleared.
	std::uint64_t upload_count() const { return uploader_.upload_count(); }

	/// Returns the number of tiles that were updated, without an upload, because their layer's
	/// drawing settings had changed.
	std::uint64_t redrawn_count() const { return redrawn_count_; }

	/// Returns the number of times that an LOD was chosen by distance for a cell or a whole tile.
	/// Counts each mesh separately.
	std::uint64_t draw_count() const { return drawer_.draw_count(); }

private:
	using Tiles = std::map<TileKey, DisplayedTile, TileKeyOrder>;
	Tiles::const_iterator first_tile_of(std::uint32_t layer) const;
	/// These functions move all visuals of a tile, or of cells, to `leaving_visuals_`.
	void release_visuals(DisplayedTile &&tile);
	void release_visuals(std::vector<DisplayedTile::Cell> &&cells);
	void visit_all();
	void apply_drawing(const TileKey &key, DisplayedTile &r_tile);
	void refine(const TileKey &key, DisplayedTile &r_tile);
	Sight sight_of(std::uint32_t layer) const;
	DistanceRange distances_to(std::uint32_t layer, const DisplayedTile &tile) const;
	double distance_to(std::uint32_t layer, const DisplayedTile &tile) const { return distances_to(layer, tile).near; }
	void begin(TileUpload &r_upload, bool others_wait) const;
	void redraw(const TileKey &key, DisplayedTile &r_tile);
	bool patch_part(const DisplayedTile &tile, std::size_t mesh, const LayerSnapshot *layer,
			DisplayedTile::Part &r_part, std::shared_ptr<const CompactMesh> displayed_mesh);
	void patch(const TileKey &key, DisplayedTile &r_tile);
	bool patch_parts(const TileKey &key, DisplayedTile &r_tile);
	std::vector<std::shared_ptr<const CompactMesh>> overlay(const DisplayedTile &tile) const;

	// The division of tiles into cells.

	/// Measures the displayed tiles for `divisions_`, which decides how they are divided.
	class TileMeasures : public DivisionQueue::Tiles {
	public:
		explicit TileMeasures(const TileDisplay &display) : display_(display) {}

		double distance(const TileKey &key) const override;
		std::uint32_t displayed_division(const TileKey &key) const override { return tile(key).cells_per_edge; }
		std::uint32_t wanted_division(const TileKey &key) const override;
		std::uint64_t multimeshes(const TileKey &key) const override { return tile(key).multimesh_count(); }
		std::uint64_t multimesh_bound(const TileKey &key, std::uint32_t cells_per_edge) const override {
			return tile(key).multimesh_bound(cells_per_edge);
		}

	private:
		const DisplayedTile &tile(const TileKey &key) const { return display_.tiles_.at(key); }
		const TileDisplay &display_;
	};
	DivisionQueue::Multimeshes total_multimeshes() const {
		return {budget_.amounts().multimeshes, budget_.max_multimeshes()};
	}
	std::uint32_t division_of(const TileKey &key, const DisplayedTile &tile, std::uint32_t current_division) const;
	void continue_division();
	void finish_division(DisplayedTile &r_tile);
	void cancel_division();

	TileUploader uploader_;
	bool visible_ = true;
	DrawnLayers layers_;
	Tiles tiles_;
	LeavingVisuals leaving_visuals_;
	std::uint64_t redrawn_count_ = 0;

	LodSchedule schedule_;
	DrawBudget budget_;
	CellDrawer drawer_{{layers_, schedule_, budget_, uploader_, leaving_visuals_}};

	DivisionQueue divisions_;
	/// The cells uploaded so far, still hidden, for the tile whose division is changing.
	std::vector<DisplayedTile::Part> next_parts_;

	std::vector<TileKey> tiles_to_fade_; ///< Tiles that need more visuals for LODs, without duplicates.

	const InstanceState *state_ = nullptr;
	std::unordered_set<std::uint64_t> hidden_ids_;
	RedrawQueue redraws_;
};

} // namespace thicket
