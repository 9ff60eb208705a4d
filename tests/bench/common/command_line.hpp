#pragma once

#include "core/base/status.hpp"

#include <cstdio>
#include <cstdlib>

namespace thicket::bench {

/// The duration of a bench's measurements: its two optional arguments.
struct Effort {
	int rounds = 9;        ///< At least 1.
	double seconds = 0.25; ///< Minimum processor time of each measurement; above 0.
};

/// The effort that main()'s arguments specify. Invalid arguments print the usage and end the program.
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

/// Ends the program with the error if a bench's setup is refused.
inline void require(const Status &status) {
	if (!status.ok()) {
		std::fprintf(stderr, "bench: %s\n", describe(status).c_str());
		std::exit(EXIT_FAILURE);
	}
}

} // namespace thicket::bench
