#pragma once

#include "nodes/layer/layer_snapshot.hpp"

#include <godot_cpp/classes/material.hpp>
#include <godot_cpp/classes/ref.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// Passes the time of the wind to the materials of a node's layers that include foliage.gdshaderinc. They do not use the shader's TIME, because the
/// editor would then draw without a pause. All nodes pass the same time, as they may share materials. Main thread only.
class WindTime {
public:
	void set_layers(std::span<const SharedSnapshot> layers);

	/// Writes the time of a frame. `seconds` have passed since the last frame.
	void advance(double seconds, std::uint64_t frame);

private:
	std::vector<godot::Ref<godot::Material>> materials_;
};

} // namespace thicket
