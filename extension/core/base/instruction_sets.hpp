#pragma once

// The instruction sets for which Highway, the vector library, compiles our code: all sets that the
// processor may support, and emulated vectors. With emulated vectors, tests can verify that real
// vectors return bit-identical results. Include this file before Highway, so that all files use the
// same sets.

// Highway disables emulated vectors for compilers that miscompile a 16-bit multiplication. Our code
// does not use that multiplication, and tests compare the bits of all code paths. Emulated vectors
// have four lanes, as many as the narrowest real vectors.
#define HWY_BROKEN_EMU128 0
#define HWY_COMPILE_ALL_ATTAINABLE
// Release libraries omit instruction sets of little use. Every processor still supports at least
// one of the remaining sets. Processors with SSSE3 but without SSE4 are too old to run the engine
// well. The code for whole domains is large, so it defines THICKET_SELDOM_RUN and is compiled for
// only three vector widths.
#if !defined(THICKET_SHIPPED)
#define THICKET_RARE_TARGETS 0
#elif defined(THICKET_SELDOM_RUN)
#define THICKET_RARE_TARGETS (HWY_SSSE3 | HWY_EMU128 | HWY_SSE4 | HWY_AVX3_ZEN4)
#else
#define THICKET_RARE_TARGETS (HWY_SSSE3 | HWY_EMU128)
#endif
// Our classes have vectors as members, so instruction sets whose vector size is known only at run
// time are disabled. NEON and scalar code remain. Two AVX-512 variants are disabled because they
// were no faster than the first AVX-512 variant and would add a quarter of a megabyte to the
// library. The Zen 4 variant stays, because it compresses vectors differently.
#define HWY_DISABLED_TARGETS \
	(HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_AVX3_DL | HWY_AVX3_SPR | THICKET_RARE_TARGETS)
