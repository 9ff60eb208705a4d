#pragma once

/* Thicket's points for every language: a plain C header (C11, or C++11 and later) over the core. README.md beside it shows how to build and link it.
 *
 * What it promises
 *
 * - Equal requests give equal points, to the bit, on every machine, compiler, processor and thread, for ever: thicket_digest tells
 *   in one number whether two machines agree.
 * - Lengths and positions are meters in double precision. Seeds are any 64 bits.
 * - A sampler belongs to who made it and serves one call at a time: a second one, from another thread or from within a progress
 *   function, is refused as THICKET_BUSY. Only thicket_cancel may be called at any time, from any thread. Samplers know nothing of each
 *   other: use one for each thread.
 * - A sampler keeps the points of its last call until the next one. Points are copied into buffers of the caller; nothing that a
 *   function was given is kept, and nothing that it hands out has to be freed, but the sampler itself.
 * - Nothing is thrown, nothing ends the program, and nothing is printed: every function that can fail returns a thicket_code, and
 *   thicket_message names the argument and its value. A sampler whose call failed works on as before; if that was to make points, it
 *   holds none.
 * - NULL where something is needed is refused as THICKET_MISSING. */

#include <stddef.h>
#include <stdint.h>

/* The version of this header: major * 1000 + minor. With another major version a program has to be compiled anew, and perhaps changed. */
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

/* What became of a call. The numbers stay; later versions may add some. */
typedef enum thicket_code {
	THICKET_OK = 0,
	THICKET_NOT_FINITE = 1,      /* NAN or infinite where a finite number is needed. */
	THICKET_NOT_POSITIVE = 2,    /* Zero or negative where a positive number is needed. */
	THICKET_OUT_OF_RANGE = 3,    /* Finite, but outside the range that stands at the argument. */
	THICKET_INVERTED = 4,        /* A rectangle whose end lies before its start. */
	THICKET_TOO_MANY_POINTS = 5, /* More points than one call may ask for. */
	THICKET_MISSING = 6,         /* NULL, or points that the sampler does not hold. */
	THICKET_OUT_OF_MEMORY = 7,   /* The machine has not enough memory for the request. */
	THICKET_MARGIN_TOO_WIDE = 8, /* A point that no margin in the limit decides; the message says where. Never seen. */
	THICKET_CANCELLED = 9,       /* By thicket_cancel or the progress function. */
	THICKET_BUSY = 10,           /* A call of this sampler is under way. */
	THICKET_FAILED = 11          /* Anything else; the message says what. */
} thicket_code;

/* Names one infinite set of points: no two are closer than the radius, and no further point fits between them. */
typedef struct thicket_set {
	uint64_t seed;   /* Another seed names an unrelated set. */
	double radius;   /* Meters, 0.001 to 1e6. */
	uint32_t levels; /* Of the progressive order, 1 to 8. 1 is plain dart throwing, and the quickest. */
	uint16_t layer;  /* Goes into the ids; another layer is another set. */
} thicket_set;

/* A half-open rectangle in meters, min <= p < max: rectangles that share an edge never share a point. It lies within 2^23 * radius /
 * sqrt(2) meters of the origin on both axes. An empty one has no points, and is no error. */
typedef struct thicket_rect {
	double min_x, min_y, max_x, max_y;
} thicket_rect;

/* A point of a set. */
typedef struct thicket_point {
	double x, y;    /* World meters, as exact far out as at the origin. */
	uint64_t id;    /* Stays that of this point in every rectangle: 16 bits of layer, 24 of cell x, 24 of cell y. */
	uint32_t rank;  /* rank / 2^32 is the share of the set that comes before in the progressive order. */
	uint32_t level; /* 0 for the finest; points of at least level l are a set of their own, of radius r * 2^l. */
} thicket_point;

/* How a whole domain is filled (White, Cline and Egbert, "Poisson Disk Point Sets by Hierarchical Dart Throwing", 2007). All but the
 * naive method leave no room for a further point, down to the precision used. */
typedef enum thicket_method {
	THICKET_NAIVE = 1,        /* Darts at the whole domain: for comparison, slow, and with small gaps left. */
	THICKET_HIERARCHICAL = 2, /* Darts at squares that are not known to be covered. */
	THICKET_ACCUMULATOR = 3,  /* The same law; more memory, fewer searches. */
	THICKET_WAVEFRONT = 4     /* Spreads from one place; takes the least memory. */
} thicket_method;

/* The rectangle from (0, 0) up to, not including, (size_x, size_y), to be filled with a set of its own. What is 0 here is as it usually
 * is, but size, radius and method. All fields but cell_size name the outcome. */
