#pragma once

#include <cfloat>
#include <limits>

/// The core's results are bit-identical on every machine because it uses only IEEE 754 additions,
/// multiplications, divisions and square roots, each rounded once. Include this file wherever
/// decisions depend on such results. It fails the build under compiler settings that would change
/// results. It cannot detect a missing -ffp-contract=off; the golden tests do.

#ifdef __FAST_MATH__
#error "Thicket's core must not be compiled with -ffast-math: its results would depend on the compiler"
#endif

static_assert(std::numeric_limits<float>::is_iec559 && std::numeric_limits<double>::is_iec559);
static_assert(
		FLT_EVAL_METHOD == 0, "floats and doubles must be computed in their own precision (on x86: SSE2, not x87)");
