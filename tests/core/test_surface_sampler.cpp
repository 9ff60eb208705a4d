// Tests the guarantees of SurfaceSampler: distances, gaps, windows, uniformity, independence of the
// triangulation, and holes.

#include "core/sampling/tile_sampler.hpp"
#include "core/terrain/heightfield.hpp"
#include "surface_fixture.hpp"

#include <atomic>
#include <iterator>
#include <limits>
#include <numeric>
#include <set>
#include <string>

using namespace thicket;
using namespace thicket::surfaces;

namespace {

/// Returns the number of random positions on the surface without a point closer than the radius.
std::size_t count_gaps(const Triangles &triangles, const PointCubes &cubes, double radius, int tries) {
	std::mt19937 random(1);
	std::uniform_real_distribution<double> share(0.0, 1.0);
	std::size_t found_count = 0;
	for (int try_index = 0; try_index < tries; ++try_index) {
		const std::size_t triangle = 3 * (random() % (triangles.indices.size() / 3));
		double u = share(random);
		double v = share(random);
		if (u + v > 1.0) {
			u = 1.0 - u;
			v = 1.0 - v;
		}
		const auto corner = [&](std::size_t index) {
			return triangles.vertices[triangles.indices[triangle + index]];
		};
		const glm::dvec3 position = corner(0) * (1.0 - u - v) + corner(1) * u + corner(2) * v;
		found_count += cubes.nearest(position) > radius * (1.0 + 1e-5) ? 1 : 0;
	}
	return found_count;
}

/// Searches for a lattice line that intersects the plane where another point would fit. It
/// considers every line of the lattice, and skips only squares of lines whose intersections lie in
/// the ball of one point.
class LineSearch {
public:
	/// The lines are parallel to y. `facing`, the normal of the plane, must be a unit vector.
	LineSearch(const std::vector<SurfacePoint> &points, const PointSet &set, const glm::dvec3 &facing) :
			facing_(facing), unit_(surface_unit(set)) {
		for (const SurfacePoint &point : points) {
			points_.push_back(glm::floor(point.position / unit_ + 0.5));
		}
		plane_ = glm::dot(points_.front(), facing_);
	}

	/// Returns true if it finds such a line in the square that is 2^bits units wide and has its
	/// lower corner at (x, z). `near` contains the indices of the points to consider.
	bool finds(double x, double z, int bits, const std::vector<std::size_t> &near_points) {
		++squares;
		const double width = static_cast<double>(1 << bits);
		const auto reaches = [&](std::size_t point, double ball_radius) {
			double farthest = 0.0;
			for (const glm::dvec2 corner : {glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(0, 1), glm::dvec2(1, 1)}) {
				farthest = std::max(
						farthest, glm::distance(on_plane(x + corner.x * width, z + corner.y * width), points_[point]));
			}
			return farthest < ball_radius;
		};
		// The margin of 4 units allows for intersections that are rounded to whole units.
		if (std::ranges::any_of(near_points, [&](std::size_t point) { return reaches(point, radius - 4.0); })) {
			return false;
		}
		if (bits == 4) {
			const glm::dvec3 hit = glm::floor(on_plane(x + 8.0, z + 8.0));
			return std::ranges::none_of(
					near_points, [&](std::size_t point) { return glm::distance(hit, points_[point]) < radius + 2.0; });
		}
		std::vector<std::size_t> nearer;
		std::ranges::copy_if(near_points, std::back_inserter(nearer),
				[&](std::size_t point) { return reaches(point, radius + 2.0 * width + 4.0); });
		const double half = width / 2.0;
		return finds(x, z, bits - 1, nearer) || finds(x + half, z, bits - 1, nearer) ||
				finds(x, z + half, bits - 1, nearer) || finds(x + half, z + half, bits - 1, nearer);
	}

	std::vector<std::size_t> all() const {
		std::vector<std::size_t> numbers(points_.size());
		std::iota(numbers.begin(), numbers.end(), std::size_t{0});
		return numbers;
	}

