#pragma once

#include "tests/bench/baselines/scalloped_sector.hpp"
#include "tests/bench/baselines/sector_cut.hpp"
#include "tests/bench/baselines/sum_tree.hpp"
#include "tests/bench/baselines/torus_grid.hpp"
#include "tests/bench/common/random.hpp"

#include <glm/vec2.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

namespace thicket::bench {

/// Dunbar and Humphreys, "A spatial data structure for fast Poisson-disk sample generation" (2006).
/// The method throws darts uniformly at all positions that are closer than 2 to some point and at
/// least 1 from every point, until there are none left.
///
/// Each point owns the part of that region that is closer than 2 to it but not to an earlier point,
/// as a list of scalloped sectors. For each dart, a tree chooses a point in proportion to its area,
/// then one of its sectors is chosen, then a position in the sector. Every dart is therefore
/// accepted. Its disk is then removed from the sectors of the points around it. The method takes
/// O(N log N) time.
///
/// The minimum distance is exact. A dart that rounding brings closer than 1 to a point is thrown
/// again at the same sector, and a sector in which too many darts fail is removed. An object of
/// this class keeps its memory between calls.
class ScallopedSectors {
public:
	/// The measured fraction of the torus that disks of half the radius cover. It is 0.0017 less than
	/// with darts at the whole domain, because the set grows from one point. Positions near its
	/// edge are filled before other positions are open.
	static constexpr double coverage = 0.5454;

	/// Replaces `r_points` with a maximal set on the torus [0, side)^2, in which no two points are
	/// closer than 1. `side` is 11 to 5e4.
	void sample(double side, std::uint64_t seed, std::vector<glm::dvec2> &r_points) {
		grid_.reset(side);
		areas_.reset(static_cast<std::size_t>(densest * side * side) + 1);
		first_.clear();
		pool_.clear();
		free_ = none;
		neighbor_count_ = 0;
		r_points.clear();

		Xoroshiro random(seed);
		const double x = unit(random) * side;
		insert(grid_.wrap({x, unit(random) * side}), r_points);
		for (double total = areas_.total(); total > 0.0; total = areas_.total()) {
			throw_dart(areas_.find(unit(random) * total), random, r_points);
		}
	}

private:
	/// The maximum number of points per unit of area, reached by a hexagonal lattice.
	static constexpr double densest = 2.0 / std::numbers::sqrt3;
	/// Number of cells in each direction that are searched. Disks of radius 2 that intersect have
	/// centers at most 4 apart.
	static constexpr int reach = 2;
	/// With six parts, no arc is half of its circle.
	static constexpr std::size_t annulus_parts = 6;
	static constexpr int max_throws = 16;
	static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
	/// Oler's bound for a disk of radius 4 is 71.
	static constexpr std::size_t max_neighbors = 128;

	struct Neighbor {
		std::uint32_t index;
		glm::dvec2 offset;
		double squared;
	};

	/// A sector in its point's list, or in the list of unused sectors.
	struct Node {
		ScallopedSector sector;
		std::uint32_t next;
	};

	std::array<ScallopedSector, annulus_parts> annulus_ = make_annulus();
	TorusGrid grid_;
	SumTree areas_;
	std::vector<std::uint32_t> first_; ///< The first sector of each point's list.
	std::vector<Node> pool_;
	std::uint32_t free_ = none;
	SectorCut cut_;
	/// The neighbors of the last dart that are closer than 4.
	std::array<Neighbor, max_neighbors> neighbors_;
	std::size_t neighbor_count_ = 0;

