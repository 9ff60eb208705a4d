#pragma once

#include "core/base/caller_threads.hpp"
#include "core/base/progress.hpp"
#include "core/base/rect.hpp"
#include "core/sampling/obstacles.hpp"
#include "core/sampling/point_set.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace thicket {

class BlockCache;

/// Statistics of the last TileSampler::sample() call.
struct SampleStats {
	std::uint64_t kept = 0;          ///< Number of points returned.
	std::uint64_t computed = 0;      ///< Number of accepted points, including margins and coarser levels.
	std::uint64_t darts = 0;         ///< Number of darts evaluated.
	std::uint64_t squares = 0;       ///< Number of active squares created, including base squares.
	std::uint64_t cells = 0;         ///< Number of cells initialized, including the margin.
	std::uint32_t retries = 0;       ///< Number of extra attempts at blocks, each with a wider margin.
	std::size_t workspace_bytes = 0; ///< Memory of the grids of all levels, in bytes.

	/// Adds the statistics that another worker collected during the same call.
	void add(const SampleStats &other);
};

/// Whether the rectangles that a caller samples overlap.
enum class WindowUse : std::uint8_t {
	separate,
	/// Much of a rectangle was or will be sampled for other rectangles. Its points are then cached,
	/// also those of rectangles that are too large for cached blocks.
	overlapping,
};

/// Samples any rectangle of a fixed, infinite Poisson-disk set. The sampler implements hierarchical
/// dart throwing (White, Cline, Egbert 2007, sections 2 and 3) as a race of hashed exponential
/// clocks. The expanding wavefront of section 4.3 advances on demand.
///
/// Guarantees for one PointSet, across all calls, rectangles, orders, threads, compilers and
/// instruction sets:
///  (1) a rectangle returns exactly the points of the set that it contains, always bit-identical;
///  (2) no two points are closer than the radius, by exact lattice arithmetic;
///  (3) the set is maximal: no lattice point remains where another point would fit;
///  (4) with levels = 1, the set has the distribution of naive dart throwing run to completion.
///
/// A sampler keeps its memory between calls and, after the first ones, allocates only when
/// `r_points` must grow. Results do not depend on earlier calls. Each thread needs its own sampler.
class TileSampler {
public:
	/// `margins` and `cache` affect the amount of computation, never the points. Several samplers
	/// may share one cache. Without a cache, pass null.
	explicit TileSampler(const SampleMargins &margins = {}, std::shared_ptr<BlockCache> cache = nullptr);
	~TileSampler();
	TileSampler(TileSampler &&) noexcept;
	TileSampler &operator=(TileSampler &&) noexcept;

	/// Replaces the contents of `r_points` with the points of `set` in `rect` (meters), in an order
	/// that depends only on the arguments. `rect` must lie within cell_limit cells of the origin
	/// (+-2^23 * radius / sqrt(2) meters) and contain at most max_points_per_call points. An empty
	/// rectangle returns no points and no error. Setting `progress.cancel` ends the call within
	/// about a millisecond. The call takes O(points) time. The workspace does not grow with the
	/// rectangle.
	///
	/// Errors: If `set` or `rect` is invalid, the call fails and `r_points` is unchanged. After
	/// ErrorCode::margin_too_wide, `r_points` is empty: even the maximum margin did not decide a
	/// point. The status then contains the seed, radius and position. After
	/// ErrorCode::out_of_memory, `r_points` is empty, and the status contains the number of bytes
	/// that the points of `rect` need.
	///
	/// If `threads` is not null, its threads share a rectangle that spans several blocks. A block
	/// is 128 cells, or 90 radii, wide. The result is the same.
	///
	/// If `obstacles` is not null, the set is filled: it is maximal outside the obstacles. Ids and
	/// the radius stay the same, and the obstacles determine the margin. If it is too narrow, the
	/// call fails with ErrorCode::margin_too_wide; the caller can then provide the obstacles of a
	/// wider area. Filled sets do not use the cache.
	///
	/// `use` affects only the use of the cache, and never the result.
	Status sample(const PointSet &set, const Rect &rect, std::vector<SamplePoint> &r_points,
			const Progress &progress = {}, CallerThreads *threads = nullptr, const Obstacles *obstacles = nullptr,
			WindowUse use = WindowUse::separate);

	const SampleStats &stats() const;

private:
	struct Workspace;
	std::unique_ptr<Workspace> workspace_;
};

} // namespace thicket
