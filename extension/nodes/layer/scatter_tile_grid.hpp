#pragma once

#include "core/base/tile_grid.hpp"
#include "nodes/common/guard.hpp"

#include <godot_cpp/classes/ref_counted.hpp>
#include <godot_cpp/variant/packed_float64_array.hpp>
#include <godot_cpp/variant/rect2i.hpp>
#include <godot_cpp/variant/vector2i.hpp>

namespace thicket {

/// A grid of square tiles in the world, for scripts. This is core/base/tile_grid.hpp in double
/// precision. Bounds are arrays of min x, min z, max x and max z in meters; they are half-open.
class ScatterTileGrid : public godot::RefCounted, public ThreadGuarded {
	GDCLASS(ScatterTileGrid, godot::RefCounted)
	THICKET_GUARDED_METHODS(owner)

public:
	/// Sets the edge length of a tile in meters, 0.1 to 1e6. Any other value prints an error and is
	/// ignored.
	void set_tile_size(double p_size);
	double get_tile_size() const { return tile_size_; }

	/// Returns the tile that contains a position (meters). If a coordinate is beyond max_coordinate
	/// tiles, prints an error and returns tile (0, 0).
	godot::Vector2i get_tile_at(double p_x, double p_z) const;

	/// Returns the bounds of a tile.
	godot::PackedFloat64Array get_tile_bounds(const godot::Vector2i &p_tile) const;

	/// Returns the tiles that overlap the bounds: the first tile, and the counts along x and z.
	/// Empty bounds overlap no tiles. If the bounds are not four numbers, or if get_tile_at would
	/// reject one of them, prints an error and returns no tiles.
	godot::Rect2i get_tiles_in(const godot::PackedFloat64Array &p_bounds) const;

	static constexpr const char *class_name = "ScatterTileGrid";

	/// The limit of tile coordinates, in tiles from the origin. The number of tiles in a row from
	/// -max_coordinate to max_coordinate fits in an int.
	static constexpr double max_coordinate = max_tile_coordinate / 2;

protected:
	static void _bind_methods();

private:
	bool accept(const char *p_property, double p_coordinate) const;

	double tile_size_ = 64.0;
};

} // namespace thicket
