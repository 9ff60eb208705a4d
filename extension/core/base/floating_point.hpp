#pragma once

#include <cfloat>
#include <limits>

/// The core gives the same bits everywhere because it uses nothing but IEEE 754 additions, multiplications, divisions
/// and square roots, each rounded once. Include this where such a result decides something: it stops a build that would
/// break the promise. Contraction (-ffp-contract=off) cannot be seen from here; the golden tests see it.

#ifdef __FAST_MATH__
#error "Thicket's core must not be compiled with -ffast-math: its results would depend on the compiler"
#endif

static_assert(std::numeric_limits<float>::is_iec559 && std::numeric_limits<double>::is_iec559);
static_assert(
		FLT_EVAL_METHOD == 0, "floats and doubles must be computed in their own precision (on x86: SSE2, not x87)");
