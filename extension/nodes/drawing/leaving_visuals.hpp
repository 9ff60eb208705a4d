#pragma once

#include "core/base/world_frame.hpp"
#include "nodes/drawing/tile_visual.hpp"

#include <glm/vec3.hpp>

#include <cstddef>
#include <utility>
#include <vector>

namespace thicket {

/// Visuals that are no longer needed. Freeing a visual is slow in the renderer, so all are hidden
/// first and then freed step by step. Use it only on the main thread.
class LeavingVisuals {
public:
	void add(TileVisual visual) { visuals_.push_back(std::move(visual)); }

	/// Allocates memory in advance, so that the next `count` calls to `add` cannot throw.
	void reserve(std::size_t count) { visuals_.reserve(visuals_.size() + count); }

	/// Hides some visuals or, if all are hidden, frees one. Because of this order, no removed tile
	/// stays visible while others are freed. Returns false if no visual is left.
	bool free_step();

	std::size_t size() const { return visuals_.size(); }
	bool are_hidden() const { return hidden_count_ == visuals_.size(); }
	void set_frame(const WorldFrame &frame);

	/// Frees all visuals immediately.
	void clear();

private:
	std::vector<TileVisual> visuals_;
	/// The number of hidden visuals, which come first in `visuals_`.
	std::size_t hidden_count_ = 0;
};

} // namespace thicket
