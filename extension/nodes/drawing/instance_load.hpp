#pragma once

#include "nodes/layer/layer_snapshot.hpp"
#include "nodes/drawing/tile_display.hpp"

#include <godot_cpp/variant/packed_string_array.hpp>

#include <span>
#include <vector>

namespace thicket {

/// Finds layers whose settings require more instances than a typical machine has memory for.
class InstanceLoad {
public:
	/// Discards the results of `measure`. Call it when the settings or the ground have changed.
	void forget() { visible_fractions_.clear(); }

	/// Measures the fraction of each layer's points that its rules keep. Call it while all tiles
	/// are displayed.
	void measure(const TileDisplay &display, std::span<const SharedSnapshot> layers);

	/// Adds a message for each of these layers to `r_problems`.
	void add_problems(std::span<const SharedSnapshot> layers, godot::PackedStringArray &r_problems) const;

private:
	/// The fraction of each layer's points that its rules keep, 0 to 1. Empty until measured.
	std::vector<double> visible_fractions_;
};

} // namespace thicket
