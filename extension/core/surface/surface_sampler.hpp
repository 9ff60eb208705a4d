#pragma once

#include "core/base/progress.hpp"
#include "core/base/status.hpp"
#include "core/sampling/point_set.hpp"
#include "core/surface/surface.hpp"

#include <glm/vec3.hpp>

#include <cstdint>
#include <memory>
#include <vector>

namespace thicket {

struct SurfacePoint {
	glm::dvec3 position; ///< World meters, on the surface but for rounding (radius / 1.8 million).
	glm::dvec3 normal;   ///< Unit length; the side from which the triangle's corners run counterclockwise.
	std::uint64_t id;    ///< surface_id.
	std::uint32_t rank;  ///< As SamplePoint::rank.
	std::uint32_t level; ///< As SamplePoint::level.
	std::uint32_t triangle;

	friend bool operator==(const SurfacePoint &, const SurfacePoint &) = default;
};

/// The layer and the cell of a point: 16 bits of layer, 16 of cell x, y and z each. Cells repeat after 65,536 (37.8 km for a radius of one
/// meter) on each axis.
std::uint64_t surface_id(std::uint16_t layer, const glm::ivec3 &cell);

/// Meters per lattice unit: radius / (sqrt(3) * 2^20).
double surface_unit(const PointSet &set);

struct SurfaceStats {
	std::uint64_t kept = 0;          ///< Points returned.
	std::uint64_t computed = 0;      ///< Points accepted anywhere, including margin and coarser levels.
	std::uint64_t lines = 0;         ///< Lines without a point.
	std::uint64_t darts = 0;         ///< Darts that were rejected.
	std::uint64_t cells = 0;         ///< Cells that threw a line.
	std::uint32_t retries = 0;       ///< Blocks that ran again with a wider margin.
	std::size_t workspace_bytes = 0; ///< Held by all levels.
};

/// A window onto the Poisson-disk set of a surface: dart throwing on surfaces (Cline, Jeschke, White, Razdan and Wonka, "Dart throwing on
/// surfaces", 2009) as a race of hashed exponential clocks, with distances in space. core/surface/README.md explains the method.
///
/// Promises, for one PointSet and one surface, over all calls, windows, orders, threads, compilers and instruction sets:
///  (1) every window that contains a point of the set returns that point, bit for bit the same, and no other window does;
///  (2) no two points are closer than the radius, exactly, on the lattice;
///  (3) nowhere on the surface is left where a further point would fit, exactly, on a grid of lines radius / 113,000 apart;
///  (4) with levels = 1 the set is distributed like naive dart throwing run to its end, uniform by area in every direction;
///  (5) the points depend on where the surface is, not on how it is divided into triangles, but for rounding: nearly all points of a
///      surface that is divided otherwise are the same. A change of the surface changes points within the reach of a chain of darts.
///
/// The object is a reusable workspace. Results do not depend on earlier calls. Not thread safe; use one per thread.
class SurfaceSampler {
public:
	explicit SurfaceSampler(const SampleMargins &margins = {});
	~SurfaceSampler();
	SurfaceSampler(SurfaceSampler &&) noexcept;
	SurfaceSampler &operator=(SurfaceSampler &&) noexcept;

	/// Replaces the contents of `r_points` with the points of `set` on `surface` in a half-open window in meters, in an order that depends
	/// only on the arguments. Refuses what PointSet excludes, a window that is inverted or not finite, a surface more than 2^30 cells from
	/// the origin, and one that would have more than max_points_per_call points; then `r_points` is unchanged. Fails with
	/// ErrorCode::margin_too_wide, cancelled or out_of_memory, with `r_points` empty. O(points + triangles) time in the window.
	Status sample(const PointSet &set, const Surface &surface, const Box3 &window, std::vector<SurfacePoint> &r_points,
			const Progress &progress = {});

	/// Replaces the contents of `r_points` with all points of `set` on `surface`. Otherwise behaves like `sample`.
	Status sample_all(const PointSet &set, const Surface &surface, std::vector<SurfacePoint> &r_points,
			const Progress &progress = {});

	const SurfaceStats &stats() const;

private:
	struct Workspace;
	Status sample_in(const PointSet &set, const Surface &surface, const Box3 *window,
			std::vector<SurfacePoint> &r_points, const Progress &progress);
	std::unique_ptr<Workspace> workspace_;
};

} // namespace thicket
