#pragma once

// Which instruction sets Highway compiles its code for, the same wherever it is included: all that the processor may have, and
// the emulated one, which shows that vectors change no bit. To be included before Highway.

// Highway avoids the emulated one, four lanes as wide as the narrowest real ones, with compilers that miscompile a 16-bit
// multiply; nothing here uses that, and tests compare the bits of all paths.
#define HWY_BROKEN_EMU128 0
#define HWY_COMPILE_ALL_ATTAINABLE
// In what is shipped only those of which somebody has use: no processor lacks all the others, and those with SSSE3 and no SSE4 are
// older than any that runs the engine well. Code that says THICKET_SELDOM_RUN, whole domains, is large, and comes in three widths.
#if !defined(THICKET_SHIPPED)
#define THICKET_RARE_TARGETS 0
#elif defined(THICKET_SELDOM_RUN)
#define THICKET_RARE_TARGETS (HWY_SSSE3 | HWY_EMU128 | HWY_SSE4 | HWY_AVX3_ZEN4)
#else
#define THICKET_RARE_TARGETS (HWY_SSSE3 | HWY_EMU128)
#endif
// Vectors of a size that is known at run time only cannot be members of a class, and ours are. NEON and plain code stay. Two of the
// kinds of AVX-512 gave nothing over the first, and take a quarter of a megabyte; that of Zen 4 has other ways to compress.
#define HWY_DISABLED_TARGETS \
	(HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV | HWY_AVX3_DL | HWY_AVX3_SPR | THICKET_RARE_TARGETS)
