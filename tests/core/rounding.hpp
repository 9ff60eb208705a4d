// Reads the processor's floating-point flags, to prove that code skips computations it does not need.

#pragma once

#include <cfenv>

namespace thicket::test {

/// True if `work` rounded any result on this thread. Comparisons and arithmetic on small whole numbers do not round, so
/// rounding reveals unnecessary work.
template <class Work>
bool rounds(const Work &work) {
	std::feclearexcept(FE_INEXACT);
	work();
	return std::fetestexcept(FE_INEXACT) != 0;
}

/// True if any result of `work` overflowed.
template <class Work>
bool overflows(const Work &work) {
	std::feclearexcept(FE_OVERFLOW);
	work();
	return std::fetestexcept(FE_OVERFLOW) != 0;
}

} // namespace thicket::test
