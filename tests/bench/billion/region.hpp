#pragma once

#include "core/base/rect.hpp"
#include "core/base/split_mix.hpp"
#include "core/sampling/level_grid.hpp"
#include "core/sampling/point_set.hpp"

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

namespace thicket::bench::billion {

/// The fraction of the plane that disks of diameter r cover after naive dart throwing until no dart
/// fits. Zhang and Torquato measured it without extrapolation in "Precise algorithm to generate
/// random sequential addition of hard hyperspheres at saturation" (Phys. Rev. E 88, 053312, 2013):
/// 0.5470735 +- 0.0000028. Thicket's other programs also use 0.547070.
inline constexpr double jammed_coverage = 0.547070;

/// Sets on a lattice cover less than those in the plane, because no dart can hit a gap between
/// lattice points. The difference is proportional to the lattice unit. This program measured it on
/// coarser lattices with eight million points each: 0.156 +- 0.006 over 2^7 with lattice_bits 7,
/// 0.154 +- 0.012 over 2^8 with 8. At a billion points, it is two standard errors.
inline constexpr double coverage_lattice_loss = 0.155 / (1 << lattice_bits);

/// The expected number of points in a cell, whose area is r^2 / 2.
inline constexpr double points_per_cell = jammed_coverage * 4.0 / std::numbers::pi / 2.0;

/// With this radius, a cell is 1 m wide and the lattice unit is 2^-lattice_bits m, so world
/// coordinates are exact. The set is the same for any radius, except for its scale.
inline constexpr double cell_meter_radius = std::numbers::sqrt2;

/// A square of whole cells around the origin, divided into square tiles (narrower in the last row
/// and column). For the statistics, it is also divided into blocks of equal area.
struct Region {
	static constexpr std::int32_t blocks_per_side = 16;
	/// Lattice coordinates of larger regions would exceed 32 bits.
	static constexpr double max_points = 5e9;

	std::int32_t side = 0; ///< Number of cells, a multiple of blocks_per_side.
	std::int32_t tile = 0; ///< Width of a tile in cells.

	/// Returns the smallest region that has at least `points` points with near certainty. Counts
	/// have a standard deviation of sqrt(points) / 4, so eight times this value is added.
	static Region holding(double points, std::int32_t tile) {
		const double cells = (points + 2.0 * std::sqrt(points)) / points_per_cell;
		const auto blocks = static_cast<std::int32_t>(std::ceil(std::sqrt(cells) / blocks_per_side));
		return {blocks * blocks_per_side, tile};
	}

	glm::ivec2 corner() const { return glm::ivec2(-side / 2); }
	std::int32_t tiles_per_side() const { return (side + tile - 1) / tile; }
	std::uint64_t tiles() const {
		return static_cast<std::uint64_t>(tiles_per_side()) * static_cast<std::uint64_t>(tiles_per_side());
	}
	std::uint64_t index_of(glm::ivec2 tile_position) const {
		return static_cast<std::uint64_t>(tile_position.y) * static_cast<std::uint64_t>(tiles_per_side()) +
				static_cast<std::uint64_t>(tile_position.x);
	}
	bool has_tile(glm::ivec2 tile_position) const {
		return tile_position.x >= 0 && tile_position.y >= 0 && tile_position.x < tiles_per_side() &&
				tile_position.y < tiles_per_side();
	}
	CellRect tile_cells(glm::ivec2 tile_position) const {
		return {corner() + tile_position * tile, corner() + glm::min((tile_position + 1) * tile, glm::ivec2(side))};
	}

	std::int32_t block_side() const { return side / blocks_per_side; }
	std::uint32_t block_of(glm::ivec2 cell) const {
		const glm::ivec2 block = (cell - corner()) / block_side();
		return static_cast<std::uint32_t>(block.y * blocks_per_side + block.x);
	}

