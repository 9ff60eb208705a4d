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

/// Limits on the number of drawn instances and multimeshes, independent of distance.
struct DrawLimits {
	double quality = 1.0; ///< Fraction of the instances of every tile, 0 to 1.
	/// Maximum number of drawn instances, for all tiles together.
	std::uint64_t max_instances = std::numeric_limits<std::uint64_t>::max();
	/// Maximum number of multimeshes, for all tiles together. No tile is divided if its cells would
	/// exceed this number.
	std::uint64_t max_multimeshes = 8192;
	/// One entry per layer; hidden layers draw nothing. Layers without an entry are visible.
	std::vector<bool> hidden_layers;

	/// Returns the fraction of a layer's instances that is drawn, before thinning by distance.
	double fraction(std::size_t layer) const {
		return layer < hidden_layers.size() && hidden_layers[layer] ? 0.0 : quality;
	}

	friend bool operator==(const DrawLimits &, const DrawLimits &) = default;
};

/// The amounts that a visible tile contributes to the totals.
struct DrawAmounts {
	std::uint64_t instances = 0; ///< All instances, drawn or not.
	std::uint64_t bytes = 0;     ///< Main memory used by the instances.
	std::uint64_t multimeshes = 0;
	std::uint64_t drawn_count = 0;  ///< Instances that are drawn if they are in the camera's view.
	std::uint64_t wanted_count = 0; ///< Instances that would be drawn without max_instances.

	DrawAmounts &operator+=(const DrawAmounts &other);
	DrawAmounts &operator-=(const DrawAmounts &other);
	friend bool operator==(const DrawAmounts &, const DrawAmounts &) = default;
};

/// Distributes the limits among all tiles. The class only makes decisions, like TileStreamer.
///
/// Guarantees:
///  (1) After each `draw`, all cells together draw at most `max_instances`. If a lower limit was
///      just set, each `draw` of a cell removes instances until the limit is met.
///  (2) If the limit thins some cells, the next `begin_frame` lowers the fraction for every cell,
///      so that all cells are soon thinned equally.
///  (3) The fraction rises only when less than 70 % of the limit is in use, and then to 90 %, so it
///      does not change with every tile.
///  (4) `take_cut` returns each tile that is thinned more than other tiles, in every frame until it
///      no longer is.
class DrawBudget {
public:
	/// Sets limits that the next `begin_frame` applies.
	void set_limits(const DrawLimits &limits) { next_limits_ = limits; }
	const DrawLimits &limits() const { return next_limits_; }

	/// Applies new limits and updates the fraction of instances to draw. Returns true if either has
	/// changed; `draw` must then be called again for every cell.
	bool begin_frame();

	/// These functions add the amounts of a tile that has become visible and remove those of a tile
	/// that was removed. For a changed tile, call `remove` with the old amounts and `add` with the
	/// new ones.
	void add(const DrawAmounts &amounts) { amounts_ += amounts; }
	void remove(const DrawAmounts &amounts) { amounts_ -= amounts; }
	const DrawAmounts &amounts() const { return amounts_; }

	/// Computes the density and counts of a cell of a visible tile. Call this function after
	/// `adapt`. `lod_density` is the fraction of instances, 0 to 1, that the cell's first LOD draws
	/// according to its settings. `ranks` are the ranks of the cell's instances, ascending. Returns
	/// false if the limit thins the cell more than other cells.
	bool draw(std::uint32_t layer, double lod_density, std::span<const std::uint32_t> ranks, CellDrawing &r_cell);

	/// Returns the fraction, 0 to 1, of a layer's instances that is drawn at a distance in meters
	/// from a viewer, if the layer is visible.
	double drawn_fraction(const LodSettings &settings, double distance) const {
		return thinned_density(settings, distance) * limits_.quality * fraction_;
	}

	/// Records a tile with a cell for which `draw` returned false.
	void record_cut(const TileKey &key) { cut_tiles_.insert(key); }

	/// Returns and clears the recorded tiles.
	std::set<TileKey, TileKeyOrder> take_cut();

	std::uint64_t max_multimeshes() const { return limits_.max_multimeshes; }
	bool has_room_for(std::uint64_t multimeshes) const {
		return amounts_.multimeshes + multimeshes <= limits_.max_multimeshes;
	}

	/// Removes all tiles and keeps the limits.
	void clear();

private:
	DrawLimits limits_; ///< The limits that apply in this frame.
	DrawLimits next_limits_;
	DrawAmounts amounts_;
	/// Fraction of the wanted instances that are drawn, which keeps them within max_instances.
	double fraction_ = 1.0;
	std::set<TileKey, TileKeyOrder> cut_tiles_;
};

} // namespace thicket
