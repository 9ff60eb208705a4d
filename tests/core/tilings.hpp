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

/// A division of the plane into rectangular tiles, and the order in which they are sampled.
struct Tiling {
	const char *name;
	glm::dvec2 size;           ///< Size of a tile in meters.
	glm::dvec2 offset{0.0};    ///< The position of any tile corner, meters.
	unsigned threads = 1;      ///< Each thread has its own sampler and takes the next free tile.
	std::uint64_t shuffle = 0; ///< Seed of a random order; 0 means row by row.
};

/// Returns all tiles that overlap `region`. They are not clipped to it.
inline std::vector<Rect> tiles_of(const Tiling &tiling, const Rect &region) {
	// The same expression computes every edge, so adjacent tiles share bit-identical edges.
	const auto edge_x = [&](std::int64_t i) {
		return tiling.offset.x + static_cast<double>(i) * tiling.size.x;
	};
	const auto edge_y = [&](std::int64_t i) {
		return tiling.offset.y + static_cast<double>(i) * tiling.size.y;
	};
	const auto tiles_before = [](double from, double size) {
		return static_cast<std::int64_t>(std::floor(from / size));
	};
	const std::int64_t first_x = tiles_before(region.min.x - tiling.offset.x, tiling.size.x) - 1;
	const std::int64_t first_y = tiles_before(region.min.y - tiling.offset.y, tiling.size.y) - 1;
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

/// The points that one worker found in `region`. `failure` is empty if all checks passed.
struct WorkerResult {
	std::vector<SamplePoint> points;
	std::string failure;
};

inline void harvest(const PointSet &set, const Rect &region, const std::vector<Rect> &tiles,
		std::atomic<std::size_t> &next, WorkerResult &r_result) {
	TileSampler sampler;
	std::vector<SamplePoint> points;
	for (std::size_t i = next++; i < tiles.size(); i = next++) {
		const Status status = sampler.sample(set, tiles[i], points);
		if (!status.ok()) {
			r_result.failure = describe(status);
			return;
		}
		for (const SamplePoint &point : points) {
			if (!tiles[i].contains(point.position)) {
				r_result.failure = "a point outside of its tile";
				return;
			}
			if (region.contains(point.position)) {
				r_result.points.push_back(point);
			}
		}
	}
}

/// Returns the points of `region`, collected from the tiles of a tiling and sorted by ID. A point
/// that two tiles return is included twice.
inline std::vector<SamplePoint> points_through(const PointSet &set, const Rect &region, const Tiling &tiling) {
	const std::vector<Rect> tiles = tiles_of(tiling, region);
	std::atomic<std::size_t> next{0};
	std::vector<WorkerResult> results(tiling.threads);
	std::vector<std::thread> workers;
	for (WorkerResult &result : results) {
		workers.emplace_back([&] { harvest(set, region, tiles, next, result); });
	}
	for (std::thread &worker : workers) {
		worker.join();
	}
	std::vector<SamplePoint> points;
	for (const WorkerResult &result : results) {
		REQUIRE_MESSAGE(result.failure.empty(), result.failure);
		points.insert(points.end(), result.points.begin(), result.points.end());
	}
	std::sort(points.begin(), points.end(), [](const SamplePoint &a, const SamplePoint &b) { return a.id < b.id; });
	return points;
}

/// Returns the points of `region` from a single call, sorted by ID.
inline std::vector<SamplePoint> points_at_once(const PointSet &set, const Rect &region) {
	TileSampler sampler;
	std::vector<SamplePoint> points;
	const Status status = sampler.sample(set, region, points);
	REQUIRE_MESSAGE(status.ok(), describe(status));
	std::sort(points.begin(), points.end(), [](const SamplePoint &a, const SamplePoint &b) { return a.id < b.id; });
	return points;
}

} // namespace thicket::tilings
