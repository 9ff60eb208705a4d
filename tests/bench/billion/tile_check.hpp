#pragma once

#include "region.hpp"

#include "core/base/instance_id.hpp"
#include "core/base/split_mix.hpp"
#include "core/sampling/dart.hpp"
#include "core/sampling/level_grid.hpp"
#include "core/sampling/point_set.hpp"

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace thicket::bench::billion {

/// Identifies a set of points regardless of their order. A digest consists of two sums, modulo
/// 2^64, of differently keyed hashes of each point's ID, lattice position and rank.
struct Digest {
	std::uint64_t high = 0;
	std::uint64_t low = 0;

	void add(const SamplePoint &point, glm::ivec2 lattice) {
		const std::uint64_t position =
				std::uint64_t{static_cast<std::uint32_t>(lattice.x)} << 32 | static_cast<std::uint32_t>(lattice.y);
		const std::uint64_t name = point.id + point.rank * split_mix_gamma;
		// The keys are digits of sqrt(2) and sqrt(3).
		high += split_mix(split_mix(position + 0x6a09e667f3bcc908) ^ name);
		low += split_mix(split_mix(position + 0xbb67ae8584caa73b) ^ name);
	}
	Digest &operator+=(const Digest &other) {
		high += other.high;
		low += other.low;
		return *this;
	}
	friend bool operator==(const Digest &, const Digest &) = default;
};

/// The findings in all tiles so far. The findings of several threads can be added.
struct Findings {
	std::uint64_t points = 0;
	/// Number of pairs of points whose distance was computed, each counted once.
	std::uint64_t pairs = 0;
	std::uint64_t too_close = 0; ///< Number of pairs of points that are closer than the radius.
	/// Number of points that are outside their tile or off the lattice, or have the ID of a
	/// different cell.
	std::uint64_t misplaced = 0;
	std::uint64_t doubled = 0; ///< Number of points in a cell that already has one.
	/// The smallest squared distance of all pairs, in squared lattice units.
	std::int64_t min_squared_distance = std::numeric_limits<std::int64_t>::max();
	Digest digest;

	Findings &operator+=(const Findings &other) {
		points += other.points;
		pairs += other.pairs;
		too_close += other.too_close;
		misplaced += other.misplaced;
		doubled += other.doubled;
		min_squared_distance = std::min(min_squared_distance, other.min_squared_distance);
		digest += other.digest;
		return *this;
	}
};

/// Finds the lattice position of a point of a set with cell_meter_radius. Returns false if the
/// point is not on the lattice, or farther than 2^30 units.
inline bool lattice_of(const SamplePoint &point, glm::ivec2 &r_lattice) {
	const glm::dvec2 lattice = point.position * static_cast<double>(cell_size);
	if (!(std::abs(lattice.x) <= 0x1p30 && std::abs(lattice.y) <= 0x1p30)) {
		return false;
	}
	r_lattice = glm::ivec2(lattice);
	return glm::dvec2(r_lattice) == lattice;
}

/// Checks a tile's points with integers. Each point must be in its own cell of the tile, and no two
/// points may be closer than the radius. Only cells at most two apart can contain points that are
/// too close, so all pairs from such cells are compared: at most 12 per point. The object keeps its
/// memory between tiles. Each thread needs its own.
class TileCheck {
public:
	/// The width in cells of the border in which a point can be too close to points of a
	/// neighboring tile.
	static constexpr std::int32_t reach = 2;

	/// Stores the points of a tile, and compares them with each other.
	Findings take(const CellRect &tile, std::uint16_t layer, std::span<const SamplePoint> points) {
		tile_ = tile;
		origin_ = tile.min * static_cast<std::int32_t>(cell_size);
		columns_ = tile.size().x + 2 * border;
		const std::int32_t rows = tile.size().y + 2 * border;
		grid_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows), nowhere);
		entered_.clear();
		Findings found;
		found.points = points.size();
		for (const SamplePoint &point : points) {
			enter(point, layer, found);
		}
		for (const glm::ivec2 local : entered_) {
			compare_forward(local, found);
		}
		return found;
	}

	/// Returns the points of the tile that can be too close to points of another tile, in lattice
	/// units of the whole set.
	std::vector<glm::ivec2> rim() const {
		const std::int32_t width = reach * static_cast<std::int32_t>(cell_size);
		const glm::ivec2 end = tile_.size() * static_cast<std::int32_t>(cell_size) - width;
		std::vector<glm::ivec2> rim;
		rim.reserve(static_cast<std::size_t>(tile_.size().x + tile_.size().y) * 3 / 2);
		for (const glm::ivec2 local : entered_) {
			if (local.x < width || local.y < width || local.x >= end.x || local.y >= end.y) {
				rim.push_back(local + origin_);
			}
		}
		return rim;
	}

	/// Compares another tile's rim with the points of this tile.
	void compare_with(std::span<const glm::ivec2> rim, Findings &r_found) const {
		const glm::ivec2 least(-reach * static_cast<std::int32_t>(cell_size));
		const glm::ivec2 end = (tile_.size() + reach) * static_cast<std::int32_t>(cell_size);
		for (const glm::ivec2 point : rim) {
			const glm::ivec2 local = point - origin_;
			if (local.x >= least.x && local.y >= least.y && local.x < end.x && local.y < end.y) {
				compare_around(local, r_found);
			}
		}
	}

	const CellRect &tile() const { return tile_; }
	/// Returns the lattice positions of the tile's points, relative to the tile's corner.
	std::span<const glm::ivec2> entered() const { return entered_; }
	glm::ivec2 origin() const { return origin_; }