	/// Returns the fraction of an area of `cells` cells that `points` disks of diameter r cover.
	static double coverage(double points, double cells) { return points / cells * (std::numbers::pi / 2.0); }
};

/// Converts cells to meters, for a set with cell_meter_radius.
inline Rect world_rect(const CellRect &cells) { return {glm::dvec2(cells.min), glm::dvec2(cells.max)}; }

/// The order in which a region's tiles are generated.
enum class TileOrder {
	rows, ///< Row by row.
	/// Bands of four rows, each with a keyed permutation. Neighbors are generated at unrelated
	/// times.
	shuffled,
	hilbert, ///< Along a Hilbert curve.
};

/// Determines the order of the tiles in O(1) memory. Consecutive slots are mapped to tiles; some
/// slots are empty.
class TileSequence {
public:
	TileSequence(const Region &region, TileOrder order, std::uint64_t key) :
			per_side_(static_cast<std::uint32_t>(region.tiles_per_side())), order_(order), key_(key) {
		const std::uint64_t square = order == TileOrder::shuffled ? std::uint64_t{band_rows} * per_side_
																  : std::uint64_t{per_side_} * per_side_;
		while ((std::uint64_t{1} << (2 * half_bits_)) < square ||
				(order == TileOrder::hilbert && (1u << half_bits_) < per_side_)) {
			++half_bits_;
		}
	}

	std::uint64_t slots() const {
		switch (order_) {
			case TileOrder::rows: return std::uint64_t{per_side_} * per_side_;
			case TileOrder::shuffled: return std::uint64_t{(per_side_ + band_rows - 1) / band_rows} << (2 * half_bits_);
			case TileOrder::hilbert: return std::uint64_t{1} << (2 * half_bits_);
		}
		return 0;
	}

	/// Returns the tile of a slot, if it has one. `slot` must be below slots(). Every tile has
	/// exactly one slot.
	std::optional<glm::ivec2> at(std::uint64_t slot) const {
		glm::uvec2 tile_position(slot % per_side_, slot / per_side_);
		if (order_ == TileOrder::shuffled) {
			const std::uint64_t band = slot >> (2 * half_bits_);
			const std::uint32_t slot_in_square = permuted(slot & ((std::uint64_t{1} << (2 * half_bits_)) - 1), band);
			if (slot_in_square >= band_rows * per_side_) {
				return std::nullopt;
			}
			tile_position = {slot_in_square % per_side_, band * band_rows + slot_in_square / per_side_};
		} else if (order_ == TileOrder::hilbert) {
			tile_position = on_curve(slot);
		}
		if (tile_position.x >= per_side_ || tile_position.y >= per_side_) {
			return std::nullopt;
		}
		return glm::ivec2(tile_position);
	}

private:
	/// With more rows, the points at more borders must be kept at once.
	static constexpr std::uint32_t band_rows = 4;

	std::uint32_t per_side_;
	TileOrder order_;
	std::uint64_t key_;
	std::uint32_t half_bits_ = 0;

	/// Applies a Feistel network of four rounds, which is a bijection of numbers of 2 * half_bits_
	/// bits.
	std::uint32_t permuted(std::uint64_t index, std::uint64_t band) const {
		const std::uint64_t mask = (std::uint64_t{1} << half_bits_) - 1;
		std::uint64_t left = index >> half_bits_;
		std::uint64_t right = index & mask;
		for (std::uint64_t round = 0; round < 4; ++round) {
			const std::uint64_t bits = split_mix(key_ + split_mix(4 * band + round) + right * split_mix_gamma);
			left ^= bits >> 32 & mask;
			std::swap(left, right);
		}
		return static_cast<std::uint32_t>(left << half_bits_ | right);
	}

	glm::uvec2 on_curve(std::uint64_t distance) const {
		glm::uvec2 tile_position(0);
		for (std::uint32_t width = 1; width < 1u << half_bits_; width *= 2) {
			const std::uint32_t right = distance >> 1 & 1;
			const std::uint32_t up = (distance ^ right) & 1;
			if (up == 0) {
				if (right == 1) {
					tile_position = width - 1 - tile_position;
				}
				std::swap(tile_position.x, tile_position.y);
			}
			tile_position += width * glm::uvec2(right, up);
			distance >>= 2;
		}
		return tile_position;
	}
};

} // namespace thicket::bench::billion
