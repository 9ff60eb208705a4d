// Reads the processor's floating-point flags, to verify that code skips unnecessary computations.

#pragma once

#include <cfenv>

namespace thicket::test {

/// Returns true if `work` rounded any floating-point result on this thread. Comparisons and
/// arithmetic on small integers do not round, so rounding reveals unnecessary work.
template <class Work>
bool rounds(const Work &work) {
	std::feclearexcept(FE_INEXACT);
	work();
	return std::fetestexcept(FE_INEXACT) != 0;
}

/// Returns true if any floating-point result of `work` overflowed on this thread.
template <class Work>
bool overflows(const Work &work) {
	std::feclearexcept(FE_OVERFLOW);
	work();
	return std::fetestexcept(FE_OVERFLOW) != 0;
}

} // namespace thicket::test
