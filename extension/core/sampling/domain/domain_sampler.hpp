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

/// Statistics of the last call.
struct DomainStats {
	std::uint64_t points = 0;
	std::uint64_t darts = 0;       ///< Darts thrown, including accepted ones.
	std::uint64_t squares = 0;     ///< Active squares created, including base squares (figure 6 of the paper).
	std::uint64_t selections = 0;  ///< Choices of an active square.
	std::uint64_t list_checks = 0; ///< Lists checked in all choices together (figure 6 of the paper).
	std::uint64_t discarded = 0;   ///< Squares discarded because the precision ends there.
	std::uint32_t levels = 0;      ///< Levels of squares that were in use.
	double cell_size = 0.0;        ///< Width of an accelerator cell in radii; 0 where there are none.
	std::size_t grid_bytes = 0;    ///< Accelerator cells, including overflow: the copy of the points (section 4.2).
	std::size_t square_bytes = 0;  ///< Active squares and the map of groups, at their peak (section 4.2).

	std::size_t workspace_bytes() const { return grid_bytes + square_bytes; }
};

/// Fills a whole domain with one maximal Poisson-disk point set; see DomainMethod. `Real` is float or double: the type of the coordinates
/// and of all distances.
///
/// Promises, for each method:
///  (1) no two points are closer than the radius, exactly, in the returned coordinates;
///  (2) no room is left for a further point, down to the precision of `Real` (not for `naive`);
///  (3) every point lies in the half-open domain;
///  (4) equal requests return equal points, bit for bit, on every machine, whatever the `cell_size`;
///  (5) all but `wavefront` are distributed like naive dart throwing, `wavefront` nearly so (section 4.4).
///
/// The object keeps its memory only as long as the points can be visited. Not thread safe; use one per thread.
template <typename Real>
class DomainSampler {
public:
	DomainSampler();
	~DomainSampler();
	DomainSampler(DomainSampler &&) noexcept;
	DomainSampler &operator=(DomainSampler &&) noexcept;

	/// Replaces the contents of `r_points` with the points, in the order of their acceptance. `r_points` is unchanged if the request is
	/// refused or cancelled, or if memory does not suffice (ErrorCode::out_of_memory). Expected O(points).
	Status sample(
			const DomainRequest &request, std::vector<glm::vec<2, Real>> &r_points, const Progress &progress = {});

	/// Like `sample`, but does not return the points: they stay in the accelerator cells, for `visit`. The call uses no memory beyond the
	/// workspace.
	Status fill(const DomainRequest &request, const Progress &progress = {});

	/// Passes the points of the last call to `visitor`, cell by cell, with equal numbers of x and y, if that call was a successful
	/// `fill`. Refused calls do not count.
	void visit(const std::function<void(std::span<const Real> x, std::span<const Real> y)> &visitor) const;

	const DomainStats &stats() const;

private:
	struct State;
	std::unique_ptr<State> state_;
};

extern template class DomainSampler<float>;
extern template class DomainSampler<double>;

} // namespace thicket
