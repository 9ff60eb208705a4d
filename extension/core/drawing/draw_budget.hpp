#pragma once

#include "core/drawing/cell_drawing.hpp"
#include "core/drawing/tile_key_order.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>
#include <span>
#include <vector>

namespace thicket {

/// Limits on how much of the tiles is drawn, whatever the distance.
struct DrawLimits {
	double quality = 1.0;                                                    ///< Share of every tile, 0 to 1.
	std::uint64_t max_instances = std::numeric_limits<std::uint64_t>::max(); ///< For all tiles together.
	std::uint64_t max_multimeshes = 8192; ///< For all tiles together: beyond that, no tile is divided for drawing.
	std::vector<bool> hidden_layers;      ///< By index; hidden layers draw nothing. Missing entries are visible.

	/// The share of a layer's tiles that is drawn, whatever the distance.
	double share(std::size_t layer) const {
		return layer < hidden_layers.size() && hidden_layers[layer] ? 0.0 : quality;
	}

	friend bool operator==(const DrawLimits &, const DrawLimits &) = default;
};

/// The amounts that a visible tile adds to those of all tiles.
struct DrawAmounts {
	std::uint64_t instances = 0; ///< Drawn or not.
	std::uint64_t bytes = 0;     ///< Main memory that the instances take.
	std::uint64_t multimeshes = 0;
	std::uint64_t drawn = 0;  ///< Instances that are drawn when in view.
	std::uint64_t wanted = 0; ///< Instances that would be drawn without the limit for all tiles.

	DrawAmounts &operator+=(const DrawAmounts &other);
	DrawAmounts &operator-=(const DrawAmounts &other);
	friend bool operator==(const DrawAmounts &, const DrawAmounts &) = default;
};

/// Divides the limits among all tiles. Pure logic, like TileStreamer.
///
/// Promises:
///  (1) After each `draw`, at most `max_instances` are drawn in all cells together, unless a lower limit has just been set: then each `draw`
/// of a cell removes instances until the limit holds.
///  (2) If the limit thins some cells, it soon thins all of them alike: the next `begin_frame` lowers the share of every cell.
///  (3) The share rises only once less than 70 % of the limit is in use, and then to 90 %, so it does not change with every tile.
///  (4) A tile that is thinned more than others is returned by `take_cut` in the next frame, until it is not.
class DrawBudget {
public:
	/// `begin_frame` applies them.
	void set_limits(const DrawLimits &limits) { next_limits_ = limits; }
	const DrawLimits &limits() const { return next_limits_; }

	/// Applies new limits and a new share. Returns true if any of them has changed; every cell must then be drawn
	/// again.
	bool begin_frame();

	/// Reports that a tile has become visible, or was removed or changed: its amounts before and after.
	void add(const DrawAmounts &amounts) { amounts_ += amounts; }
	void remove(const DrawAmounts &amounts) { amounts_ -= amounts; }
	const DrawAmounts &amounts() const { return amounts_; }

	/// Sets density and counts of a cell of a visible tile after `adapt`. `look_share` is the share that the cell's
	/// first LOD draws by its own settings, 0 to 1. `ranks` are the ranks of the cell's instances, ascending. Returns
	/// false if the limit thins the cell more than others.
	bool draw(std::uint32_t layer, double look_share, std::span<const std::uint32_t> ranks, CellDrawing &r_cell);

	/// The share of a layer's instances that is drawn at a distance from a viewer, if the layer is not hidden. Meters; 0 to 1.
	double drawn_share(const LodSettings &settings, double distance) const {
		return thinned_density(settings, distance) * limits_.quality * share_;
	}

	/// Notes a tile with a cell for which `draw` returned false.
	void note_cut(const TileKey &key) { cut_.insert(key); }

	/// The tiles noted since the last call, each once.
	std::set<TileKey, TileKeyOrder> take_cut();

	std::uint64_t max_multimeshes() const { return limits_.max_multimeshes; }
	bool has_room_for(std::uint64_t multimeshes) const {
		return amounts_.multimeshes + multimeshes <= limits_.max_multimeshes;
	}

	/// Forgets all tiles and keeps the limits.
	void clear();

private:
	DrawLimits limits_; ///< The limits that apply in this frame.
	DrawLimits next_limits_;
	DrawAmounts amounts_;
	double share_ = 1.0; ///< The share of the wanted instances that is drawn, so that max_instances is not exceeded.
	std::set<TileKey, TileKeyOrder> cut_;
};

} // namespace thicket
