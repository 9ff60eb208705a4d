#pragma once

#include "core/base/lent_threads.hpp"
#include "core/base/progress.hpp"
#include "core/base/rect.hpp"
#include "core/sampling/point_set.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace thicket {

class BlockCache;

/// Statistics of the last `TileSampler::sample`.
struct SampleStats {
	std::uint64_t kept = 0;          ///< Points returned.
	std::uint64_t computed = 0;      ///< Points accepted anywhere, including margin and coarser levels.
	std::uint64_t darts = 0;         ///< Darts evaluated.
	std::uint64_t squares = 0;       ///< Active squares created, including base squares.
	std::uint64_t cells = 0;         ///< Cells initialized, including the margin.
	std::uint32_t retries = 0;       ///< Blocks that ran again with a wider margin.
	std::size_t workspace_bytes = 0; ///< Workspace held by all levels.

	/// Adds the statistics of a different worker for the same call.
	void add(const SampleStats &other);
};

/// A window onto a fixed infinite Poisson-disk set: hierarchical dart throwing (White, Cline, Egbert 2007, sections 2 and 3) as a race of
/// hashed exponential clocks, with the expanding wavefront of section 4.3 driven by demand.
///
/// Promises, for one PointSet, over all calls, rectangles, orders, threads, compilers and instruction sets:
///  (1) every rectangle that contains a point of the set returns that point, bit for bit the same, and no other rectangle does;
///  (2) no two points are closer than the radius, exactly, on the lattice;
///  (3) no lattice point is left where a further point would fit;
///  (4) with levels = 1 the set is distributed like naive dart throwing run to its end.
///
/// The object is a reusable workspace: it keeps its memory between calls and, once warm, allocates only when `r_points` must grow.
/// Results do not depend on earlier calls. Not thread safe; use one per thread.
class TileSampler {
public:
	/// `margins` and `cache` change how much is computed, never the result. Other samplers may share the cache.
	explicit TileSampler(const SampleMargins &margins = {}, std::shared_ptr<BlockCache> cache = nullptr);
	~TileSampler();
	TileSampler(TileSampler &&) noexcept;
	TileSampler &operator=(TileSampler &&) noexcept;

	/// Replaces the contents of `r_points` with the points of `set` in `rect` (meters), in an order that depends only
	/// on the arguments. `rect` must lie within cell_limit cells of the origin (+-2^23 * radius / sqrt(2) meters) and
	/// contain at most max_points_per_call points. An empty rectangle returns no points and no error. An inverted or
	/// non-finite rectangle is refused, and `r_points` is unchanged. Raising `progress.cancel` ends the call within
	/// about a millisecond. `r_points` is empty after ErrorCode::margin_too_wide (the widest margin does not decide a
	/// point; the status contains the seed, radius and position) and after ErrorCode::out_of_memory (the status
	/// contains the number of bytes that the points of `rect` take). O(points) time; bounded memory, whatever the
	/// rectangle.
	///
	/// Shares a rectangle of several blocks (128 cells, or 90 radii, wide) with `threads`, if there are any. The result is the same.
	Status sample(const PointSet &set, const Rect &rect, std::vector<SamplePoint> &r_points,
			const Progress &progress = {}, LentThreads *threads = nullptr);

	const SampleStats &stats() const;

private:
	struct Workspace;
	std::unique_ptr<Workspace> workspace_;
};

} // namespace thicket