private:
	/// The points of another tile's rim are up to `reach` cells outside this tile, and are compared
	/// with cells `reach` farther away.
	static constexpr std::int32_t border = 2 * reach;
	/// Marks empty cells. The position is too far away to count as part of a pair, but near enough
	/// for its distance to be squared without overflow.
	static constexpr glm::ivec2 nowhere{-(1 << 29)};
	static constexpr std::int64_t far_squared = std::int64_t{1} << 40;

	CellRect tile_;
	glm::ivec2 origin_{0};
	std::int32_t columns_ = 0;
	/// The point of each cell, relative to the tile's corner, or `nowhere`.
	std::vector<glm::ivec2> grid_;
	std::vector<glm::ivec2> entered_;

	std::size_t index_of(glm::ivec2 local) const {
		return static_cast<std::size_t>(
				((local.y >> lattice_bits) + border) * columns_ + (local.x >> lattice_bits) + border);
	}

	void enter(const SamplePoint &point, std::uint16_t layer, Findings &r_found) {
		glm::ivec2 lattice;
		if (!lattice_of(point, lattice)) {
			++r_found.misplaced;
			return;
		}
		r_found.digest.add(point, lattice);
		const glm::ivec2 cell(lattice.x >> lattice_bits, lattice.y >> lattice_bits);
		if (!tile_.contains(cell) || point.id != pack({layer, cell})) {
			++r_found.misplaced;
			return;
		}
		const glm::ivec2 local = lattice - origin_;
		glm::ivec2 &position = grid_[index_of(local)];
		if (position != nowhere) {
			++r_found.doubled;
			return;
		}
		position = local;
		entered_.push_back(local);
	}

	static void compare(glm::ivec2 a, glm::ivec2 b, Findings &r_found) {
		const std::int64_t x = std::int64_t{a.x} - b.x;
		const std::int64_t y = std::int64_t{a.y} - b.y;
		const std::int64_t squared = x * x + y * y;
		r_found.pairs += squared < far_squared ? 1 : 0;
		r_found.too_close += squared < std::int64_t{radius_squared} ? 1 : 0;
		r_found.min_squared_distance =
				std::min(r_found.min_squared_distance, squared < far_squared ? squared : r_found.min_squared_distance);
	}

	/// Compares a point only with cells that are later in row order, so that each pair is compared
	/// once.
	void compare_forward(glm::ivec2 local, Findings &r_found) const {
		const glm::ivec2 *position = grid_.data() + index_of(local);
		compare(position[1], local, r_found);
		compare(position[2], local, r_found);
		for (std::int32_t row = 1; row <= reach; ++row) {
			position += columns_;
			for (std::int32_t column = -reach; column <= reach; ++column) {
				compare(position[column], local, r_found);
			}
		}
	}

	void compare_around(glm::ivec2 local, Findings &r_found) const {
		const glm::ivec2 *position = grid_.data() + index_of(local) - reach * columns_;
		for (std::int32_t row = -reach; row <= reach; ++row, position += columns_) {
			for (std::int32_t column = -reach; column <= reach; ++column) {
				compare(position[column], local, r_found);
			}
		}
	}
};

} // namespace thicket::bench::billion
