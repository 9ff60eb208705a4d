#pragma once

#include "tests/bench/common/timing.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace thicket::bench {

/// Rules that are asked for their densities at the same points, in turns.
class Contest {
public:
	explicit Contest(std::size_t points) : points_(points) {}

	/// One round of a contender, the first of which names it. `at` asks for all densities.
	template <typename At>
	void measure(std::size_t contender, const char *name, double seconds, At at) {
		if (contender == names_.size()) {
			names_.emplace_back(name);
			series_.emplace_back();
		}
		series_[contender].add(1e9 / rate(seconds, [&] { return at(), points_; }));
	}

	/// A row for each, in nanoseconds a point.
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
