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

/// What the last `TileSampler::sample` did.
struct SampleStats {
	std::uint64_t kept = 0;          ///< Points handed out.
	std::uint64_t computed = 0;      ///< Points accepted anywhere, margin and coarser levels included.
	std::uint64_t darts = 0;         ///< Darts evaluated.
	std::uint64_t squares = 0;       ///< Active squares made, base squares included.
	std::uint64_t cells = 0;         ///< Cells initialized, margin included.
	std::uint32_t retries = 0;       ///< Blocks that ran again with a wider margin.
	std::size_t workspace_bytes = 0; ///< Workspace held, all levels.

	/// What another worker has done of the same call.
	void add(const SampleStats &other);
};

/// A window onto a fixed infinite Poisson-disk set: hierarchical dart throwing (White, Cline, Egbert 2007, sections 2
/// and 3) as a race of hashed exponential clocks, with the expanding wavefront of section 4.3 driven by demand.
///
/// Promises, for one PointSet, over all calls, rectangles, orders, threads, compilers and instruction sets:
///  (1) a point of the set comes out, bit for bit the same, for every rectangle that contains it, and no other does;
///  (2) no two points are closer than the radius, exactly, on the lattice;
///  (3) no lattice point is left where one more would fit;
///  (4) with levels = 1 the set is distributed like naive dart throwing run to its end.
///
/// The object is a reusable workspace: it keeps its memory between calls and, once warm, allocates only when
/// `r_points` must grow. Results do not depend on what it was used for before. Not thread safe; one per thread.
class TileSampler {
public:
	/// `margins` and `cache`, which may serve other samplers too, change how much is computed, never what comes out.
	explicit TileSampler(const SampleMargins &margins = {}, std::shared_ptr<BlockCache> cache = nullptr);
	~TileSampler();
	TileSampler(TileSampler &&) noexcept;
	TileSampler &operator=(TileSampler &&) noexcept;

	/// Replaces the contents of `r_points` by the points of `set` in `rect` (meters), in an order that is a function
	/// of the arguments alone. `rect` must lie within cell_limit cells of the origin (+-2^23 * radius / sqrt(2)
	/// meters) and ask for at most max_points_per_call points; an empty rectangle gives no points and no error, an
	/// inverted or non-finite one is refused, with `r_points` untouched. Raising `progress.cancel` ends the call within about
	/// a millisecond. After ErrorCode::margin_too_wide (the widest margin does not decide a point, and the status names seed,
	/// radius and position) and after ErrorCode::out_of_memory (it names the bytes that the points of `rect` take) `r_points`
	/// is empty. O(points) time; bounded memory, whatever the rectangle.
	///
	/// A rectangle of several blocks (128 cells, or 90 radii, wide) is shared with `threads`, if there are any, for the same result.
	Status sample(const PointSet &set, const Rect &rect, std::vector<SamplePoint> &r_points,
			const Progress &progress = {}, LentThreads *threads = nullptr);

	const SampleStats &stats() const;

private:
	struct Workspace;
	std::unique_ptr<Workspace> workspace_;
};

} // namespace thicket
