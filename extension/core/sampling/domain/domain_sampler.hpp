#pragma once

#include "core/sampling/domain/domain.hpp"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// Statistics of the last successful DomainSampler call.
struct DomainStats {
	std::uint64_t points = 0;
	std::uint64_t darts = 0; ///< Number of darts thrown, including accepted ones.
	/// Number of active squares created, including base squares (figure 6 of the paper, see
	/// DomainMethod).
	std::uint64_t squares = 0;
	std::uint64_t selections = 0;  ///< Number of choices of an active square.
	std::uint64_t list_checks = 0; ///< Number of lists checked in all choices together (figure 6 of the paper).
	/// Number of squares that rejected a dart and were too small to split. In single precision, each
	/// of them lies between positions that other squares still cover, so no gap results.
	std::uint64_t discarded = 0;
	std::uint32_t levels = 0;                    ///< Number of square levels used.
	std::vector<std::uint64_t> squares_by_level; ///< Number of active squares created at each level.
	double cell_size = 0.0;                      ///< Width of an acceleration grid cell in radii.
	std::size_t grid_bytes = 0;                  ///< Memory of the acceleration grid, including overflow (section 4.2).
	std::size_t square_bytes = 0; ///< Peak memory of the active squares, and the map of groups (section 4.2).

	std::size_t workspace_bytes() const { return grid_bytes + square_bytes; }
};

/// Fills a whole domain with one maximal Poisson-disk point set; see DomainMethod. `Real`, the type
/// of coordinates and distances, is float or double.
///
/// Guarantees for each method:
///  (1) no two points are closer than the radius, exactly, in the returned coordinates;
///  (2) no additional point fits (except for `naive`). In single precision, this holds for all
///      positions whose coordinates are multiples of a step. The step is 2^-23 of the smallest power
///      of two above the longer side, or above eight radii if that is more. Distances that exceed
///      the radius by less than 2^-20 of it may count as too close. Between the multiples of the
///      step, gaps remain that a set in double precision would fill. They lower the coverage of the
///      plane by about 0.3 * step / radius. In double precision, squares of 2^-32 base squares that
///      reject a dart would be discarded; no run has had any;
///  (3) every point lies in the half-open domain;
///  (4) equal requests return bit-identical points on every machine, for any `cell_size`;
///  (5) the points are distributed like those of naive dart throwing, but for `wavefront` only
///      nearly so (section 4.4).
///
/// The object keeps its memory only while the points can be visited. Each thread needs its own
/// object.
template <typename Real>
class DomainSampler {
public:
	DomainSampler();
	~DomainSampler();
	DomainSampler(DomainSampler &&) noexcept;
	DomainSampler &operator=(DomainSampler &&) noexcept;

	/// Replaces the contents of `r_points` with the points, in the order of their acceptance.
	/// `r_points` is unchanged if the request is invalid or cancelled, or if memory runs out
	/// (ErrorCode::out_of_memory). Takes expected O(points) time.
	Status sample(
			const DomainRequest &request, std::vector<glm::vec<2, Real>> &r_points, const Progress &progress = {});

	/// Fills a domain like `sample`, but keeps the points in the acceleration grid, for `visit`,
	/// instead of returning them. No memory beyond the workspace is needed.
	Status fill(const DomainRequest &request, const Progress &progress = {});

	/// Passes the points of the last `fill` to `visitor`, cell by cell. Both spans always have the
	/// same size. After a failed `fill` or a call to `sample`, there are no points to pass. However,
	/// a call with an invalid request leaves the points unchanged.
	void visit(const std::function<void(std::span<const Real> x, std::span<const Real> y)> &visitor) const;

	const DomainStats &stats() const;

private:
	struct State;
	std::unique_ptr<State> state_;
};

extern template class DomainSampler<float>;
extern template class DomainSampler<double>;

} // namespace thicket
