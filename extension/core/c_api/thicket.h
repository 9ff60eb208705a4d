#pragma once

/* The C interface to Thicket's point sampler, for C11, C++11 and later, and for other languages that
 * can call C. README.md in this folder shows how to build and link it.
 *
 * Guarantees
 *
 * - Equal requests produce bit-identical points on every machine, compiler, processor and thread, and
 *   in every release. With thicket_digest, two machines can verify that they agree.
 * - Lengths and positions are in meters, in double precision. A seed may be any 64-bit number.
 * - A sampler belongs to the caller that created it and serves one call at a time. A second call, from
 *   another thread or from a progress function, fails with THICKET_BUSY. Only thicket_cancel may
 *   be called at any time and from any thread. Samplers are independent of each other: use one per
 *   thread.
 * - A sampler keeps the points of its last call until the next call that generates points. Points are
 *   copied to the caller's buffers. No function keeps a pointer that it receives. The caller frees
 *   only the sampler itself.
 * - No function throws, ends the program, or prints. Every function that can fail returns a
 *   thicket_code, and thicket_message names the argument and its value. A sampler remains usable
 *   after a failed call. After a failed call that generates points, it has no points.
 * - If a required argument is NULL, the call fails with THICKET_MISSING. */

#include <stddef.h>
#include <stdint.h>

/* The version of this header: major * 1000 + minor. Programs must be recompiled, and
 * perhaps changed, for a new major version. */
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

/* The result of a call. The numbers never change; later versions may add more. */
typedef enum thicket_code {
	THICKET_OK = 0,
	THICKET_NOT_FINITE = 1,      /* NAN or infinite where a finite number is required. */
	THICKET_NOT_POSITIVE = 2,    /* Zero or negative where a positive number is required. */
	THICKET_OUT_OF_RANGE = 3,    /* Finite, but outside the documented range. */
	THICKET_INVERTED = 4,        /* The end of a rectangle lies before its start. */
	THICKET_TOO_MANY_POINTS = 5, /* More points than one call may generate. */
	THICKET_MISSING = 6,         /* An argument is NULL, or the sampler has no such points. */
	THICKET_OUT_OF_MEMORY = 7,   /* The machine does not have enough memory for the request. */
	THICKET_MARGIN_TOO_WIDE =
			8, /* Even the widest margin is too narrow to decide a point; see the message. Never observed. */
	THICKET_CANCELLED = 9, /* thicket_cancel or the progress function ended the call. */
	THICKET_BUSY = 10,     /* A call to this sampler is in progress. */
	THICKET_FAILED = 11    /* Any other error; see the message. */
} thicket_code;

/* Identifies one infinite point set. No two points of the set are closer than the radius, and no additional point fits. */
typedef struct thicket_set {
	uint64_t seed;   /* A different seed produces an unrelated set. */
	double radius;   /* Meters, 0.001 to 1e6. */
	uint32_t levels; /* Levels of the progressive order, 1 to 8. 1 is plain dart throwing and the fastest. */
	uint16_t layer;  /* Stored in the IDs. A different layer produces an unrelated set. */
} thicket_set;

/* A half-open rectangle in meters. It contains p if min <= p < max on both axes, so rectangles that share
 * an edge never share a point. It must lie within 2^23 * radius / sqrt(2) meters of the origin on both
 * axes. An empty rectangle produces no points and no error. */
typedef struct thicket_rect {
	double min_x, min_y, max_x, max_y;
} thicket_rect;

/* A point of a set. */
typedef struct thicket_point {
	double x, y;    /* World meters, with the same accuracy at any distance from the origin. */
	uint64_t id;    /* The same in every rectangle: 16 bits for the layer, 24 for cell x, 24 for cell y. */
	uint32_t rank;  /* rank / 2^32 is the fraction of the set that precedes the point in the progressive order. */
	uint32_t level; /* 0 is the finest. The points of level l and above form a set of radius r * 2^l. */
} thicket_point;

/* The method for filling a whole domain (White, Cline and Egbert, "Poisson Disk Point Sets by
 * Hierarchical Dart Throwing", 2007). With all methods except the naive one, no additional point fits, to
 * within the floating-point precision. In single precision, no point fits at any multiple of the coordinate
 * step, which is 2^-23 of the smallest power of two above the longer side (or above 8 radii). */
typedef enum thicket_method {
	THICKET_NAIVE = 1,        /* Throws darts anywhere in the domain. For comparison: slow, and leaves small gaps. */
	THICKET_HIERARCHICAL = 2, /* Throws darts only at squares that are not known to be covered. */
	THICKET_ACCUMULATOR = 3,  /* Like THICKET_HIERARCHICAL, with more memory and cheaper lookups. */
	THICKET_WAVEFRONT = 4     /* Spreads from one corner. Needs the least memory. */
} thicket_method;

/* A domain to be filled with points: the rectangle from (0, 0), inclusive, to (size_x, size_y), exclusive.
 * For all fields except size, radius and method, 0 selects the default. All fields except cell_size affect
 * the points. */
