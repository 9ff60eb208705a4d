#include "nodes/layer/scatter_tile_grid.hpp"

#include "nodes/common/engine_arrays.hpp"
#include "nodes/common/property_check.hpp"

#include <godot_cpp/core/class_db.hpp>

#include <algorithm>
#include <array>

using namespace godot;

namespace thicket {

namespace {

Vector2i tile_vector(glm::ivec2 tile) { return {tile.x, tile.y}; }

} // namespace

void ScatterTileGrid::set_tile_size(double p_size) {
	if (accept_number(class_name, "tile_size", p_size, 0.1, 1e6)) {
		tile_size_ = p_size;
	}
}

bool ScatterTileGrid::accept(const char *p_property, double p_coordinate) const {
	const double farthest = max_coordinate * tile_size_;
	return accept_number(class_name, p_property, p_coordinate, -farthest, farthest);
}

Vector2i ScatterTileGrid::get_tile_at(double p_x, double p_z) const {
	return accept("x", p_x) && accept("z", p_z) ? tile_vector(tile_at(tile_size_, {p_x, p_z})) : Vector2i();
}

PackedFloat64Array ScatterTileGrid::get_tile_bounds(const Vector2i &p_tile) const {
	const Rect square = tile_rect(tile_size_, {p_tile.x, p_tile.y});
	PackedFloat64Array result;
	std::ranges::copy(std::array{square.min.x, square.min.y, square.max.x, square.max.y}, resize(result, 4).begin());
	return result;
}

Rect2i ScatterTileGrid::get_tiles_in(const PackedFloat64Array &p_bounds) const {
	if (p_bounds.size() != 4) {
		report(class_name, Status::wrong_size("bounds", p_bounds.size(), exactly(4, "min x, min z, max x, max z")));
		return {};
	}
	for (const double coordinate : p_bounds) {
		if (!accept("bounds", coordinate)) {
			return {};
		}
	}
	const double *bounds = p_bounds.ptr();
	const TileRange tiles = tiles_in(tile_size_, {{bounds[0], bounds[1]}, {bounds[2], bounds[3]}});
	return tiles.empty() ? Rect2i() : Rect2i(tile_vector(tiles.first), tile_vector(tiles.last - tiles.first + 1));
}

void ScatterTileGrid::_bind_methods() {
	using Self = ScatterTileGrid;
	bind_guarded<&Self::set_tile_size>(D_METHOD("set_tile_size", "size"));
	bind_guarded<&Self::get_tile_size>(D_METHOD("get_tile_size"));
	bind_guarded<&Self::get_tile_at>(D_METHOD("get_tile_at", "x", "z"));
	bind_guarded<&Self::get_tile_bounds>(D_METHOD("get_tile_bounds", "tile"));
	bind_guarded<&Self::get_tiles_in>(D_METHOD("get_tiles_in", "bounds"));
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "tile_size", PROPERTY_HINT_RANGE, "0.1,1000000,0.1,exp,suffix:m"),
			"set_tile_size", "get_tile_size");
}

} // namespace thicket
