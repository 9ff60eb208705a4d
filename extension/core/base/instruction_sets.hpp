#pragma once

// The instruction sets that Highway compiles its code for, the same wherever this is included: all that the processor may have, and the
// emulated one, which shows that vectors change no bit. Include this before Highway.

// With compilers that miscompile a 16-bit multiply, Highway avoids the emulated set, whose four lanes are as wide as the narrowest real
// ones. No code here uses that multiply, and tests compare the bits of all paths.
#define HWY_BROKEN_EMU128 0
#define HWY_COMPILE_ALL_ATTAINABLE
// Shipped libraries contain only the instruction sets that matter. Every processor has at least one of the others, and processors with
// SSSE3 but no SSE4 are older than any that runs the engine well. Code that defines THICKET_SELDOM_RUN, for whole domains, is large, so it
// is compiled in three widths only.
#if !defined(THICKET_SHIPPED)
#define THICKET_RARE_TARGETS 0
#elif defined(THICKET_SELDOM_RUN)
#define THICKET_RARE_TARGETS (HWY_SSSE3 | HWY_EMU128 | HWY_SSE4 | HWY_AVX3_ZEN4)
#else
#define THICKET_RARE_TARGETS (HWY_SSSE3 | HWY_EMU128)
#endif
// Vectors whose size is known only at run time cannot be members of a class, and ours are. NEON and plain code stay. Two of the AVX-512
// variants were no faster than the first and take a quarter of a megabyte; the Zen 4 variant compresses in a different way.
#define HWY_DISABLED_TARGETS \
	(HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_AVX3_DL | HWY_AVX3_SPR | THICKET_RARE_TARGETS)
