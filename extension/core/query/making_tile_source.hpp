#pragma once

#include "core/query/instance_query.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// Gives tiles that are known, and has the others of a call made in one go.
class MakingTileSource : public TileSource {
public:
	Status find_tile(std::uint32_t layer, glm::ivec2 tile, std::shared_ptr<const KeptTile> &r_tile) final;
	Status find_tiles(std::span<const WorldTile> tiles, std::vector<std::shared_ptr<const KeptTile>> &r_tiles) final;

private:
	/// A known tile; null for one that is not.
	virtual std::shared_ptr<const KeptTile> find(const WorldTile &tile) = 0;

	/// As a TileMaker.
	virtual Status make(std::span<const WorldTile> tiles, std::vector<std::shared_ptr<const KeptTile>> &r_tiles) = 0;

	/// Is told of each tile that was made.
	virtual void keep(const WorldTile &tile, const std::shared_ptr<const KeptTile> &made) = 0;
};

/// What a tile counts for where memory is bounded: its instances of all meshes, and one, as a tile without any takes memory, too.
std::size_t kept_size(const KeptTile &tile);

} // namespace thicket
