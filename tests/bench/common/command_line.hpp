#pragma once

#include "core/base/status.hpp"

#include <cstdio>
#include <cstdlib>

namespace thicket::bench {

/// How long a bench measures: its two arguments, both of which may be left out.
struct Effort {
	int rounds = 9;        ///< At least 1.
	double seconds = 0.25; ///< Of processor time that each measurement takes at the least; above 0.
};

/// The effort that the arguments of main() ask for. Ends the program with a word on its use where it is not as above.
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

/// Ends the program, saying why, where something was refused that a bench needs.
inline void require(const Status &status) {
	if (!status.ok()) {
		std::fprintf(stderr, "bench: %s\n", describe(status).c_str());
		std::exit(EXIT_FAILURE);
	}
}

} // namespace thicket::bench
