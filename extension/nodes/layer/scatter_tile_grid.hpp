#pragma once

#include "core/base/tile_grid.hpp"
#include "nodes/common/guard.hpp"

#include <godot_cpp/classes/ref_counted.hpp>
#include <godot_cpp/variant/packed_float64_array.hpp>
#include <godot_cpp/variant/rect2i.hpp>
#include <godot_cpp/variant/vector2i.hpp>

namespace thicket {

/// A grid of tiles of one size in the world: core/base/tile_grid.hpp for scripts, in double precision. Bounds are min
/// x, min z, max x and max z in meters, half-open.
class ScatterTileGrid : public godot::RefCounted, public ThreadGuarded {
	GDCLASS(ScatterTileGrid, godot::RefCounted)
	THICKET_GUARDED_METHODS(owner)

public:
	/// Meters, 0.1 to 1e6. Any other value is ignored with an error.
	void set_tile_size(double p_size);
	double get_tile_size() const { return tile_size_; }

	/// The tile that contains a position. A coordinate beyond max_coordinate tiles prints an error and returns tile (0, 0).
	godot::Vector2i get_tile_at(double p_x, double p_z) const;

	/// The square of a tile.
	godot::PackedFloat64Array get_tile_bounds(const godot::Vector2i &p_tile) const;

	/// The tiles that contain points of the bounds: the first tile, and the count along x and z. Empty bounds contain
	/// no tiles. If the bounds are not four numbers, or get_tile_at would refuse one of them, prints an error and
	/// returns no tiles.
	godot::Rect2i get_tiles_in(const godot::PackedFloat64Array &p_bounds) const;

	static constexpr const char *class_name = "ScatterTileGrid";

	/// In tiles from the origin. An int can still count a row of twice as many tiles.
	static constexpr double max_coordinate = max_tile_coordinate / 2;

protected:
	static void _bind_methods();

private:
	bool accept(const char *p_property, double p_along) const;

	double tile_size_ = 64.0;
};

} // namespace thicket
