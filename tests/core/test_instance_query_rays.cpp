#include "core/query/instance_query.hpp"

#include "core/query/instance_ray.hpp"
#include "query_fixture.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cfenv>
#include <limits>
#include <optional>
#include <random>

using namespace thicket;
using namespace thicket::test;

namespace {

/// Returns the position along a ray, 0 to 1, at which it first touches a cylinder, or 2 if it does
/// not. The candidates are the start of the ray and its intersections with the caps and the lateral
/// surface. The result is the first of them that is in the cylinder, up to rounding.
double first_touch(const PlacedInstance &instance, const InstanceShape &shape, glm::dvec3 from, glm::dvec3 end) {
	const glm::dmat3 basis(instance.basis);
	if (std::abs(glm::determinant(basis)) < 1e-12) {
		return 2.0;
	}
	const glm::dmat3 inverse = glm::inverse(basis);
	const glm::dvec3 a = inverse * (from - instance.position);
	const glm::dvec3 d = inverse * (end - from);
	std::vector<double> fractions{0.0, -a.y / d.y, (shape.height - a.y) / d.y};
	const double p = d.x * d.x + d.z * d.z;
	const double q = a.x * d.x + a.z * d.z;
	const double root = std::sqrt(q * q - p * (a.x * a.x + a.z * a.z - shape.radius * shape.radius));
	fractions.push_back((-q - root) / p);
	double first = 2.0;
	for (const double fraction : fractions) {
		const glm::dvec3 at = a + fraction * d;
		const bool is_inside =
				at.y >= -1e-9 && at.y <= shape.height + 1e-9 && std::hypot(at.x, at.z) <= shape.radius + 1e-9;
		if (fraction >= 0.0 && fraction <= 1.0 && is_inside) {
			first = std::min(first, fraction);
		}
	}
	return first;
}

} // namespace

TEST_CASE("queries: a ray hits the first of all cylinders") {
	std::mt19937 random(5);
	for (const glm::dvec2 position : world_centers) {
		World warm;
		World cold;
		const std::vector<QueryLayer> layers = warm.query_layers();
		const Rect area{position - 160.0, position + 160.0};
		const InstanceState state = changed_state(everything_in(warm, area), position, random);
		const auto all = everything_in(warm, area, &state);
		const auto near_instances = matching(all, [&](const PlacedInstance &each) {
			return glm::length(glm::dvec2(each.position.x, each.position.z) - position) < 60.0;
		});
		int hits = 0;
		for (int repeat = 0; repeat < 90; ++repeat) {
			// Half of the rays pass close to an instance. Some are parallel to an axis.
			const glm::dvec3 mark = repeat % 2 == 0
					? near_instances[random() % near_instances.size()].position +
							glm::dvec3(0.0, between(random, -0.5, 2.0), 0.0)
					: glm::dvec3(position.x + between(random, -60.0, 60.0), between(random, -15.0, 20.0),
							  position.y + between(random, -60.0, 60.0));
			const double ray_length = std::exp(between(random, -3.0, 4.0));
			glm::dvec3 away(between(random, -1.0, 1.0), between(random, -0.1, 0.6), between(random, -1.0, 1.0));
			if (repeat % 5 == 0) {
				away = {};
				away[repeat / 5 % 3] = 1.0;
			}
			const glm::dvec3 from = mark + ray_length * away;
			const glm::dvec3 ray_end = mark - between(random, -0.1, 1.0) * ray_length * away;
			QueryFilter filter;
			if (repeat % 4 == 1) {
				filter.layers = {0};
			} else if (repeat % 4 == 2) {
				filter.layers = {2};
			}
			const bool picky = repeat % 3 == 0;
			if (picky) {
				filter.accepts = [](const PlacedInstance &each) {
					return each.id % 3 != 1;
				};
			}
			double first = 2.0;
			std::vector<std::uint64_t> first_ids;
			for (const PlacedInstance &each : all) {
				if ((filter.layers.empty() || each.layer == filter.layers[0]) && (!picky || each.id % 3 != 1)) {
					const double touch = first_touch(each, layers[each.layer].shape, from, ray_end);
					if (touch < first - 1e-9) {
						first_ids.clear();
					}
					if (touch <= 1.0 && touch < first + 1e-9) {
						first_ids.push_back(each.id);
					}
					first = std::min(first, touch);
				}
			}
			hits += first <= 1.0;
			for (World *world : {&warm, &cold}) {
				std::vector<RayHit> hit(2);
				REQUIRE(InstanceQuery{layers, *world, &state}.on_ray(from, ray_end, filter, hit).ok());
				REQUIRE(hit.size() == (first <= 1.0 ? 1 : 0));
				if (!hit.empty()) {
					CHECK(std::find(first_ids.begin(), first_ids.end(), hit[0].instance.id) != first_ids.end());
					CHECK(std::abs(hit[0].distance - first * glm::length(ray_end - from)) < 1e-6);
				}
			}
			cold.forget();
		}
		CHECK(hits > 12);
		CHECK(hits < 85);
	}
}

