#pragma once

#include "core/sampling/tile_sampler.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <thread>
#include <vector>

namespace thicket::tilings {

/// A way to cut the plane into rectangles, and to walk over them.
struct Tiling {
	const char *name;
	glm::dvec2 size;           ///< Meters.
	glm::dvec2 offset{0.0};    ///< A corner of some tile, meters.
	unsigned threads = 1;      ///< Each with a sampler of its own, taking tiles as they come.
	std::uint64_t shuffle = 0; ///< Seed of the order of the tiles; 0 goes row by row.
};

/// All tiles of the tiling that meet `region`, whole.
inline std::vector<Rect> tiles_of(const Tiling &tiling, const Rect &region) {
	// One expression for every edge, so that neighbors share it to the bit.
	const auto edge_x = [&](std::int64_t i) {
		return tiling.offset.x + static_cast<double>(i) * tiling.size.x;
	};
	const auto edge_y = [&](std::int64_t i) {
		return tiling.offset.y + static_cast<double>(i) * tiling.size.y;
	};
	const auto place = [](double from, double size) {
		return static_cast<std::int64_t>(std::floor(from / size));
	};
	const std::int64_t first_x = place(region.min.x - tiling.offset.x, tiling.size.x) - 1;
	const std::int64_t first_y = place(region.min.y - tiling.offset.y, tiling.size.y) - 1;
	std::vector<Rect> tiles;
	for (std::int64_t y = first_y; edge_y(y) < region.max.y; ++y) {
		for (std::int64_t x = first_x; edge_x(x) < region.max.x; ++x) {
			const Rect tile{{edge_x(x), edge_y(y)}, {edge_x(x + 1), edge_y(y + 1)}};
			if (tile.max.x > region.min.x && tile.max.y > region.min.y) {
				tiles.push_back(tile);
			}
		}
	}
	if (tiling.shuffle != 0) {
		std::mt19937_64 random(tiling.shuffle);
		std::shuffle(tiles.begin(), tiles.end(), random);
	}
	return tiles;
}

/// The points that one worker found in `region`, and whether all went as promised.
struct Harvest {
	std::vector<SamplePoint> points;
	std::string failure;
};

inline void harvest(const PointSet &set, const Rect &region, const std::vector<Rect> &tiles,
		std::atomic<std::size_t> &next, Harvest &r_harvest) {
	TileSampler sampler;
	std::vector<SamplePoint> points;
	for (std::size_t i = next++; i < tiles.size(); i = next++) {
		const Status status = sampler.sample(set, tiles[i], points);
		if (!status.ok()) {
			r_harvest.failure = describe(status);
			return;
		}
		for (const SamplePoint &point : points) {
			if (!tiles[i].contains(point.position)) {
				r_harvest.failure = "a point outside of its tile";
				return;
			}
			if (region.contains(point.position)) {
				r_harvest.points.push_back(point);
			}
		}
	}
}

/// The points of `region`, put together from the tiles of a tiling and sorted by id. A point that two tiles hand out
/// stands there twice.
inline std::vector<SamplePoint> points_through(const PointSet &set, const Rect &region, const Tiling &tiling) {
	const std::vector<Rect> tiles = tiles_of(tiling, region);
	std::atomic<std::size_t> next{0};
	std::vector<Harvest> harvests(tiling.threads);
	std::vector<std::thread> workers;
	for (Harvest &own : harvests) {
		workers.emplace_back([&] { harvest(set, region, tiles, next, own); });
	}
	for (std::thread &worker : workers) {
		worker.join();
	}
	std::vector<SamplePoint> points;
	for (const Harvest &own : harvests) {
		REQUIRE_MESSAGE(own.failure.empty(), own.failure);
		points.insert(points.end(), own.points.begin(), own.points.end());
	}
	std::sort(points.begin(), points.end(), [](const SamplePoint &a, const SamplePoint &b) { return a.id < b.id; });
	return points;
}

/// The points of `region` by one call, sorted by id.
inline std::vector<SamplePoint> points_at_once(const PointSet &set, const Rect &region) {
	TileSampler sampler;
	std::vector<SamplePoint> points;
	const Status status = sampler.sample(set, region, points);
	REQUIRE_MESSAGE(status.ok(), describe(status));
	std::sort(points.begin(), points.end(), [](const SamplePoint &a, const SamplePoint &b) { return a.id < b.id; });
	return points;
}

} // namespace thicket::tilings