typedef struct thicket_domain {
	double size_x;    /* Meters, positive; at least 4 radii where toroidal, up to 131072 radii in single precision. */
	double size_y;    /* The same. */
	double radius;    /* Meters, 0.001 to 1e6. */
	double cell_size; /* Width of an accelerator cell in radii, up to 1000; 0 for the method's own. Changes no point. */
	double darts_each;        /* THICKET_NAIVE: darts for each base square, 1 to 1e6; 0 for 100. */
	uint64_t seed;            /* Any. */
	int32_t method;           /* A thicket_method. */
	int32_t toroidal;         /* 1: opposite edges meet, and the set repeats without a seam; else 0. */
	int32_t single_precision; /* 1: coordinates and distances of single precision, half the memory, another set; else 0. */
} thicket_domain;

/* Watches a call. `progress` may be NULL. It is called on the thread of the call, every few milliseconds, with the finished fraction
 * (0 to 1, never falling) and the points so far; if it returns anything but 0 the call ends as THICKET_CANCELLED. It must not throw. */
typedef struct thicket_watch {
	int (*progress)(void *user, double fraction, uint64_t points);
	void *user; /* Handed to `progress` as it is. */
} thicket_watch;

/* Makes points, and holds those of its last call. */
typedef struct thicket_sampler thicket_sampler;

/* THICKET_C_VERSION of the library; its major version, version / 1000, must be that of the header. Any thread. */
THICKET_API uint32_t thicket_c_version(void) THICKET_NOEXCEPT;

/* A new sampler; NULL if there is no memory for it. Any thread. */
THICKET_API thicket_sampler *thicket_sampler_new(void) THICKET_NOEXCEPT;

/* Gives all its memory back. NULL is fine. No call of it may be under way. */
THICKET_API void thicket_sampler_free(thicket_sampler *sampler) THICKET_NOEXCEPT;

/* One sentence about the last call if it failed, such as "radius must be positive, got -1"; "" if it did not. Never NULL; valid until
 * the next call with this sampler. While a call is under way, and of NULL, it says just that. */
THICKET_API const char *thicket_message(const thicket_sampler *sampler) THICKET_NOEXCEPT;

/* Makes the points of a set in a rectangle, in an order that follows from the arguments alone. At most 1e8 points. `watch` and
 * `r_count` (how many there are) may be NULL. O(points); a sampler that is warm asks the system for no memory but that of more points. */
THICKET_API thicket_code thicket_sample(thicket_sampler *sampler, const thicket_set *set, const thicket_rect *rect,
		const thicket_watch *watch, uint64_t *r_count) THICKET_NOEXCEPT;

/* Fills a whole domain, with the points in the order of their acceptance. At most 1e9 points. The rest is as above;
 * these points have no ids, ranks and levels. Expected O(points). */
THICKET_API thicket_code thicket_sample_domain(thicket_sampler *sampler, const thicket_domain *domain,
		const thicket_watch *watch, uint64_t *r_count) THICKET_NOEXCEPT;

/* How many points the sampler holds. 0 for NULL, and while a call is under way. */
THICKET_API uint64_t thicket_count(const thicket_sampler *sampler) THICKET_NOEXCEPT;

/* Copies `count` points from number `first` on into `r_points`, which has room for them. Beyond those that there are, THICKET_OUT_OF_RANGE;
 * points of thicket_sample_domain, THICKET_MISSING: then nothing is written. `r_points` may be NULL for no points. */
THICKET_API thicket_code thicket_read_points(
		thicket_sampler *sampler, uint64_t first, uint64_t count, thicket_point *r_points) THICKET_NOEXCEPT;

/* As above, of the positions alone: x, y, x, y, ..., 2 * count numbers. Of points of both kinds. */
THICKET_API thicket_code thicket_read_positions(
		thicket_sampler *sampler, uint64_t first, uint64_t count, double *r_xy) THICKET_NOEXCEPT;

/* The digest of the points that the sampler holds, whatever their order after thicket_sample, in their order after thicket_sample_domain: equal
 * digests, equal points. `r_ranks` (may be NULL) gets that of the ranks, which a newer version may change; 0 after thicket_sample_domain. */
THICKET_API thicket_code thicket_digest(
		thicket_sampler *sampler, uint64_t *r_places, uint64_t *r_ranks) THICKET_NOEXCEPT;

/* Ends the call of this sampler that is under way, within 50 milliseconds, and what the system takes to get its memory back. Without effect
 * on calls that have not begun. From any thread. */
THICKET_API void thicket_cancel(thicket_sampler *sampler) THICKET_NOEXCEPT;

#ifdef __cplusplus
}
#endif