TEST_CASE("queries: a ray reads only the tiles before its first hit") {
	World world;
	const std::vector<QueryLayer> layers = world.query_layers();
	std::vector<RayHit> hit;
	const InstanceQuery query{layers, world, nullptr};
	const glm::dvec3 eye(3.0, 1.0, 5.0);
	REQUIRE(query.on_ray(eye, eye + glm::dvec3(3000.0, 0.0, 500.0), {{0, 1}, {}}, hit).ok());
	REQUIRE(hit.size() == 1);
	CHECK(hit[0].distance < 300.0);
	const std::size_t queried_tiles = world.requests.size();
	CHECK(queried_tiles < 150);
	// 30 m is the margin for the extent of instances beyond their tiles.
	for (const auto &[layer, x, y] : world.requests) {
		const Rect square = tile_rect(layers[layer].tile_size, {x, y});
		CHECK(std::sqrt(distance_squared(square, {eye.x, eye.z})) < hit[0].distance + 30.0);
	}
	world.requests.clear();
	// Tiles that the ray misses are not read.
	REQUIRE(query.on_ray({0.0, 500.0, 0.0}, {0.0, 400.0, 0.0}, {{0}, {}}, hit).ok());
	CHECK(hit.empty());
	CHECK(world.requests.size() == 4);
}

TEST_CASE("queries: a ray of length zero, or one that starts inside an instance, hits it at distance 0") {
	World world;
	const std::vector<QueryLayer> layers = world.query_layers();
	const InstanceQuery query{layers, world, nullptr};
	const auto all = everything_in(world, {{0.0, 0.0}, {60.0, 60.0}});
	const auto tree = std::find_if(all.begin(), all.end(), [](const PlacedInstance &each) { return each.layer == 0; });
	REQUIRE(tree != all.end());
	const glm::dvec3 inside = tree->position + glm::dmat3(tree->basis) * glm::dvec3(0.3, 11.0, -0.2);
	const glm::dvec3 above = tree->position + glm::dmat3(tree->basis) * glm::dvec3(0.3, 12.001, -0.2);
	for (const glm::dvec3 ray_end : {inside, inside + glm::dvec3(0.0, 30.0, 1.0)}) {
		std::vector<RayHit> hit;
		REQUIRE(query.on_ray(inside, ray_end, {{0}, {}}, hit).ok());
		REQUIRE(hit.size() == 1);
		CHECK(hit[0].instance.id == tree->id);
		CHECK(hit[0].distance == 0.0);
	}
	std::vector<RayHit> hit;
	REQUIRE(query.on_ray(above, above, {{0}, {}}, hit).ok());
	CHECK(hit.empty());
}

