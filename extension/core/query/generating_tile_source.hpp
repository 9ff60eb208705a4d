#pragma once

#include "core/query/instance_query.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// A tile source that returns known tiles and generates all missing tiles of a call in one batch.
class GeneratingTileSource : public TileSource {
public:
	Status find_tile(const WorldTile &tile, std::shared_ptr<const CompactTile> &r_tile) final;
	Status find_tiles(std::span<const WorldTile> tiles, std::vector<std::shared_ptr<const CompactTile>> &r_tiles) final;

private:
	/// Returns a known tile, or null.
	virtual std::shared_ptr<const CompactTile> find(const WorldTile &tile) = 0;

	/// Generates tiles; see TileMaker.
	virtual Status make(std::span<const WorldTile> tiles, std::vector<std::shared_ptr<const CompactTile>> &r_tiles) = 0;

	/// Receives each generated tile, for example to store it.
	virtual void keep(const WorldTile &tile, const std::shared_ptr<const CompactTile> &generated) = 0;
};

/// Returns the size of a tile, for limiting memory: the number of its instances plus one, because
/// an empty tile takes memory, too.
std::size_t cached_size(const CompactTile &tile);

} // namespace thicket
