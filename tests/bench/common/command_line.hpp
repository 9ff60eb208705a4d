#pragma once

#include "core/base/status.hpp"

#include <cstdio>
#include <cstdlib>

namespace thicket::bench {

/// The extent of a benchmark's measurements, from its two optional arguments.
struct Effort {
	int rounds = 9;        ///< Number of rounds, at least 1.
	double seconds = 0.25; ///< The minimum CPU time of each measurement; above 0.
};

/// Returns the effort that the arguments of main() specify. If they are invalid, prints the usage
/// and ends the program.
inline Effort effort_of(int argument_count, char **arguments) {
	Effort effort;
	if (argument_count > 1) {
		effort.rounds = std::atoi(arguments[1]);
	}
	if (argument_count > 2) {
		effort.seconds = std::atof(arguments[2]);
	}
	if (effort.rounds < 1 || !(effort.seconds > 0.0)) {
		std::fprintf(stderr, "usage: %s [rounds >= 1] [seconds > 0]\n", arguments[0]);
		std::exit(EXIT_FAILURE);
	}
	return effort;
}

/// If `status` is an error, prints it and ends the program. For the setup of benchmarks.
inline void require(const Status &status) {
	if (!status.ok()) {
		std::fprintf(stderr, "bench: %s\n", describe(status).c_str());
		std::exit(EXIT_FAILURE);
	}
}

} // namespace thicket::bench
