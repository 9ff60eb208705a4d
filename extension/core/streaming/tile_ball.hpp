#pragma once

#include "core/streaming/tile_disc.hpp"
#include "core/streaming/tile_streamer.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// The tiles of a layer that touch a ball, stored as one disc of tiles for each slab. If the tiles
/// cover all heights, there is a single disc. Tile coordinates are column, row and slab.
class TileBall {
public:
	/// Replaces the tiles with those of `layer` that are at most `reach` meters (0 or more) from
	/// `center` (world meters).
	void set(const StreamLayer &layer, const glm::dvec3 &center, double reach);
	void clear() { discs_.clear(); }

	bool contains(const glm::ivec3 &at) const { return disc(at.z).contains({at.x, at.y}); }

	/// Calls `visit(at)` for each tile that is not in `other`, slab by slab.
	template <class Visit>
	void visit_without(const TileBall &other, Visit &&visit) const {
		std::int32_t slab = first_slab_;
		for (const TileDisc &mine : discs_) {
			mine.visit_without(other.disc(slab), [&](glm::ivec2 tile) { visit(glm::ivec3(tile, slab)); });
			++slab;
		}
	}

private:
	const TileDisc &disc(std::int32_t slab) const {
		const auto index =
				static_cast<std::size_t>(static_cast<std::uint32_t>(slab) - static_cast<std::uint32_t>(first_slab_));
		return index < discs_.size() ? discs_[index] : nothing_;
	}

	std::int32_t first_slab_ = 0;
	std::vector<TileDisc> discs_; ///< One for each slab, ascending from `first_slab_`.
	TileDisc nothing_;
};

} // namespace thicket
