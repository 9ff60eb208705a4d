#pragma once

/* Thicket's points for every language: a plain C header (C11, or C++11 and later) over the core. README.md next to it shows how to build
 * and link it.
 *
 * Guarantees
 *
 * - Equal requests produce bit-identical points on every machine, compiler, processor and thread, and in every release.
 *   thicket_digest returns one number that shows whether two machines agree.
 * - Lengths and positions are meters in double precision. Seeds are any 64 bits.
 * - A sampler belongs to the caller that created it and serves one call at a time. A second call, from a different thread or from within a
 *   progress function, is refused as THICKET_BUSY. Only thicket_cancel may be called at any time, from any thread. Samplers are independent
 *   of each other: use one for each thread.
 * - A sampler keeps the points of its last call until the next one. Points are copied into buffers of the caller. No function keeps a
 *   pointer that it was given, and the caller frees nothing that it returns, except for the sampler itself.
 * - No function throws, ends the program, or prints. Every function that can fail returns a thicket_code, and thicket_message names the
 *   argument and its value. A sampler can still be used after a failed call. If that call was to generate points, the sampler holds none.
 * - NULL for a required argument is refused as THICKET_MISSING. */

#include <stddef.h>
#include <stdint.h>

/* The version of this header: major * 1000 + minor. A different major version requires a program to be
 * recompiled, and perhaps changed. */
#define THICKET_C_VERSION 1000

#if defined(__GNUC__) && !defined(_WIN32)
#define THICKET_API __attribute__((visibility("default")))
#else
#define THICKET_API
#endif

