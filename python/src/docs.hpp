#pragma once

/// Signatures and docstrings of the module, for Python's help and the stubs.
namespace thicket::python::doc {

inline constexpr const char *points = R"(The points of a set in a rectangle, returned by :func:`sample`.

All arrays are read-only views into one block of memory without copies. Each array keeps that memory alive. Entry i of
every array belongs to the same point.)";

inline constexpr const char *positions_type =
		"def positions(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], dict(shape=(None, 2))]";

inline constexpr const char *positions =
		R"(float64 of shape (n, 2): x and y of each point in meters, with the same accuracy at any distance from the origin.)";

inline constexpr const char *ids =
		R"(uint64 of shape (n,): permanent IDs, the same in all rectangles. An ID has 16 bits for the layer, and 24 bits each for the x and y of
the point's cell.)";

inline constexpr const char *ranks =
		R"(uint32 of shape (n,): rank / 2**32 is the fraction of the set that precedes the point in the progressive order, at least
0 and below 1. The points with a rank below q * 2**32 are a fraction q of all points. With several levels, these points
are well spaced.)";

inline constexpr const char *levels =
		R"(uint32 of shape (n,): 0 for the finest level; the points of level l and above form a set with the minimum distance radius * 2**l.)";

inline constexpr const char *digest =
		R"(Returns two 64-bit numbers for comparing points across machines: a digest of positions, IDs and levels, and one of ranks.

The digests do not depend on the order of the points. The tests of the core use the same digests
(tests/golden/core.json).

Raises MemoryError if 8 bytes for each point cannot be allocated.)";

#define THICKET_VECTORS "typing.Annotated[numpy.typing.NDArray[numpy.float64], dict(shape=(None, 3))]"

inline constexpr const char *surface_points = R"(The points of a set on a surface, returned by :func:`sample_surface`.

All arrays are read-only views into one block of memory without copies. Each array keeps that memory alive. Entry i of
every array belongs to the same point.)";

inline constexpr const char *surface_positions =
		R"(float64 of shape (n, 3): the position of each point in meters, less than radius / 500,000 from its face.)";

inline constexpr const char *surface_normals =
		R"(float64 of shape (n, 3): the unit normal of the face, on the side from which its vertices run counterclockwise.)";

inline constexpr const char *surface_ids =
		R"(uint64 of shape (n,): permanent IDs. An ID has 16 bits for the layer, and 17, 14 and 17 bits for the x, y and z of the
point's cell, a cube with edges of radius / sqrt(3). IDs repeat after 131,072 cells along x and z, and after 16,384 along y.)";

inline constexpr const char *surface_faces =
		R"(uint32 of shape (n,): the face of each point, an index in the argument `faces` of sample_surface().)";

inline constexpr const char *cancel =
		R"(Cancels calls from any thread: pass this object to a call, and call its method `cancel` on another thread.

The object stays cancelled: a later call that receives it ends immediately.)";

inline constexpr const char *cancel_cancel =
		R"(Ends the calls that use this object within a few milliseconds: they raise Cancelled. Any thread may call this method.)";

inline constexpr const char *cancel_cancelled = R"(True if cancel() was called.)";

#define THICKET_NUMBERS "collections.abc.Sequence[float] | numpy.typing.NDArray[numpy.floating]"
#define THICKET_WATCHED \
	"progress: collections.abc.Callable[[float, int], object] | None = None, cancel: Cancel | None = None"

inline constexpr const char *sample_type =
		"def sample(rect: " THICKET_NUMBERS ", radius: float, seed: typing.SupportsIndex = 0, *, levels: int = 1, "
		"layer: int = 0, threads: int = 1, " THICKET_WATCHED ") -> Points";

inline constexpr const char *sample =
		R"(Returns the points of an infinite Poisson-disk set in a rectangle: no two points are closer than the radius, and no
additional point fits.

Seed, radius, levels and layer determine the set. A point is bit-identical in every rectangle that contains it, on every
machine and in all versions, so tiles fit together. The call takes O(points) time and releases the interpreter's lock.

Args:
    rect: (min_x, min_y, max_x, max_y) in meters, half-open: points p have min <= p < max. The rectangle must lie
        within 2**23 * radius / sqrt(2) meters of the origin. An empty rectangle has no points.
    radius: the minimum distance between two points in meters; 0.001 to 1e6.
    seed: any 64-bit integer, signed or not: -1 and 2**64 - 1 are the same seed. Different seeds produce unrelated sets.
    levels: the levels of the progressive order, 1 to 8. 1 is plain dart throwing and the fastest.
    layer: 0 to 65535; part of the IDs. Different layers are different sets.
    threads: the number of threads for a rectangle wider than 90 radii, 1 to 256; 0 for one per core. The number does not change
        the points or their order.
    progress: called with the finished fraction (0 to 1, never decreasing) and the number of points so far, about every
        15 milliseconds, on the calling thread, and with 1 at the end. An exception in it ends the call.
    cancel: an object with which another thread can end the call.

Raises:
    ValueError: an argument is out of range, or there are more than 1e8 points; the message has the argument and its value.
    MemoryError: the points do not fit into memory.
    Cancelled: `cancel` was cancelled.)";

#define THICKET_ARRAY(type) "typing.Annotated[numpy.typing.NDArray[numpy." type "], dict(shape=(None, 3))]"

