#pragma once

#include "nodes/drawing/tile_visual.hpp"

#include <glm/vec3.hpp>

#include <cstddef>
#include <utility>
#include <vector>

namespace thicket {

/// Visuals that are no longer drawn. Freeing one takes the renderer a while, so they are hidden and then freed step by step. Main thread
/// only.
class LeavingVisuals {
public:
	void add(TileVisual visual) { visuals_.push_back(std::move(visual)); }

	/// Allocates memory in advance, so that the next `count` calls of `add` throw nothing.
	void reserve(std::size_t count) { visuals_.reserve(visuals_.size() + count); }

	/// Hides some visuals. If all are hidden, frees one: no removed tile must stay visible while others are freed.
	/// Returns false if no visual is left.
	bool free_step();

	std::size_t size() const { return visuals_.size(); }
	bool are_hidden() const { return hidden_ == visuals_.size(); }
	void set_offset(glm::dvec3 offset);

	/// Frees all of them immediately.
	void clear();

private:
	std::vector<TileVisual> visuals_;
	std::size_t hidden_ = 0; ///< The number of visuals, from the first on, that are hidden.
};

} // namespace thicket
