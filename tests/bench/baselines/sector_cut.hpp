#pragma once

#include "tests/bench/baselines/scalloped_sector.hpp"

#include <glm/vec2.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace thicket::bench {

/// Removes a disk from a scalloped sector. The remainder also consists of scalloped sectors:
/// before, below, above and after the disk.
///
/// The order of the sector's arcs and the disk's circle along a ray can change only at certain
/// rays. These are tangents to the disk, and rays through its intersections with an arc. They
/// divide the sector into slices. In each slice, the ray in the middle determines which parts
/// remain. Adjacent slices with the same part are joined, so that there are no unnecessary cuts.
class SectorCut {
public:
	/// Two tangents and two crossings with either arc make seven slices, each with at most two
	/// parts.
	static constexpr std::size_t max_parts = 14;

	/// The remaining sectors, possibly none, after a call that returned true.
	std::array<ScallopedSector, max_parts> parts;
	std::size_t count = 0;

	/// Removes the disk. Returns false if the disk does not intersect the sector. The origin must
	/// be outside the disk, or the disk must have radius 2.
	bool run(const ScallopedSector &sector, const Disk &disk) {
		count = 0;
		if (sector.within(disk)) {
			return true;
		}
		find_rays(sector, disk);
		std::array<std::size_t, kinds> open{none, none, none};
		bool touched = false;
		for (std::size_t slice = 0; slice + 1 < ray_count_; ++slice) {
			const std::array<bool, kinds> left_of_disk = left_of_slice(sector, disk, slice);
			touched |= !left_of_disk[whole];
			for (std::size_t kind = 0; kind < kinds; ++kind) {
				if (left_of_disk[kind] && open[kind] == none) {
					open[kind] = slice;
				} else if (!left_of_disk[kind] && open[kind] != none) {
					emit(sector, disk, kind, open[kind], slice);
					open[kind] = none;
				}
			}
		}
		if (!touched) {
			return false;
		}
		for (std::size_t kind = 0; kind < kinds; ++kind) {
			if (open[kind] != none) {
				emit(sector, disk, kind, open[kind], ray_count_ - 1);
			}
		}
		return true;
	}

private:
	enum Kind : std::size_t { whole, below, above, kinds };

	static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
	static constexpr std::size_t max_rays = 8;

	std::array<glm::dvec2, max_rays> rays_; ///< In order, from the sector's first ray to its last.
	std::size_t ray_count_ = 0;

	void find_rays(const ScallopedSector &sector, const Disk &disk) {
		rays_[0] = sector.from;
		ray_count_ = 1;
		const double squared = dot(disk.center, disk.center);
		const double tangent_squared = squared - disk.radius * disk.radius;
		if (tangent_squared > 0.0) {
			const glm::dvec2 tangent_foot = std::sqrt(tangent_squared) * disk.center;
			const glm::dvec2 normal_offset = disk.radius * glm::dvec2(-disk.center.y, disk.center.x);
			add_ray(sector, tangent_foot - normal_offset);
			add_ray(sector, tangent_foot + normal_offset);
		}
		add_crossings(sector, disk, sector.near.disk);
		add_crossings(sector, disk, sector.far.disk);
		rays_[ray_count_++] = sector.to;
	}

	/// Adds the rays through the intersections of two circles.
	void add_crossings(const ScallopedSector &sector, const Disk &disk, const Disk &other) {
		const glm::dvec2 difference = disk.center - other.center;
		const double squared = dot(difference, difference);
		const double other_squared = other.radius * other.radius;
		const double foot_fraction = 0.5 * (squared + other_squared - disk.radius * disk.radius) / squared;
		const double across_squared = other_squared / squared - foot_fraction * foot_fraction;
		if (across_squared > 0.0) { // The condition is also false for identical circles.
			const glm::dvec2 normal_offset = std::sqrt(across_squared) * glm::dvec2(-difference.y, difference.x);
			add_ray(sector, other.center + foot_fraction * difference - normal_offset);
			add_ray(sector, other.center + foot_fraction * difference + normal_offset);
		}
	}

	/// Adds a ray and keeps the rays sorted. A ray that is not inside the sector is ignored.
	void add_ray(const ScallopedSector &sector, glm::dvec2 ray) {
		if (!(cross(sector.from, ray) > 0.0 && cross(ray, sector.to) > 0.0)) {
			return;
		}
		std::size_t i = ray_count_++;
		for (; i > 1 && cross(rays_[i - 1], ray) < 0.0; --i) {
			rays_[i] = rays_[i - 1];
		}
		rays_[i] = normalized(ray);
	}

	/// Returns which parts of a slice remain. The slice begins at the ray with its index.
	std::array<bool, kinds> left_of_slice(const ScallopedSector &sector, const Disk &disk, std::size_t slice) const {
		const glm::dvec2 middle = normalized(rays_[slice] + rays_[slice + 1]);
		const double near_at = sector.near.at(middle);
		const double far_at = sector.far.at(middle);
		const double center_across = cross(disk.center, middle);
		const double half_squared = disk.radius * disk.radius - center_across * center_across;
		if (half_squared <= 0.0) {
			return {true, false, false};
		}
		const double half = std::sqrt(half_squared);
		const double center_along = dot(disk.center, middle);
		if (center_along - half >= far_at || center_along + half <= near_at) {
			return {true, false, false};
		}
		return {false, center_along - half > near_at, center_along + half < far_at};
	}

	/// Adds the part of this kind between two rays, unless it is so small that its area rounds to
	/// 0.
	void emit(const ScallopedSector &sector, const Disk &disk, std::size_t kind, std::size_t from, std::size_t to) {
		ScallopedSector &part = parts[count];
		part.from = rays_[from];
		part.to = rays_[to];
		part.near = kind == above ? Arc{disk, 1.0} : sector.near;
		part.far = kind == below ? Arc{disk, -1.0} : sector.far;
		part.measure();
		count += part.area > 0.0 ? 1 : 0;
	}
};

} // namespace thicket::bench
