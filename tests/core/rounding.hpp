// What was computed, by what the processor notes of it: for tests of "what need not be computed is not".

#pragma once

#include <cfenv>

namespace thicket::test {

/// Whether anything was rounded on this thread while `work` ran. Comparisons round nothing, nor does arithmetic with small whole
/// numbers: where all that has to be computed is such, whatever is rounded was computed in vain.
template <class Work>
bool rounds(const Work &work) {
	std::feclearexcept(FE_INEXACT);
	work();
	return std::fetestexcept(FE_INEXACT) != 0;
}

/// Whether anything went beyond the largest number meanwhile.
template <class Work>
bool overflows(const Work &work) {
	std::feclearexcept(FE_OVERFLOW);
	work();
	return std::fetestexcept(FE_OVERFLOW) != 0;
}

} // namespace thicket::test
