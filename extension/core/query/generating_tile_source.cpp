#include "core/query/generating_tile_source.hpp"

#include <utility>

namespace thicket {

Status GeneratingTileSource::find_tile(const WorldTile &tile, std::shared_ptr<const CompactTile> &r_tile) {
	std::vector<std::shared_ptr<const CompactTile>> tiles;
	const Status status = find_tiles({&tile, 1}, tiles);
	r_tile = tiles.empty() ? nullptr : tiles.front();
	return status;
}

Status GeneratingTileSource::find_tiles(
		std::span<const WorldTile> tiles, std::vector<std::shared_ptr<const CompactTile>> &r_tiles) {
	std::vector<WorldTile> missing;
	std::vector<std::size_t> missed; // Indices of the missing tiles in `tiles`.
	r_tiles.clear();
	for (const WorldTile &tile : tiles) {
		r_tiles.push_back(find(tile));
		if (r_tiles.back() == nullptr) {
			missed.push_back(r_tiles.size() - 1);
			missing.push_back(tile);
		}
	}
	if (missing.empty()) {
		// All tiles are known.
		return {};
	}
	std::vector<std::shared_ptr<const CompactTile>> generated;
	const Status status = make(missing, generated);
	generated.resize(missing.size());
	for (std::size_t i = 0; i < missing.size(); ++i) {
		if (generated[i] != nullptr) {
			keep(missing[i], generated[i]);
		}
		r_tiles[missed[i]] = std::move(generated[i]);
	}
	return status;
}

std::size_t cached_size(const CompactTile &tile) {
	std::size_t size = 1;
	for (const CompactMesh &mesh : tile.meshes) {
		size += mesh.size();
	}
	return size;
}

} // namespace thicket