typedef struct thicket_domain {
	double size_x;     /* Meters, positive. Toroidal: at least 4 radii. Single precision: at most 131072 radii. */
	double size_y;     /* Same range as size_x. */
	double radius;     /* Meters, 0.001 to 1e6. */
	double cell_size;  /* Width of an acceleration grid cell in radii, up to 1000; 0 for the default. */
	double darts_each; /* Only for THICKET_NAIVE: darts per base square, 1 to 1e6; 0 for 100. */
	uint64_t seed;     /* Any number. A different seed produces an unrelated set. */
	int32_t method;    /* A thicket_method. */
	int32_t toroidal;  /* 1 to join opposite edges, so that the set repeats seamlessly; otherwise 0. */
	/* 1 for float coordinates and distances, which need half the memory and produce a different set;
	 * otherwise 0. */
	int32_t single_precision;
} thicket_domain;

/* Monitors a call. The function `progress` is called on the calling thread, every few milliseconds. It may
 * be NULL. `fraction` is the finished fraction of the work (0 to 1, never decreasing), and `points` is the
 * number of points generated so far. If `progress` returns a value other than 0, the call ends with THICKET_CANCELLED.
 * `progress` must not throw. */
typedef struct thicket_watch {
	int (*progress)(void *user, double fraction, uint64_t points);
	void *user; /* Passed to `progress` unchanged. */
} thicket_watch;

/* A sampler generates points and keeps the points of its last call. */
typedef struct thicket_sampler thicket_sampler;

/* Returns THICKET_C_VERSION of the library. Its major version, version / 1000, must equal that of the
 * header. Any thread may call this function. */
THICKET_API uint32_t thicket_c_version(void) THICKET_NOEXCEPT;

/* Returns a new sampler, or NULL if memory runs out. Any thread may call this function. */
THICKET_API thicket_sampler *thicket_sampler_new(void) THICKET_NOEXCEPT;

/* Frees a sampler and its memory. `sampler` may be NULL. No call to the sampler may be in progress. */
THICKET_API void thicket_sampler_free(thicket_sampler *sampler) THICKET_NOEXCEPT;

/* Returns a message that explains why the last call failed, such as "radius must be positive, got -1",
 * or "" if it succeeded. Never returns NULL. The string is valid until the next call with this sampler. If a
 * call is in progress or `sampler` is NULL, the message states this. */
THICKET_API const char *thicket_message(const thicket_sampler *sampler) THICKET_NOEXCEPT;

/* Generates the points of a set in a rectangle, in an order that depends only on the arguments. Returns the
 * number of points, at most 1e8, in `r_count`. `watch` and `r_count` may be NULL. Takes O(points) time. A
 * reused sampler allocates memory only when it needs more than before. */
THICKET_API thicket_code thicket_sample(thicket_sampler *sampler, const thicket_set *set, const thicket_rect *rect,
		const thicket_watch *watch, uint64_t *r_count) THICKET_NOEXCEPT;

/* Fills a whole domain with at most 1e9 points, in the order of their acceptance. The points have no IDs,
 * ranks or levels. Takes O(points) expected time. The other arguments are the same as for thicket_sample. */
THICKET_API thicket_code thicket_sample_domain(thicket_sampler *sampler, const thicket_domain *domain,
		const thicket_watch *watch, uint64_t *r_count) THICKET_NOEXCEPT;

/* Returns the number of points in the sampler, or 0 for NULL and while a call is in progress. */
THICKET_API uint64_t thicket_count(const thicket_sampler *sampler) THICKET_NOEXCEPT;

/* Copies `count` points, starting at index `first`, to `r_points`, which must be large enough. Returns
 * THICKET_OUT_OF_RANGE if the range extends beyond the last point, and THICKET_MISSING for points of
 * thicket_sample_domain. In both cases it writes nothing. `r_points` may be NULL if `count` is 0. */
THICKET_API thicket_code thicket_read_points(
		thicket_sampler *sampler, uint64_t first, uint64_t count, thicket_point *r_points) THICKET_NOEXCEPT;

/* Copies only the positions of `count` points: 2 * count numbers, x, y, x, y, ... Also works for the points
 * of thicket_sample_domain. Otherwise like thicket_read_points. */
THICKET_API thicket_code thicket_read_positions(
		thicket_sampler *sampler, uint64_t first, uint64_t count, double *r_xy) THICKET_NOEXCEPT;

/* Computes digests of the points in the sampler, so that two machines can verify that they have equal
 * points. `r_places` receives the digest of the IDs, positions and levels. It is independent of the order
 * of the points after thicket_sample, but depends on the order after thicket_sample_domain. `r_ranks`
 * receives the digest of the ranks, which newer versions may change, or 0 after thicket_sample_domain.
 * `r_ranks` may be NULL. */
THICKET_API thicket_code thicket_digest(
		thicket_sampler *sampler, uint64_t *r_places, uint64_t *r_ranks) THICKET_NOEXCEPT;

/* Cancels the call to this sampler that is in progress. The call ends within 50 milliseconds, plus the time
 * that the system takes to free its memory. Calls that have not started yet are not affected. Any thread
 * may call this function. `sampler` may be NULL. */
THICKET_API void thicket_cancel(thicket_sampler *sampler) THICKET_NOEXCEPT;

#ifdef __cplusplus
}
#endif
