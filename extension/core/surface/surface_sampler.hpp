#pragma once

#include "core/base/progress.hpp"
#include "core/base/status.hpp"
#include "core/sampling/point_set.hpp"
#include "core/terrain/surface.hpp"

#include <glm/vec3.hpp>

#include <cstdint>
#include <memory>
#include <vector>

namespace thicket {

struct SurfacePoint {
	glm::dvec3 position; ///< World meters. Less than radius / 500,000 from the surface, by rounding.
	glm::dvec3 normal;   ///< Unit normal on the side from which the triangle's corners are counterclockwise.
	std::uint64_t id;    ///< Id of the point; see surface_id().
	std::uint32_t rank;  ///< Rank of the point; see SamplePoint::rank.
	std::uint32_t level; ///< Level of the point; see SamplePoint::level.
	std::uint32_t triangle;

	friend bool operator==(const SurfacePoint &, const SurfacePoint &) = default;
};

/// Packs a layer and a cube with a side of radius / sqrt(3) into an InstanceId: 16 bits for the
/// layer, 17 each for the cube's x and z, and 14 for its y. Such ids sort and compress like those of
/// the plane. They repeat every 131,072 cubes on x and z, and every 16,384 cubes on y (75.7 km and
/// 9.5 km for a radius of one meter).
std::uint64_t surface_id(std::uint16_t layer, const glm::ivec3 &cell);

/// Returns the length of a lattice unit in meters: radius / 2^20.
double surface_unit(const PointSet &set);

/// Returns how far around a window, in meters, a SurfaceSampler reads the surface if
/// SampleMargins::widest is `widest_margin`.
double sampling_margin(const PointSet &set, std::int32_t widest_margin);

struct SurfaceStats {
	std::uint64_t kept = 0;          ///< Number of points returned.
	std::uint64_t computed = 0;      ///< Number of points accepted, including those in margins and on coarser levels.
	std::uint64_t lines = 0;         ///< Number of lines that produced no point.
	std::uint64_t darts = 0;         ///< Number of rejected darts.
	std::uint64_t cells = 0;         ///< Number of cells with at least one line.
	std::uint32_t retries = 0;       ///< Number of blocks that were decided again with a wider margin.
	std::size_t workspace_bytes = 0; ///< Memory of the workspace in bytes, all levels.
};

/// Computes windows onto the Poisson-disk set of a surface. The sampler implements dart throwing
/// (Cline, Jeschke, White, Razdan and Wonka, "Dart throwing on surfaces", 2009) as a race of hashed
/// exponential clocks, with straight-line distances. core/surface/README.md explains the method.
///
/// Guarantees for one PointSet and one surface, for all calls, windows, orders, threads, compilers
/// and instruction sets:
///  (1) Every window that contains a point of the set returns that point, bit-identical; no other
///      window does.
///  (2) No two points are closer than the radius, exactly, on the lattice.
///  (3) The set is maximal: no further point would fit anywhere on the surface. This is exact on a
///      grid of lines radius / 65,536 apart.
///  (4) With levels = 1, the set is distributed like naive dart throwing run to its end, uniform by
///      area in every direction.
///  (5) Points depend on the shape of the surface, not on its division into triangles, up to
///      rounding: a different division changes very few points. A change of the surface affects
///      only points within the reach of a chain of darts.
///
/// A sampler reuses its memory. Results do not depend on earlier calls. Each thread needs its own
/// sampler.
class SurfaceSampler {
public:
	explicit SurfaceSampler(const SampleMargins &margins = {});
	~SurfaceSampler();
	SurfaceSampler(SurfaceSampler &&) noexcept;
	SurfaceSampler &operator=(SurfaceSampler &&) noexcept;

	/// Replaces `r_points` with the points of `set` on `surface` in a half-open window (world
	/// meters), in an order that depends only on the arguments. An invalid set is an error, and so
	/// is a surface that extends more than 2^30 cells from the origin. A window is an error if it
	/// is inverted, not finite, or may contain more than max_points_per_call points. `r_points` is
	/// then unchanged. After ErrorCode::margin_too_wide, cancelled or out_of_memory, `r_points` is
	/// empty. The time is O(points + triangles) for those in the window.
	Status sample(const PointSet &set, const Surface &surface, const Box3 &window, std::vector<SurfacePoint> &r_points,
			const Progress &progress = {});

	/// Replaces `r_points` with all points of `set` on `surface`. Otherwise behaves like `sample`.
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
