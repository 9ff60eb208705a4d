#pragma once

// The instruction sets that Highway compiles our code for: all that the processor may support, and the emulated set.
// The emulated set shows that vectors change no bit of a result. Include this before Highway, so that all files use the
// same sets.

// With compilers that miscompile a 16-bit multiply, Highway avoids the emulated set. Our code does not use that
// multiply, and tests compare the bits of all paths. The set's four lanes are as wide as the narrowest real ones.
#define HWY_BROKEN_EMU128 0
#define HWY_COMPILE_ALL_ATTAINABLE
// Shipped libraries contain only the instruction sets that matter. Every processor supports at least one of the
// remaining sets. Processors with SSSE3 but without SSE4 are older than any that runs the engine well. Code for whole
// domains is large, so it defines THICKET_SELDOM_RUN and is compiled in three widths only.
#if !defined(THICKET_SHIPPED)
#define THICKET_RARE_TARGETS 0
#elif defined(THICKET_SELDOM_RUN)
#define THICKET_RARE_TARGETS (HWY_SSSE3 | HWY_EMU128 | HWY_SSE4 | HWY_AVX3_ZEN4)
#else
#define THICKET_RARE_TARGETS (HWY_SSSE3 | HWY_EMU128)
#endif
// Our classes have vectors as members, so vectors whose size is only known at run time are disabled. NEON and plain
// code stay. Two of the AVX-512 variants were no faster than the first and take a quarter of a megabyte; the Zen 4
// variant compresses in a different way.
#define HWY_DISABLED_TARGETS \
	(HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_AVX3_DL | HWY_AVX3_SPR | THICKET_RARE_TARGETS)
