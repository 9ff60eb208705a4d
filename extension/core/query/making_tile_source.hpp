#pragma once

#include "core/query/instance_query.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// Returns known tiles, and generates all other tiles of a call in one batch.
class MakingTileSource : public TileSource {
public:
	Status find_tile(std::uint32_t layer, glm::ivec2 tile, std::shared_ptr<const CompactTile> &r_tile) final;
	Status find_tiles(std::span<const WorldTile> tiles, std::vector<std::shared_ptr<const CompactTile>> &r_tiles) final;

private:
	/// A known tile; null if it is not known.
	virtual std::shared_ptr<const CompactTile> find(const WorldTile &tile) = 0;

	/// Works like a TileMaker.
	virtual Status make(std::span<const WorldTile> tiles, std::vector<std::shared_ptr<const CompactTile>> &r_tiles) = 0;

	/// Called for each tile that was generated.
	virtual void keep(const WorldTile &tile, const std::shared_ptr<const CompactTile> &made) = 0;
};

/// The size of a tile, where memory is limited: the number of its instances of all meshes, plus one, because an empty
/// tile takes memory, too.
std::size_t kept_size(const CompactTile &tile);

} // namespace thicket
