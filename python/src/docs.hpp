#pragma once

/// Types and words of the module, as Python's help and the stubs have them.
namespace thicket::python::doc {

inline constexpr const char *points = R"(The points of a set in a rectangle, as :func:`sample` gives them.

All arrays are read-only views into one piece of memory, as long as there are points: nothing is copied, and each
array keeps that memory as long as it lives. Entry i of each is about the same point.)";

inline constexpr const char *positions_type =
		"def positions(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], dict(shape=(None, 2))]";

inline constexpr const char *positions =
		R"(float64 of shape (n, 2): x and y of each point in meters, as exact far out as at the origin.)";

inline constexpr const char *ids =
		R"(uint64 of shape (n,): what names a point in every rectangle, for ever: 16 bits of layer, 24 of cell x, 24 of cell y.)";

inline constexpr const char *ranks =
		R"(uint32 of shape (n,): rank / 2**32 is the share of the set that comes before in the progressive order, at least 0
and below 1. Points with a rank below q * 2**32 are a fraction q of all; with several levels they are well spaced.)";

inline constexpr const char *levels =
		R"(uint32 of shape (n,): 0 for the finest; points of at least level l are a set of their own, of radius radius * 2**l.)";

inline constexpr const char *digest =
		R"(Two numbers of 64 bits that tell whether two machines made the same points: of places, ids and levels, and of the ranks.

The order of the points does not matter. They are those of the engine's own tests (tests/golden/core.json).

Raises MemoryError where 8 bytes a point are not to be had.)";

inline constexpr const char *cancel = R"(Ends calls from other threads: hand it to a call, and cancel it from anywhere.

Once cancelled it stays so, and a call that gets it then ends at once.)";

inline constexpr const char *cancel_cancel =
		R"(Ends the calls that have this object, within some milliseconds: they raise Cancelled. From any thread.)";

inline constexpr const char *cancel_cancelled = R"(Whether cancel() was called.)";

#define THICKET_NUMBERS "collections.abc.Sequence[float] | numpy.typing.NDArray[numpy.floating]"
#define THICKET_WATCHED \
	"progress: collections.abc.Callable[[float, int], object] | None = None, cancel: Cancel | None = None"

inline constexpr const char *sample_type =
		"def sample(rect: " THICKET_NUMBERS ", radius: float, seed: typing.SupportsIndex = 0, *, levels: int = 1, "
		"layer: int = 0, threads: int = 1, " THICKET_WATCHED ") -> Points";

inline constexpr const char *sample =
		R"(The points of an infinite Poisson-disk set in a rectangle: no two are closer than the radius, and none could be added.

Seed, radius, levels and layer name the set. A point is the same, to the bit, in every rectangle that holds it, on every
machine and for ever; so tiles fit together. Takes O(points) time, and lets other threads of Python run meanwhile.

Args:
    rect: (min_x, min_y, max_x, max_y) in meters, half-open: points p have min <= p < max. Within 2**23 * radius /
        sqrt(2) meters of the origin. An empty one has no points.
    radius: meters between any two points, at least; 0.001 to 1e6.
    seed: any 64 bits, signed or not: -1 and 2**64 - 1 name the same set. Other seeds name unrelated sets.
    levels: of the progressive order, 1 to 8. 1 is plain dart throwing, and the quickest.
    layer: 0 to 65535; goes into the ids, and names another set.
    threads: how many share a rectangle wider than 90 radii, 1 to 256; 0 for one on each core. Changes no point, nor their order.
    progress: called with the finished fraction (0 to 1, never falling) and the number of points so far, about every
        15 milliseconds, on the thread of the call, and with 1 at the end. What it raises ends the call.
    cancel: ends the call from another thread.

Raises:
    ValueError: an argument outside what stands above, or more than 1e8 points; it names argument and value.
    MemoryError: the points do not fit into the memory.
    Cancelled: by `cancel`.)";

#define THICKET_DOMAIN(precision, number) \
	"def sample_domain(size: " THICKET_NUMBERS ", radius: float, seed: typing.SupportsIndex = 0, *, " \
	"method: typing.Literal['naive', 'hierarchical', 'accumulator', 'wavefront'] = 'hierarchical', toroidal: bool = " \
	"False, " \
	"precision: typing.Literal[" precision ", cell_size: float = 0.0, darts_each: float = 100.0, " THICKET_WATCHED \
	") -> typing.Annotated[numpy.typing.NDArray[numpy." number "], dict(shape=(None, 2))]"

// Which array comes depends on one argument's value: two types for one function.
inline constexpr const char *sample_domain_double = THICKET_DOMAIN("'double'] = 'double'", "float64");
inline constexpr const char *sample_domain_single = THICKET_DOMAIN("'single']", "float32");

#undef THICKET_DOMAIN
#undef THICKET_WATCHED
#undef THICKET_NUMBERS

inline constexpr const char *sample_domain =
		R"(Fills the rectangle from (0, 0) up to, not including, (width, height) with a Poisson-disk set of its own.

By the methods of White, Cline and Egbert, Poisson Disk Point Sets by Hierarchical Dart Throwing (2007). Equal arguments give
equal points, to the bit, on every machine. Expected O(points); lets other threads of Python run meanwhile.

Args:
    size: (width, height) in meters, positive; at least 4 radii each where toroidal, at most 131072 in single precision.
    radius: meters between any two points, at least; 0.001 to 1e6.
    seed: any 64 bits, signed or not.
    method: 'hierarchical' throws darts at squares that are not known to be covered; 'accumulator' has the same law, with more
        memory and fewer searches; 'wavefront' spreads from one place and takes the least memory; 'naive' throws at the
        whole domain, for comparison: slow, and with small gaps left. The others leave no room for a further point.
    toroidal: whether opposite edges meet, so that the set repeats without a seam.
    precision: of coordinates and distances; 'single' takes half the memory, and gives another set.
    cell_size: width of an accelerator cell in radii, up to 1000; 0 for the method's own. Changes no point.
    darts_each: for 'naive': darts for each base square of side radius / sqrt(2), 1 to 1e6.
    progress, cancel: as in sample().

Returns:
    An array of shape (n, 2), float32 or float64 by precision, in the order in which the points were accepted. It is read-only and
    is the sampler's own memory: nothing is copied.

Raises:
    ValueError: an argument outside what stands above, or more than 1e9 points; it names argument and value.
    MemoryError: the points do not fit into the memory.
    Cancelled: by `cancel`.)";

inline constexpr const char *domain_digest_double =
		"def domain_digest(positions: typing.Annotated[numpy.typing.NDArray[numpy.float64], dict(shape=(None, 2), "
		"order='C')]) -> int";
inline constexpr const char *domain_digest_single =
		"def domain_digest(positions: typing.Annotated[numpy.typing.NDArray[numpy.float32], dict(shape=(None, 2), "
		"order='C')]) -> int";

inline constexpr const char *domain_digest =
		R"(64 bits that tell whether two machines made the same domain: of the positions in their order.

positions: what sample_domain() gave, or an equal contiguous array of float32 or float64. Raises TypeError for others.)";

} // namespace thicket::python::doc