#ifdef __cplusplus
#define THICKET_NOEXCEPT noexcept
extern "C" {
#else
#define THICKET_NOEXCEPT
#endif

/* The result of a call. The numbers never change; later versions may add some. */
typedef enum thicket_code {
	THICKET_OK = 0,
	THICKET_NOT_FINITE = 1,      /* NAN or infinite where a finite number is needed. */
	THICKET_NOT_POSITIVE = 2,    /* Zero or negative where a positive number is needed. */
	THICKET_OUT_OF_RANGE = 3,    /* Finite, but outside the range in the argument's comment. */
	THICKET_INVERTED = 4,        /* A rectangle whose end lies before its start. */
	THICKET_TOO_MANY_POINTS = 5, /* More points than one call may generate. */
	THICKET_MISSING = 6,         /* NULL, or points that the sampler does not hold. */
	THICKET_OUT_OF_MEMORY = 7,   /* The machine does not have enough memory for the request. */
	THICKET_MARGIN_TOO_WIDE = 8, /* No margin within the limit decides a point; the message names it. Never seen. */
	THICKET_CANCELLED = 9,       /* Cancelled by thicket_cancel or the progress function. */
	THICKET_BUSY = 10,           /* A call of this sampler is in progress. */
	THICKET_FAILED = 11          /* Any other error; see the message. */
} thicket_code;

/* Names one infinite set of points: no two are closer than the radius, and no further point fits between them. */
typedef struct thicket_set {
	uint64_t seed;   /* A different seed names an unrelated set. */
	double radius;   /* Meters, 0.001 to 1e6. */
	uint32_t levels; /* Levels of the progressive order, 1 to 8. 1 is plain dart throwing, and the fastest. */
	uint16_t layer;  /* Part of the ids; a different layer is a different set. */
} thicket_set;

/* A half-open rectangle in meters, min <= p < max: rectangles that share an edge never share a point. It must lie within 2^23 *
 * radius / sqrt(2) meters of the origin on both axes. An empty rectangle has no points, and is no error. */
typedef struct thicket_rect {
	double min_x, min_y, max_x, max_y;
} thicket_rect;

/* A point of a set. */
typedef struct thicket_point {
	double x, y;    /* World meters, as exact far out as at the origin. */
	uint64_t id;    /* The same for this point in every rectangle: 16 bits of layer, 24 of cell x, 24 of cell y. */
	uint32_t rank;  /* rank / 2^32 is the share of the set that comes before in the progressive order. */
	uint32_t level; /* 0 for the finest; the points of level l and above form a set of radius r * 2^l. */
} thicket_point;

/* How a whole domain is filled (White, Cline and Egbert, "Poisson Disk Point Sets by Hierarchical Dart Throwing", 2007). All methods
 * except the naive one leave no room for a further point, down to the precision used. */
typedef enum thicket_method {
	THICKET_NAIVE = 1,        /* Throws darts at the whole domain. For comparison: slow, and leaves small gaps. */
	THICKET_HIERARCHICAL = 2, /* Throws darts at squares that are not known to be covered. */
	THICKET_ACCUMULATOR = 3,  /* The same distribution; more memory, fewer searches. */
	THICKET_WAVEFRONT = 4     /* Spreads from one position; takes the least memory. */
} thicket_method;

/* The rectangle from (0, 0) up to, not including, (size_x, size_y), to be filled with a set of its own. A field that is 0
 * has its default value, except for size, radius and method. All fields except cell_size determine the points. */
typedef struct thicket_domain {
	double size_x;     /* Meters, positive; at least 4 radii where toroidal, up to 131072 radii in single precision. */
	double size_y;     /* The same. */
	double radius;     /* Meters, 0.001 to 1e6. */
	double cell_size;  /* Width of an accelerator cell in radii, up to 1000; 0 for the default. Changes no point. */
	double darts_each; /* THICKET_NAIVE: darts for each base square, 1 to 1e6; 0 for 100. */
	uint64_t seed;     /* Any. */
	int32_t method;    /* A thicket_method. */
	int32_t toroidal;  /* 1: opposite edges meet, and the set repeats without a seam; else 0. */
	int32_t single_precision; /* 1: coordinates and distances of single precision, half the memory, a different set; else 0. */
} thicket_domain;

/* Watches a call. `progress` may be NULL. It is called on the thread of the call, every few milliseconds, with the finished fraction
 * (0 to 1, never falling) and the number of points generated until then. If it returns anything but 0, the call ends as THICKET_CANCELLED.
 * It must not throw. */
typedef struct thicket_watch {
	int (*progress)(void *user, double fraction, uint64_t points);
	void *user; /* Passed to `progress` unchanged. */
} thicket_watch;

/* Generates points, and holds those of its last call. */
typedef struct thicket_sampler thicket_sampler;

/* THICKET_C_VERSION of the library. Its major version, version / 1000, must be that of the header. May be called from any thread. */
THICKET_API uint32_t thicket_c_version(void) THICKET_NOEXCEPT;

/* A new sampler; NULL if there is no memory for it. May be called from any thread. */
THICKET_API thicket_sampler *thicket_sampler_new(void) THICKET_NOEXCEPT;

/* Frees a sampler and all its memory. NULL is allowed. No call of the sampler may be in progress. */
THICKET_API void thicket_sampler_free(thicket_sampler *sampler) THICKET_NOEXCEPT;

/* One sentence about the last call if it failed, such as "radius must be positive, got -1"; "" if it succeeded. Never NULL. Valid until
 * the next call with this sampler. While a call is in progress, or for NULL, it returns a sentence that states just that. */
THICKET_API const char *thicket_message(const thicket_sampler *sampler) THICKET_NOEXCEPT;

/* Generates the points of a set in a rectangle, in an order that depends only on the arguments. At most 1e8 points. `watch` and
 * `r_count` (the number of points) may be NULL. O(points). A sampler that was used before allocates memory only for more points. */
THICKET_API thicket_code thicket_sample(thicket_sampler *sampler, const thicket_set *set, const thicket_rect *rect,
		const thicket_watch *watch, uint64_t *r_count) THICKET_NOEXCEPT;

/* Fills a whole domain, with the points in the order of their acceptance. At most 1e9 points. Otherwise as above, but
 * these points have no ids, ranks and levels. Expected O(points). */
THICKET_API thicket_code thicket_sample_domain(thicket_sampler *sampler, const thicket_domain *domain,
		const thicket_watch *watch, uint64_t *r_count) THICKET_NOEXCEPT;

/* The number of points that the sampler holds. 0 for NULL, and while a call is in progress. */
THICKET_API uint64_t thicket_count(const thicket_sampler *sampler) THICKET_NOEXCEPT;

/* Copies `count` points, starting at index `first`, into `r_points`, which must have room for them. Returns THICKET_OUT_OF_RANGE if that is
 * beyond the last point, and THICKET_MISSING for points of thicket_sample_domain. In both cases it writes nothing. `r_points` may be NULL
 * if `count` is 0. */
THICKET_API thicket_code thicket_read_points(
		thicket_sampler *sampler, uint64_t first, uint64_t count, thicket_point *r_points) THICKET_NOEXCEPT;

/* As above, for the positions alone: x, y, x, y, ..., 2 * count numbers. Works for points of both functions. */
THICKET_API thicket_code thicket_read_positions(
		thicket_sampler *sampler, uint64_t first, uint64_t count, double *r_xy) THICKET_NOEXCEPT;

/* The digest of the points that the sampler holds: equal digests mean equal points. It ignores their order after thicket_sample, and
 * depends on it after thicket_sample_domain. `r_ranks` (may be NULL) receives the digest of the ranks, which a newer version may change; 0
 * after thicket_sample_domain. */
THICKET_API thicket_code thicket_digest(
		thicket_sampler *sampler, uint64_t *r_places, uint64_t *r_ranks) THICKET_NOEXCEPT;

/* Ends the call of this sampler that is in progress, within 50 milliseconds plus the time that the system takes to free its memory. Does
 * not affect calls that have not begun. May be called from any thread. */
THICKET_API void thicket_cancel(thicket_sampler *sampler) THICKET_NOEXCEPT;

#ifdef __cplusplus
}
#endif