inline constexpr const char *sample_surface_type =
		"def sample_surface(vertices: " THICKET_ARRAY("floating") ", faces: " THICKET_ARRAY(
				"integer") ", radius: float, "
						   "seed: typing.SupportsIndex = 0, *, window: " THICKET_NUMBERS
						   " | None = None, levels: int = 1, layer: int = 0, " THICKET_WATCHED ") -> SurfacePoints";

#undef THICKET_ARRAY

inline constexpr const char *sample_surface =
		R"(Returns the points of a Poisson-disk set on triangles in 3D space: no two points are closer than the radius in a straight line,
and no additional point fits on the surface.

The points depend on the position and shape of the surface, but not on how it is divided into triangles. They are distributed
evenly by area, regardless of the direction in which a triangle faces.
Seed, radius, levels and layer determine the set of a surface. A point is bit-identical in every window that contains it, on
every machine. The call takes O(points + triangles) time and releases the interpreter's lock. The method is Dart Throwing on Surfaces
(Cline, Jeschke, White, Razdan and Wonka, 2009), with darts that belong to cells of 3D space instead of triangles.

Args:
    vertices: array of shape (n, 3), in meters; converted to float64.
    faces: integer array of shape (m, 3): for each triangle, the indices of its three vertices. Triangles may lie in any
        arrangement, with any number of sheets above each other.
    radius: the minimum distance between two points in meters; 0.001 to 1e6.
    seed: any 64-bit integer, signed or not: -1 and 2**64 - 1 are the same seed.
    window: (min_x, min_y, min_z, max_x, max_y, max_z) in meters, half-open; None for the whole surface.
    levels: the levels of the progressive order, 1 to 8. 1 is plain dart throwing and the fastest.
    layer: 0 to 65535; part of the IDs. Different layers are different sets.
    progress, cancel: as in sample().

Raises:
    TypeError: vertices or faces is not an array of shape (n, 3) on the CPU.
    ValueError: an argument is out of range, a vertex is not finite, a face refers to a missing vertex, or there are more than 1e8
        points; the message has the argument and its value.
    MemoryError: the points do not fit into memory.
    Cancelled: `cancel` was cancelled.)";

#define THICKET_DOMAIN(precision, number) \
	"def sample_domain(size: " THICKET_NUMBERS ", radius: float, seed: typing.SupportsIndex = 0, *, " \
	"method: typing.Literal['naive', 'hierarchical', 'accumulator', 'wavefront'] = 'hierarchical', toroidal: bool = " \
	"False, " \
	"precision: typing.Literal[" precision ", cell_size: float = 0.0, darts_each: float = 100.0, " THICKET_WATCHED \
	") -> typing.Annotated[numpy.typing.NDArray[numpy." number "], dict(shape=(None, 2))]"

// The type of the returned array depends on the value of one argument, so the function has two signatures.
inline constexpr const char *sample_domain_double = THICKET_DOMAIN("'double'] = 'double'", "float64");
inline constexpr const char *sample_domain_single = THICKET_DOMAIN("'single']", "float32");

#undef THICKET_DOMAIN
#undef THICKET_WATCHED
#undef THICKET_NUMBERS

inline constexpr const char *sample_domain =
		R"(Fills the rectangle from (0, 0) to (width, height), exclusive, with a separate Poisson-disk set.

The methods are those of White, Cline and Egbert, Poisson Disk Point Sets by Hierarchical Dart Throwing (2007). Equal arguments produce
bit-identical points on every machine. The call takes O(points) expected time and releases the interpreter's lock.

Args:
    size: (width, height) in meters, positive; at least 4 radii each if toroidal, at most 131072 in single precision.
    radius: the minimum distance between two points in meters; 0.001 to 1e6.
    seed: any 64-bit integer, signed or not.
    method: 'hierarchical' throws darts at squares that may be uncovered; 'accumulator' has the same distribution, with more memory
        and fewer searches; 'wavefront' spreads from one point and uses the least memory; 'naive' throws darts at the whole
        domain, for comparison: it is slow and leaves small gaps. With all other methods, no additional point fits.
    toroidal: True to connect opposite edges, so that the set repeats without a seam.
    precision: the precision of coordinates and distances; 'single' takes half the memory and produces a different set.
    cell_size: the width of an accelerator cell in radii, up to 1000; 0 for the method's default. The width does not change the points.
    darts_each: for 'naive': the number of darts for each base square of radius / sqrt(2) in width, 1 to 1e6.
    progress, cancel: as in sample().

Returns:
    An array of shape (n, 2), float32 or float64 depending on precision, in the order in which the points were accepted. It is a read-only
    view into the sampler's memory, without a copy.

Raises:
    ValueError: an argument is out of range, or there are more than 1e9 points; the message has the argument and its value.
    MemoryError: the points do not fit into memory.
    Cancelled: `cancel` was cancelled.)";

inline constexpr const char *domain_digest_double =
		"def domain_digest(positions: typing.Annotated[numpy.typing.NDArray[numpy.float64], dict(shape=(None, 2), "
		"order='C')]) -> int";
inline constexpr const char *domain_digest_single =
		"def domain_digest(positions: typing.Annotated[numpy.typing.NDArray[numpy.float32], dict(shape=(None, 2), "
		"order='C')]) -> int";

inline constexpr const char *domain_digest =
		R"(Returns a 64-bit digest of a domain, for comparing domains across machines. The digest depends on the positions and their order.

positions: an array from sample_domain(), or an equal contiguous array of float32 or float64. Raises TypeError for other types.)";

} // namespace thicket::python::doc