	std::size_t squares = 0; ///< The number of squares that were checked.

private:
	static constexpr double radius = 1048576.0; // In lattice units.

	glm::dvec3 on_plane(double x, double z) const {
		return {x, (plane_ - facing_.x * x - facing_.z * z) / facing_.y, z};
	}

	std::vector<glm::dvec3> points_;
	glm::dvec3 facing_;
	double unit_;
	double plane_ = 0.0;
};

void check_distances(const Triangles &triangles, const PointSet &set) {
	const std::vector<SurfacePoint> points = all_points(set, *triangles.surface());
	REQUIRE(points.size() > 100);
	const PointCubes cubes(points, set.radius);
	double min_distance = std::numeric_limits<double>::infinity();
	for (std::size_t index = 0; index < points.size(); ++index) {
		min_distance = std::min(min_distance, cubes.nearest(points[index].position, index));
	}
	CHECK(min_distance >= set.radius * (1.0 - 1e-9));
	CHECK(count_gaps(triangles, cubes, set.radius, 20000) == 0);
}

/// Returns a floor, a wall, and a ceiling with a second floor just above it: parallel sheets,
/// corners, and a thin gap.
Triangles house() {
	Triangles triangles = square(20.0, 10, {0, 0, 0}, {1, 0, 0}, {0, 0, 1});
	triangles.append(square(20.0, 7, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
	triangles.append(square(20.0, 3, {0, 4, 0}, {1, 0, 0}, {0, 0, 1}));
	triangles.append(square(20.0, 4, {0, 4.2, 0}, {1, 0, 0}, {0, 0, 1}));
	return triangles;
}

/// Returns narrow folds: no axis is close to all normals of a cell, and some faces are steep along each axis.
Triangles folds() {
	Triangles triangles = square(20.0, 40, {0, 0, 0}, {1, 0.03, 0.06}, {0.05, 0, 1});
	for (std::size_t index = 0; index < triangles.vertices.size(); ++index) {
		triangles.vertices[index].y += index % 41 % 4 < 2 ? 0.0 : 4.0;
	}
	return triangles;
}

std::set<std::uint64_t> ids(const std::vector<SurfacePoint> &points) {
	std::set<std::uint64_t> result;
	for (const SurfacePoint &point : points) {
		result.insert(point.id);
	}
	return result;
}

double shared(const std::vector<SurfacePoint> &a, const std::vector<SurfacePoint> &b) {
	const std::set<std::uint64_t> first = ids(a);
	const std::set<std::uint64_t> second = ids(b);
	std::vector<std::uint64_t> all_ids;
	std::ranges::set_intersection(first, second, std::back_inserter(all_ids));
	return static_cast<double>(all_ids.size()) / static_cast<double>(std::max(first.size(), second.size()));
}

} // namespace

TEST_CASE("surface sampler: the triangles of a heightfield have the points of a mesh with the same triangles") {
	std::vector<float> heights(50 * 50);
	std::mt19937 random(2);
	for (float &height : heights) {
		height = random() % 30 == 0 ? std::nanf("") : std::uniform_real_distribution<float>(0.0f, 2.0f)(random);
	}
	Heightfield field;
	REQUIRE(field.set_meters({{50, 50}, {{-30.0, -10.0}, {20.0, 40.0}}}, heights).ok());
	Triangles mesh;
	for (std::uint32_t index = 0; index < field.surface()->triangle_count(); ++index) {
		for (const glm::dvec3 &corner : field.surface()->triangle(index)) {
			mesh.indices.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
			mesh.vertices.push_back(corner);
		}
	}
	const PointSet set{.seed = 9, .layer = 2};
	const std::vector<SurfacePoint> points = all_points(set, *field.surface());
	CHECK(points.size() > 1000);
	CHECK(points == all_points(set, *mesh.surface()));
}

TEST_CASE("surfaces: no two points are closer than the radius, and no gap has room for another point") {
	check_distances(facing({0, 1, 0}, 40.0, 20), {.seed = 1});
	// This plane is a common face of cells.
	check_distances(square(40.0, 20, {0, 0, 0}, {1, 0, 0}, {0, 0, 1}), {.seed = 2});
	check_distances(facing({0, 1, 1}, 40.0, 20), {.seed = 3});
	check_distances(facing({1, 1, 1}, 40.0, 20), {.seed = 4});
	check_distances(sphere(10.0, 40), {.seed = 5});
	check_distances(sphere(10.0, 200), {.seed = 6, .radius = 0.7});
	check_distances(folds(), {.seed = 9});
	check_distances(house(), {.seed = 7});
	check_distances(house(), {.seed = 8, .radius = 0.35, .levels = 3});
}

TEST_CASE("surfaces: no line of the lattice is left where another point would fit") {
	for (const glm::dvec3 normal : {glm::dvec3(0, 1, 0), glm::dvec3(1, 8, 3), glm::dvec3(3, 4, 2)}) {
		const PointSet set{.seed = 61};
		const glm::dvec3 unit = glm::normalize(normal);
		const glm::dvec3 tangent = glm::normalize(glm::cross(unit, glm::dvec3(0, 0, 1)));
		const Triangles plane = square(24.0, 12, {-12.3, 0.1, -12.2}, tangent, glm::cross(tangent, unit));
		std::vector<SurfacePoint> points = all_points(set, *plane.surface());
		// The search covers the cell in the middle of the plane. A cell is 2^20 units wide.
		const double cell = 1048576.0;
		const glm::dvec3 middle =
				glm::floor((plane.vertices.front() + plane.vertices.back()) / 2.0 / surface_unit(set) / cell) * cell;
		const auto finds = [&] {
			LineSearch search(points, set, unit);
			bool is_found = false;
			for (int number = 0; number < 64; ++number) {
				is_found |= search.finds(
						middle.x + (number % 8 - 4) * cell, middle.z + (number / 8 - 4) * cell, 20, search.all());
			}
			CHECK(search.squares > 64);
			return is_found;
		};
		CHECK_FALSE(finds());
		// After a point is removed, the search finds its position.
		std::ranges::sort(points, {},
				[&](const SurfacePoint &point) { return glm::distance(point.position / surface_unit(set), middle); });
		points.erase(points.begin());
		CHECK(finds());
	}
}

TEST_CASE("surfaces: with faces that point up, the underside of a thin bridge takes no space from its top") {
	const glm::dvec3 x(1.0, 0.0, 0.0);
	const glm::dvec3 z(0.0, 0.0, 1.0);
	const Triangles top = square(12.0, 4, glm::dvec3(0.0), z, x);
	const Triangles underside = square(12.0, 4, glm::dvec3(0.0, -0.5, 0.0), x, z);
	Triangles bridge = top;
	bridge.append(underside);
	PointSet set{.seed = 9, .radius = 1.0, .on_surface = true};
	const auto alone = [&set](const Triangles &triangles) {
		set.faces = SurfaceFaces::all;
		return ids(all_points(set, *triangles.surface()));
	};
	const auto of_bridge = [&](SurfaceFaces faces) {
		set.faces = faces;
		return ids(all_points(set, *bridge.surface()));
	};
	CHECK(of_bridge(SurfaceFaces::up) == alone(top));
	CHECK(of_bridge(SurfaceFaces::down) == alone(underside));
	CHECK(2 * of_bridge(SurfaceFaces::all).size() < 3 * alone(top).size());
	// A wall is treated as vertical, whichever way rounding tilts it.
	for (const double tilt : {-1e-7, 0.0, 1e-7}) {
		const Triangles wall = square(12.0, 4, glm::dvec3(0.0), glm::normalize(glm::dvec3(0.0, 1.0, tilt)), x);
		set.faces = SurfaceFaces::up;
		const std::size_t wall_count = all_points(set, *wall.surface()).size();
		set.faces = SurfaceFaces::down;
		CHECK(all_points(set, *wall.surface()).size() == wall_count);
		CHECK(wall_count == alone(wall).size());
	}
}

TEST_CASE("surfaces: IDs are unique") {
	const std::vector<SurfacePoint> points = all_points({.seed = 3, .layer = 5}, *sphere(15.0, 60).surface());
	CHECK(ids(points).size() == points.size());
	CHECK(std::ranges::all_of(points, [](const SurfacePoint &point) { return point.id >> 48 == 5; }));
}

TEST_CASE("surfaces: windows of any size return the same points, each once") {
	for (const std::uint32_t levels : {1u, 3u}) {
		CAPTURE(levels);
		const PointSet set{.seed = 11, .levels = levels};
		const auto surface = sphere(12.0, 50).surface();
		std::vector<SurfacePoint> whole_set = all_points(set, *surface);
		sort_by_id(whole_set);
		for (const double width : {5.0, 7.3, 30.0}) {
			CAPTURE(width);
			SurfaceSampler sampler;
			std::vector<SurfacePoint> joined_parts;
			std::vector<SurfacePoint> tile_points;
			const int count = static_cast<int>(std::ceil(26.0 / width));
			for (int tile_index = count * count * count - 1; tile_index >= 0; --tile_index) {
				const glm::dvec3 low =
						glm::dvec3(tile_index % count, tile_index / count % count, tile_index / count / count) * width -
						13.0;
				REQUIRE(sampler.sample(set, *surface, {low, low + width}, tile_points).ok());
				joined_parts.insert(joined_parts.end(), tile_points.begin(), tile_points.end());
			}
			sort_by_id(joined_parts);
			CHECK(joined_parts == whole_set);
		}
	}
}

TEST_CASE("surfaces: windows of hills return the points of the whole surface, for many seeds") {
	Triangles hills = square(80.0, 20, {0, 0, 0}, {1, 0, 0}, {0, 0, 1});
	for (glm::dvec3 &vertex : hills.vertices) {
		vertex.y = 8.0 * std::sin(vertex.x / 6.5) * std::cos(vertex.z / 6.5);
	}
	const auto surface = hills.surface();
	for (std::uint64_t seed = 1; seed <= 12; ++seed) {
		CAPTURE(seed);
		const PointSet set{.seed = seed, .levels = seed % 2 == 0 ? 1u : 3u};
		std::vector<SurfacePoint> whole_set = all_points(set, *surface);
		SurfaceSampler sampler;
		std::vector<SurfacePoint> joined_parts;
		std::vector<SurfacePoint> tile_points;
		for (int tile_index = 0; tile_index < 36; ++tile_index) {
			const glm::dvec3 low(tile_index % 6 * 16.0, -10.0, tile_index / 6 * 16.0);
			REQUIRE(sampler.sample(set, *surface, {low, low + glm::dvec3(16.0, 20.0, 16.0)}, tile_points).ok());
			joined_parts.insert(joined_parts.end(), tile_points.begin(), tile_points.end());
		}
		sort_by_id(whole_set);
		sort_by_id(joined_parts);
		CHECK(joined_parts == whole_set);
	}
}

TEST_CASE("surfaces: the margin does not affect the points") {
	const PointSet set{.seed = 12};
	const auto surface = facing({1, 3, 2}, 60.0, 20).surface();
	const Box3 window{{-10, -10, -10}, {10, 10, 10}};
	std::vector<SurfacePoint> expected;
	std::vector<SurfacePoint> narrow;
	REQUIRE(SurfaceSampler().sample(set, *surface, window, expected).ok());
	SurfaceSampler sampler({.first = 2, .widest = 256});
	REQUIRE(sampler.sample(set, *surface, window, narrow).ok());
	CHECK(sampler.stats().retries > 0);
	CHECK(narrow == expected);
	SurfaceSampler too_narrow({.first = 1, .widest = 1});
	const Status status = too_narrow.sample(set, *surface, window, narrow);
	CHECK(status.code == ErrorCode::margin_too_wide);
	CHECK(narrow.empty());
}

TEST_CASE("surface sampler: a face along a cell's border, tilted by less than a unit, gets points") {
	// When the engine rotates a mesh by a right angle, its faces are tilted by such an error. Lines
	// in the cells on one side of a lattice plane then hit the face on the other side of the plane.
	const PointSet set{.seed = 7, .radius = 1.0, .levels = 1, .layer = 0};
	for (const double tilt : {0.0, 4.37e-8, -4.37e-8, 1e-7, 1e-6, 1e-5}) {
		for (const double at : {0.0, 1.0 / std::sqrt(3.0), 0.3}) {
			const glm::dvec3 slope = glm::normalize(glm::dvec3(0, -1, tilt));
			const auto wall = square(24.0, 1, {-12, 12, at - 12 * tilt}, {1, 0, 0}, slope).surface();
			const auto points = all_points(set, *wall);
			CHECK(points.size() > 390);
			CHECK(points.size() < 440);
		}
	}
}

TEST_CASE("surfaces: points are even by area in every direction") {
	const PointSet set{.seed = 21};
	const auto surface = sphere(50.0, 150).surface();
	const std::vector<SurfacePoint> points = all_points(set, *surface);
	// In the plane, random sequential adsorption of disks jams at 0.54707 (Feder 1980). On this
	// sphere, the straight-line distances increase it slightly.
	CHECK(coverage(set, *surface, points.size()) == doctest::Approx(0.5471).epsilon(0.003));
	// Slices of a sphere with equal thickness have equal areas, along each axis and along a
	// diagonal.
	for (const glm::dvec3 axis :
			{glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1), glm::normalize(glm::dvec3(1, 1, 1))}) {
		std::vector<double> slices(8);
		for (const SurfacePoint &point : points) {
			const double fraction = glm::dot(point.position, axis) / 50.0;
			slices[static_cast<std::size_t>(std::clamp(fraction * 4.0 + 4.0, 0.0, 7.0))] += 1.0;
		}
		for (const double slice : slices) {
			CHECK(slice / (static_cast<double>(points.size()) / 8.0) == doctest::Approx(1.0).epsilon(0.02));
		}
	}
}

TEST_CASE("surfaces: the distances between neighbors are distributed as on the plane") {
	const PointSet set{.seed = 22};
	const std::vector<SurfacePoint> points = all_points(set, *sphere(40.0, 120).surface());
	const PointCubes cubes(points, 1.5);
	TileSampler plane_sampler;
	std::vector<SamplePoint> flat;
	REQUIRE(plane_sampler.sample(set, {{0, 0}, {140, 140}}, flat).ok());
	std::vector<SurfacePoint> lifted;
	for (const SamplePoint &point : flat) {
		lifted.push_back({{point.position.x, 0.0, point.position.y}, {}, 0, 0, 0, 0});
	}
	const PointCubes flat_cubes(lifted, 1.5);
	for (const double distance : {1.05, 1.1, 1.2, 1.35, 1.5}) {
		CAPTURE(distance);
		double near_count = 0.0;
		for (const SurfacePoint &point : points) {
			near_count += static_cast<double>(cubes.count_within(point.position, distance) - 1);
		}
		double near_flat = 0.0;
		double inner = 0.0;
		for (const SurfacePoint &point : lifted) {
			const glm::dvec3 &at = point.position;
			if (at.x > 2.0 && at.z > 2.0 && at.x < 138.0 && at.z < 138.0) {
				near_flat += static_cast<double>(flat_cubes.count_within(at, distance) - 1);
				inner += 1.0;
			}
		}
		CHECK(near_count / static_cast<double>(points.size()) == doctest::Approx(near_flat / inner).epsilon(0.03));
	}
}

TEST_CASE("surfaces: a different division into triangles keeps the points") {
	const PointSet set{.seed = 31};
	for (const glm::dvec3 normal : {glm::dvec3(0, 1, 0), glm::dvec3(1, 2, 3), glm::dvec3(1, 1, 1)}) {
		CHECK(shared(all_points(set, *facing(normal, 80.0, 40).surface()),
					  all_points(set, *facing(normal, 80.0, 67).surface())) > 0.999);
	}
	// The order and the winding of the triangles have no effect on the positions.
	Triangles triangles = sphere(10.0, 30);
	const std::vector<SurfacePoint> points = all_points(set, *triangles.surface());
	std::ranges::reverse(triangles.indices);
	std::vector<SurfacePoint> reversed = all_points(set, *triangles.surface());
	REQUIRE(reversed.size() == points.size());
	for (std::size_t index = 0; index < points.size(); ++index) {
		REQUIRE(reversed[index].position == points[index].position);
		CHECK(glm::dot(reversed[index].normal, points[index].normal) == doctest::Approx(-1.0));
	}
}

TEST_CASE("surfaces: next to steep walls, the order of the triangles has no effect on the positions") {
	// The walls are just too steep to be a height field over the floor, and end within the floor's cells.
	Triangles triangles = square(13.0, 13, {0.3, 0.1, 0.2}, {1, 0, 0}, {0, 0, 1});
	for (double x = 0.7; x < 12.0; x += 0.55) {
		triangles.append(square(0.85, 1, {x, 0.1, 0.6}, glm::normalize(glm::dvec3(0.11, 1, 0)), {0, 0, 14.0}));
	}
	Triangles reversed = triangles;
	std::ranges::reverse(reversed.indices);
	const auto surface = triangles.surface();
	const auto reversed_surface = reversed.surface();
	for (std::uint64_t seed = 0; seed < 12; ++seed) {
		std::vector<SurfacePoint> points = all_points({.seed = seed}, *surface);
		std::vector<SurfacePoint> other_points = all_points({.seed = seed}, *reversed_surface);
		sort_by_id(points);
		sort_by_id(other_points);
		const auto same_position = [](const SurfacePoint &a, const SurfacePoint &b) {
			return a.position == b.position;
		};
		CHECK(std::ranges::equal(points, other_points, same_position));
	}
}

TEST_CASE("surfaces: a hole changes nothing far from it") {
	const PointSet set{.seed = 41};
	Triangles triangles = facing({1, 4, 1}, 60.0, 60);
	const std::vector<SurfacePoint> before = all_points(set, *triangles.surface());
	const glm::dvec3 middle = triangles.vertices[30 * 61 + 30];
	std::vector<std::uint32_t> remaining;
	for (std::size_t first = 0; first < triangles.indices.size(); first += 3) {
		if (glm::distance(triangles.vertices[triangles.indices[first]], middle) > 4.0) {
			remaining.insert(remaining.end(), triangles.indices.begin() + static_cast<std::ptrdiff_t>(first),
					triangles.indices.begin() + static_cast<std::ptrdiff_t>(first) + 3);
		}
	}
	REQUIRE(remaining.size() < triangles.indices.size());
	triangles.indices = remaining;
	std::vector<SurfacePoint> after = all_points(set, *triangles.surface());
	const std::set<std::uint64_t> kept_ids = ids(after);
	std::size_t far_count = 0;
	for (const SurfacePoint &point : before) {
		if (glm::distance(point.position, middle) > 4.0 + 13.0) {
			++far_count;
			CHECK(kept_ids.contains(point.id));
		}
	}
	CHECK(far_count > 1000);
	CHECK(std::ranges::all_of(
			after, [&](const SurfacePoint &point) { return glm::distance(point.position, middle) > 2.0; }));
}

TEST_CASE("surfaces: every level is a maximal set") {
	const PointSet set{.seed = 51, .levels = 3};
	const Triangles triangles = facing({1, 2, 1}, 80.0, 20);
	const std::vector<SurfacePoint> points = all_points(set, *triangles.surface());
	for (std::uint32_t level = 0; level < 3; ++level) {
		CAPTURE(level);
		const std::uint64_t end = level_rank_end(3, level);
		std::vector<SurfacePoint> tile_points;
		for (const SurfacePoint &point : points) {
			CHECK((point.rank < end) == (point.level >= level));
			if (point.level >= level) {
				tile_points.push_back(point);
			}
		}
		const double radius = static_cast<double>(1u << level);
		const PointCubes cubes(tile_points, radius);
		double min_distance = std::numeric_limits<double>::infinity();
		for (std::size_t index = 0; index < tile_points.size(); ++index) {
			min_distance = std::min(min_distance, cubes.nearest(tile_points[index].position, index));
		}
		CHECK(min_distance >= radius * (1.0 - 1e-9));
		CHECK(count_gaps(triangles, cubes, radius, 20000) == 0);
		CHECK(static_cast<double>(tile_points.size()) / static_cast<double>(points.size()) ==
				doctest::Approx(static_cast<double>(end) / 4294967296.0).epsilon(0.05));
	}
}

TEST_CASE("surfaces: invalid input is rejected and has no effect") {
	const double nan = std::numeric_limits<double>::quiet_NaN();
	std::shared_ptr<const Surface> surface = sphere(3.0, 10).surface();
	const std::shared_ptr<const Surface> before = surface;
	CHECK(Surface::create({{0, 0, 0}, {1, nan, 0}, {0, 0, 1}}, {0, 1, 2}, surface).code == ErrorCode::not_finite);
	CHECK(Surface::create({{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, {0, 1, 3}, surface).code == ErrorCode::out_of_range);
	CHECK(Surface::create({{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, {0, 1}, surface).code == ErrorCode::wrong_size);
	CHECK(surface == before);
	SurfaceSampler sampler;
	std::vector<SurfacePoint> points(1);
	CHECK(sampler.sample({.radius = 0.0}, *surface, {{-1, -1, -1}, {1, 1, 1}}, points).code != ErrorCode::none);
	CHECK(sampler.sample({}, *surface, {{-1, -1, nan}, {1, 1, 1}}, points).code == ErrorCode::not_finite);
	CHECK(sampler.sample({}, *surface, {{1, 1, 1}, {-1, -1, -1}}, points).code == ErrorCode::inverted);
	const auto wide = square(1e5, 1, {0, 0, 0}, {1, 0, 0}, {0, 0, 1}).surface();
	CHECK(sampler.sample_all({.radius = 0.01}, *wide, points).code == ErrorCode::too_many_points);
	CHECK(points.size() == 1);
}

TEST_CASE("surfaces: no triangles and degenerate triangles have no points") {
	SurfaceSampler sampler;
	std::vector<SurfacePoint> points(1);
	std::shared_ptr<const Surface> surface;
	REQUIRE(Surface::create({}, {}, surface).ok());
	CHECK(sampler.sample_all({}, *surface, points).ok());
	CHECK(points.empty());
	REQUIRE(Surface::create({{0, 0, 0}, {10, 0, 0}, {20, 0, 0}}, {0, 1, 2, 0, 0, 1}, surface).ok());
	CHECK(sampler.sample_all({}, *surface, points).ok());
	CHECK(points.empty());
}

TEST_CASE("surfaces: a large triangle in a small window costs no more than the window") {
	const auto surface = square(1e5, 1, {-5e4, 0.2, -5e4}, {1, 0, 0}, {0, 0, 1}).surface();
	SurfaceSampler sampler;
	std::vector<SurfacePoint> points;
	REQUIRE(sampler.sample({.seed = 6}, *surface, {{100, -5, 100}, {120, 5, 120}}, points).ok());
	CHECK(points.size() > 200);
	CHECK(sampler.stats().cells < 20000);
}

TEST_CASE("surfaces: a call can be canceled and reports its progress") {
	const auto surface = sphere(60.0, 60).surface();
	std::atomic<bool> cancel = false;
	double last = 0.0;
	Progress progress;
	progress.cancel = &cancel;
	progress.report = [&](double fraction, std::uint64_t) {
		CHECK(fraction >= last);
		last = fraction;
		cancel = fraction > 0.3;
	};
	SurfaceSampler sampler;
	std::vector<SurfacePoint> points;
	CHECK(sampler.sample_all({.radius = 0.5}, *surface, points, progress).code == ErrorCode::cancelled);
	CHECK(points.empty());
	CHECK(last < 0.7);
}
