#pragma once

#include "tests/bench/common/command_line.hpp"
#include "tests/bench/common/timing.hpp"

#include "core/base/rect.hpp"
#include "core/sampling/tile_sampler.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace thicket::bench {

/// Returns the points of a layer with a radius of 2 m in a tile, in the tile's order. There are
/// about 7,000 in a tile of 200 m.
inline std::vector<glm::dvec2> points_of(const Rect &tile) {
	std::vector<SamplePoint> points;
	require(TileSampler().sample({.seed = 1, .radius = 2.0}, tile, points));
	std::vector<glm::dvec2> result;
	for (const SamplePoint &point : points) {
		result.push_back(point.position);
	}
	return result;
}

/// Measures several rules at the same points. The rules take turns.
class Contest {
public:
	explicit Contest(std::size_t points) : points_(points) {}

	/// Measures one round of a contender. The first call sets its name. `at` evaluates the
	/// densities at all points.
	template <typename At>
	void measure(std::size_t contender, const char *name, double seconds, At at) {
		if (contender == names_.size()) {
			names_.emplace_back(name);
			series_.emplace_back();
		}
		series_[contender].add(1e9 / rate(seconds, [&] { return at(), points_; }));
	}

	/// Prints a row for each contender, in nanoseconds per point.
	void print() const {
		for (std::size_t i = 0; i < names_.size(); ++i) {
			print_row(names_[i] + ": density at a point", series_[i], 1.0, " ns", 1);
		}
	}

private:
	std::size_t points_;
	std::vector<std::string> names_;
	std::vector<Series> series_;
};

} // namespace thicket::bench
