#pragma once

#include "core/query/instance_query.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// Returns known tiles, and generates the missing ones of a call together.
class MakingTileSource : public TileSource {
public:
	Status find_tile(std::uint32_t layer, glm::ivec2 tile, std::shared_ptr<const KeptTile> &r_tile) final;
	Status find_tiles(std::span<const WorldTile> tiles, std::vector<std::shared_ptr<const KeptTile>> &r_tiles) final;

private:
	/// A known tile; null if it is not known.
	virtual std::shared_ptr<const KeptTile> find(const WorldTile &tile) = 0;

	/// Generates tiles, as a TileMaker does.
	virtual Status make(std::span<const WorldTile> tiles, std::vector<std::shared_ptr<const KeptTile>> &r_tiles) = 0;

	/// Called for each tile that was generated.
	virtual void keep(const WorldTile &tile, const std::shared_ptr<const KeptTile> &made) = 0;
};

/// The size of a tile where memory is bounded: the number of its instances plus one, because an empty tile takes memory, too.
std::size_t kept_size(const KeptTile &tile);

} // namespace thicket
