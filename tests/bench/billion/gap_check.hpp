#pragma once

#include "region.hpp"
#include "tile_check.hpp"

#include "tests/analysis/lattice_checks.hpp"

#include "core/base/split_mix.hpp"
#include "core/base/status.hpp"
#include "core/sampling/dart.hpp"
#include "core/sampling/point_set.hpp"

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace thicket::bench::billion {

/// Returns the points of a rectangle, as TileSampler::sample does.
using TileSource = std::function<Status(const Rect &rect, std::vector<SamplePoint> &r_points)>;

/// Results of the exact gap checks.
struct GapFindings {
	std::uint64_t tiles = 0; ///< The number of checked tiles.
	/// Number of lattice points in these tiles that are not within the radius of any point.
	std::uint64_t uncovered = 0;
	/// Number of tiles whose points differed when sampled as part of a larger rectangle.
	std::uint64_t changed = 0;

	GapFindings &operator+=(const GapFindings &other) {
		tiles += other.tiles;
		uncovered += other.uncovered;
		changed += other.changed;
		return *this;
	}
};

/// Returns true for one in `every` tiles, chosen by a hash. If `every` is 0, returns false.
inline bool is_drawn(std::uint64_t tile, std::uint64_t key, std::uint64_t every) {
	return every > 0 && split_mix(tile * split_mix_gamma + split_mix(key)) % every == 0;
}

/// Finds lattice points in tiles that no point covers. The object keeps its memory between tiles.
/// Each thread needs its own.
class GapCheck {
public:
	/// Checks the tile that was last passed to `tile.take`, whose points had this digest. `source`
	/// returns the points around the tile, and must return the tile's points again.
	Status take(const TileCheck &tile, const Digest &digest, const TileSource &source, GapFindings &r_found) {
		const CellRect &cells = tile.tile();
		if (const Status status = source(world_rect(cells.grown(border)), around_); !status.ok()) {
			return status;
		}
		lattice_.clear();
		for (const glm::ivec2 point : tile.entered()) {
			lattice_.emplace_back(point + tile.origin());
		}
		Digest repeated;
		for (const SamplePoint &point : around_) {
			glm::ivec2 lattice;
			if (!lattice_of(point, lattice)) {
				continue;
			}
			if (cells.contains({lattice.x >> lattice_bits, lattice.y >> lattice_bits})) {
				repeated.add(point, lattice);
			} else {
				lattice_.emplace_back(lattice);
			}
		}
		const analysis::LatticeReport report =
				analysis::LatticeCheck::run(lattice_, lattice_bits, {cells.min, cells.max});
		++r_found.tiles;
		r_found.uncovered += report.uncovered;
		r_found.changed += repeated == digest ? 0 : 1;
		return {};
	}

private:
	static constexpr std::int32_t border = 3; ///< The border that the lattice check needs.

	std::vector<SamplePoint> around_;
	std::vector<glm::i64vec2> lattice_;
};

} // namespace thicket::bench::billion
