#pragma once

#include "nodes/layer/layer_snapshot.hpp"

#include <godot_cpp/classes/material.hpp>
#include <godot_cpp/classes/ref.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// Passes the wind's time to those materials of a node's layers that include foliage.gdshaderinc.
/// These materials do not use the shader's TIME, which would make the editor redraw continuously.
/// All nodes pass the same time, because they may share materials. Use it only on the main thread.
class WindTime {
public:
	void set_layers(std::span<const SharedSnapshot> layers);

	/// Advances the shared time by `seconds`, once per `frame`, and writes it to the materials.
	void advance(double seconds, std::uint64_t frame);

private:
	std::vector<godot::Ref<godot::Material>> materials_;
};

} // namespace thicket