TEST_CASE("queries: a cylinder is closed, and its intersection with a ray is exact") {
	const InstanceShape shape{0.5, 2.0};
	const glm::dvec3 origin(10.0, 20.0, 30.0);
	const auto clipped = [&](glm::dvec3 from, glm::dvec3 to, const glm::mat3 &basis = glm::mat3(1.0f)) {
		return inside_cylinder({origin + from, to - from}, shape, origin, basis);
	};
	const RayPart horizontal = clipped({-2.0, 1.0, 0.0}, {2.0, 1.0, 0.0});
	CHECK(horizontal.start == 0.375);
	CHECK(horizontal.end == 0.625);
	const RayPart downward = clipped({0.0, 4.0, 0.0}, {0.0, -4.0, 0.0});
	CHECK(downward.start == 0.25);
	CHECK(downward.end == 0.5);
	// Rays on the lateral surface and on the edges of the caps, and just outside.
	CHECK(!clipped({-2.0, 1.0, 0.5}, {2.0, 1.0, 0.5}).empty());
	CHECK(!clipped({-2.0, 2.0, 0.0}, {2.0, 2.0, 0.0}).empty());
	CHECK(!clipped({0.5, 3.0, 0.0}, {0.5, -3.0, 0.0}).empty());
	CHECK(clipped({-2.0, 1.0, 0.500001}, {2.0, 1.0, 0.500001}).empty());
	CHECK(clipped({-2.0, 2.000001, 0.0}, {2.0, 2.000001, 0.0}).empty());
	CHECK(clipped({0.500001, 3.0, 0.0}, {0.500001, -3.0, 0.0}).empty());
	CHECK(clipped({-2.0, 1.0, 0.0}, {-0.500001, 1.0, 0.0}).empty());
	// A cylinder that lies on its side, one that is ten times as large, and a flat one.
	const glm::mat3 lying(glm::vec3(0.0f, -1.0f, 0.0f), glm::vec3(1.0f, 0.0f, 0.0f), glm::vec3(0.0f, 0.0f, 1.0f));
	CHECK(clipped({1.0, 4.0, 0.0}, {1.0, -4.0, 0.0}, lying).start == 0.4375);
	CHECK(clipped({-20.0, 15.0, 0.0}, {20.0, 15.0, 0.0}, glm::mat3(10.0f)).start == 0.375);
	CHECK(clipped({-2.0, 1.0, 0.0}, {2.0, 1.0, 0.0}, glm::mat3(0.0f)).empty());
	// From 1,000 km away, the result is as exact as the coordinates.
	CHECK(clipped({-1e6, 1.0, 0.4999}, {1e6, 1.0, 0.4999}).start < 0.5);
	CHECK(clipped({-1e6, 1.0, 0.5001}, {1e6, 1.0, 0.5001}).empty());
}

TEST_CASE("queries: in a wide world, a ray reads only the tiles along its way") {
	World world;
	world.makes = false;
	const std::vector<QueryLayer> layers = world.query_layers();
	std::vector<RayHit> hit;
	REQUIRE(InstanceQuery{layers, world, nullptr}.on_ray({5.0, 0.0, 5.0}, {6400.0, 0.0, 6390.0}, {{0}, {}}, hit).ok());
	CHECK(hit.empty());
	CHECK(world.requests.size() > 190); // Includes the tiles that the ray barely misses.
	CHECK(world.requests.size() < 320);
}

TEST_CASE("queries: a ray tests only the cylinders of instances near it") {
	// Intersecting an infinite cylinder would set the processor's floating-point flags.
	class OneTile final : public TileSource {
	public:
		Status find_tile(const WorldTile &, std::shared_ptr<const CompactTile> &r_tile) override {
			r_tile = tile;
			return {};
		}
		std::shared_ptr<const CompactTile> tile;
	};
	const auto tile_with = [](glm::vec3 position) {
		MeshInstances mesh;
		mesh.resize(1);
		constexpr float endless = std::numeric_limits<float>::infinity();
		std::ranges::copy(std::array{endless, 0.0f, 0.0f, position.x, 0.0f, endless, 0.0f, position.y, 0.0f, 0.0f,
								  endless, position.z},
				mesh.floats_of(0).begin());
		mesh.max_scale = 1.0f;
		mesh.min = glm::vec3(0.0f);
		mesh.max = glm::vec3(60.0f);
		TileInstances tile;
		tile.meshes.push_back(mesh);
		return std::make_shared<const CompactTile>(tile, std::shared_ptr<const LayerSettings>());
	};
	OneTile source;
	const std::vector<QueryLayer> layers{world_layers().front().query_layer};
	std::vector<RayHit> hit;
	const auto meets = [&](glm::vec3 position) {
		source.tile = tile_with(position);
		std::feclearexcept(FE_INVALID);
		REQUIRE(InstanceQuery{layers, source, nullptr}.on_ray({1.0, 1.0, 1.0}, {60.0, 1.0, 1.0}, {}, hit).ok());
		return std::fetestexcept(FE_INVALID) != 0;
	};
	CHECK(meets({20.0f, 0.0f, 5.0f}));
	CHECK_FALSE(meets({20.0f, 0.0f, 55.0f}));
}