	static double unit(Xoroshiro &random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

	/// Throws darts at one sector of a point until one is accepted. If too many fail, removes the
	/// sector.
	void throw_dart(std::size_t owner, Xoroshiro &random, std::vector<glm::dvec2> &r_points) {
		const std::uint32_t chosen = choose_sector(owner, random);
		for (int i = 0; i < max_throws; ++i) {
			const double turned = unit(random);
			const glm::dvec2 dart = grid_.wrap(r_points[owner] + pool_[chosen].sector.point_at(turned, unit(random)));
			if (find_neighbors(dart)) {
				insert(dart, r_points);
				return;
			}
		}
		drop(owner, chosen);
	}

	/// Chooses a sector of a point in proportion to its area. The point must have at least one.
	std::uint32_t choose_sector(std::size_t owner, Xoroshiro &random) const {
		double target = unit(random) * area_of(owner);
		std::uint32_t i = first_[owner];
		while (target >= pool_[i].sector.area && pool_[i].next != none) {
			target -= pool_[i].sector.area;
			i = pool_[i].next;
		}
		return i;
	}

	/// Finds the neighbors of a dart. Returns false if one is closer than 1.
	bool find_neighbors(glm::dvec2 dart) {
		neighbor_count_ = 0;
		bool free = true;
		grid_.visit(dart, reach, [&](std::uint32_t index, glm::dvec2 offset) {
			const double squared = dot(offset, offset);
			free &= squared >= 1.0;
			if (squared < 16.0) {
				neighbors_[neighbor_count_++] = {index, offset, squared};
			}
		});
		return free;
	}

	/// Adds a point. Its neighbors must be in `neighbors_`.
	void insert(glm::dvec2 point, std::vector<glm::dvec2> &r_points) {
		const std::size_t index = r_points.size();
		grid_.insert(static_cast<std::uint32_t>(index), point);
		r_points.push_back(point);
		first_.push_back(none);
		for (std::size_t i = 0; i < neighbor_count_; ++i) {
			const Neighbor &neighbor = neighbors_[i];
			if (neighbor.squared < 9.0 && first_[neighbor.index] != none) {
				cut(neighbor.index, {-neighbor.offset, 1.0});
				weigh(neighbor.index);
			}
		}
		for (const ScallopedSector &piece : annulus_) {
			add_sector(index, piece);
		}
		// Near neighbors are cut first. They cover most of the annulus, so the remaining neighbors
		// find few sectors or none.
		cut_neighbors(index, 0.0, 4.0);
		cut_neighbors(index, 4.0, 16.0);
		weigh(index);
	}

	/// Removes the positions that are closer than 2 to earlier points from the sectors of `owner`.
	/// Only neighbors whose squared distances are from `least` to `limit` are used.
	void cut_neighbors(std::size_t owner, double min_distance, double limit) {
		for (std::size_t i = 0; i < neighbor_count_ && first_[owner] != none; ++i) {
			const Neighbor &neighbor = neighbors_[i];
			if (neighbor.squared >= min_distance && neighbor.squared < limit) {
				cut(owner, {neighbor.offset, 2.0});
			}
		}
	}

	/// Returns the sectors that cover all positions closer than 2 and at least 1 from a point.
	static std::array<ScallopedSector, annulus_parts> make_annulus() {
		std::array<ScallopedSector, annulus_parts> annulus;
		for (std::size_t i = 0; i < annulus_parts; ++i) {
			const double angle = 2.0 * std::numbers::pi / annulus_parts * static_cast<double>(i);
			annulus[i].from = {std::cos(angle), std::sin(angle)};
			annulus[(i + annulus_parts - 1) % annulus_parts].to = annulus[i].from;
			annulus[i].far.disk.radius = 2.0;
		}
		for (ScallopedSector &piece : annulus) {
			piece.measure();
		}
		return annulus;
	}

	void add_sector(std::size_t owner, const ScallopedSector &sector) {
		std::uint32_t slot = free_;
		if (slot == none) {
			slot = static_cast<std::uint32_t>(pool_.size());
			pool_.emplace_back();
		} else {
			free_ = pool_[slot].next;
		}
		pool_[slot] = {sector, first_[owner]};
		first_[owner] = slot;
	}

	/// Removes a disk from all sectors of a point.
	void cut(std::size_t owner, const Disk &disk) {
		std::uint32_t slot = first_[owner];
		first_[owner] = none;
		while (slot != none) {
			Node &node = pool_[slot];
			const std::uint32_t next = node.next;
			if (node.sector.misses(disk) || !cut_.run(node.sector, disk)) {
				node.next = first_[owner];
				first_[owner] = slot;
			} else {
				release(slot);
				for (std::size_t i = 0; i < cut_.count; ++i) {
					add_sector(owner, cut_.parts[i]);
				}
			}
			slot = next;
		}
	}

	/// Removes a sector from its point's list.
	void drop(std::size_t owner, std::uint32_t slot) {
		std::uint32_t *link = &first_[owner];
		while (*link != slot) {
			link = &pool_[*link].next;
		}
		*link = pool_[slot].next;
		release(slot);
		weigh(owner);
	}

	void release(std::uint32_t slot) {
		pool_[slot].next = free_;
		free_ = slot;
	}

	/// Stores a point's area in the tree.
	void weigh(std::size_t owner) { areas_.set(owner, area_of(owner)); }

	double area_of(std::size_t owner) const {
		double total = 0.0;
		for (std::uint32_t i = first_[owner]; i != none; i = pool_[i].next) {
			total += pool_[i].sector.area;
		}
		return total;
	}
};

} // namespace thicket::bench
