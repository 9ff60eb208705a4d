// Tests that an edit has no effect beyond its reach, and that a layer thins toward its edge.

#include "core/placement/edge_probes.hpp"
#include "core/placement/layer_edits.hpp"
#include "core/placement/tile_builder.hpp"
#include "core/terrain/flat_terrain.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

struct Standing {
	glm::dvec2 position;
	std::vector<float> transform;
	std::uint32_t rank = 0;

	friend bool operator==(const Standing &a, const Standing &b) {
		return a.transform == b.transform && a.rank == b.rank;
	}
};

std::map<std::uint64_t, Standing> standing_in(const LayerSettings &layer, const Terrain &terrain, const Rect &rect) {
	const TileInstances tile = built(layer, terrain, rect);
	const Transforms transforms = transforms_of(tile);
	std::map<std::uint64_t, Standing> result;
	for (const MeshInstances &mesh : tile.meshes) {
		for (std::size_t i = 0; i < mesh.size(); ++i) {
			const glm::dvec3 position = world_position(tile, mesh, i);
			result[mesh.ids[i]] = {{position.x, position.z}, transforms.at(mesh.ids[i]), mesh.ranks[i]};
		}
	}
	return result;
}

/// Returns the rectangle around all instances that differ between two states, or NAN if there are
/// none.
Rect changed_area(const std::map<std::uint64_t, Standing> &before, const std::map<std::uint64_t, Standing> &after) {
	Rect area{glm::dvec2(nothing), glm::dvec2(nothing)};
	const auto add_missing = [&area](const auto &from, const auto &other) {
		for (const auto &[id, standing] : from) {
			const auto match = other.find(id);
			if (match == other.end() || !(match->second == standing)) {
				const glm::dvec2 at = standing.position;
				area = std::isnan(area.min.x) ? Rect{at, at} : Rect{glm::min(area.min, at), glm::max(area.max, at)};
			}
		}
	};
	add_missing(before, after);
	add_missing(after, before);
	return area;
}

Shape cylinder(glm::dvec2 at, double radius, bool exclude) {
	Shape shape;
	shape.kind = ShapeKind::cylinder;
	shape.ignore_height = true;
	shape.exclude = exclude;
	shape.falloff = 2.0;
	shape.center = {at.x, 0.0, at.y};
	shape.half_size = {radius, 10.0, 0.0};
	return shape;
}

/// A layer with many kinds of rules that keeps a distance from a second layer.
struct World {
	std::shared_ptr<PaintedMask> mask = std::make_shared<PaintedMask>();
	std::vector<Shape> shapes{cylinder({-20.0, 40.0}, 15.0, true), cylinder({30.0, 90.0}, 9.0, true)};
	double oak_density = 0.8;

	World() { REQUIRE(mask->reset(0.5, 1.0).ok()); }

	LayerSettings layer() const {
		auto oaks = std::make_shared<LayerSettings>();
		oaks->set = {.seed = 1, .radius = 7.0, .levels = 1, .layer = 0};
		oaks->rules.density = oak_density;
		oaks->rules.mask = std::make_shared<PaintedMask>(*mask);
		LayerSettings result = rich_layer();
		result.rules.min_height = -unlimited_height;
		auto set = std::make_shared<ShapeSet>();
		REQUIRE(set->set(shapes).ok());
		result.rules.shapes = set;
		result.rules.edge_feather = 3.0;
		result.neighbors = {{oaks, 4.0, nullptr}};
		return result;
	}
};

bool within(const Rect &area, const Rect &limits) {
	constexpr double rounding = 1e-4; // Positions are stored as floats.
	return area.min.x >= limits.min.x - rounding && area.min.y >= limits.min.y - rounding &&
			area.max.x <= limits.max.x + rounding && area.max.y <= limits.max.y + rounding;
}

Rect around(const std::vector<Rect> &areas) {
	return std::accumulate(areas.begin() + 1, areas.end(), areas[0], united);
}

} // namespace

TEST_CASE("edits: an edit changes instances, all of them within its reach") {
	const Heightfield terrain = hills();
	std::mt19937_64 random(77);
	std::uniform_real_distribution<double> unit(0.0, 1.0);
	World world;
	LayerSettings layer = world.layer();
	CHECK(reach(layer) == 4.0);
	auto before = standing_in(layer, terrain, tile_of_hills);
	int changes = 0;
	for (int round = 0; round < 40; ++round) {
		Rect edited;
		const glm::dvec2 at(-60.0 + 120.0 * unit(random), 4.0 + 120.0 * unit(random));
		if (round % 2 == 0) {
			const auto mode = static_cast<Brush::Mode>(round / 2 % 3);
			REQUIRE(world.mask->paint({mode, at, 2.0 + 8.0 * unit(random), 1.0, 0.5}, edited).ok());
		} else {
			Shape &shape = world.shapes[static_cast<std::size_t>(round / 2 % 2)];
			edited = bounds(shape);
			shape = cylinder(at, 3.0 + 10.0 * unit(random), true);
			edited = united(edited, bounds(shape));
		}
		const LayerSettings next = world.layer();
		EditSearch search;
		const EditedArea &edits = search.find(layer, next);
		CHECK_FALSE(edits.everywhere);
		const auto after = standing_in(next, terrain, tile_of_hills);
		const Rect area = changed_area(before, after);
		if (!std::isnan(area.min.x)) {
			CHECK(within(area, {edited.min - reach(next), edited.max + reach(next)}));
			CHECK(within(area, around(edits.areas)));
			++changes;
		}
		before = after;
		layer = next;
	}
	CHECK(changes > 20);
	world.oak_density = 0.5;
	CHECK(EditSearch().find(layer, world.layer()).everywhere);
	LayerSettings sparser = layer;
	sparser.rules.density = 0.5;
	CHECK(EditSearch().find(layer, sparser).everywhere);
}

TEST_CASE("edits: an undone edit restores everything") {
	const Heightfield terrain = hills();
	World world;
	const auto before = standing_in(world.layer(), terrain, tile_of_hills);
	const Shape old = world.shapes[0];
	world.shapes[0] = cylinder({10.0, 20.0}, 12.0, true);
	std::vector<std::uint8_t> pixels;
	const PixelRect region = world.mask->pixels_of({{0.0, 40.0}, {40.0, 80.0}});
	REQUIRE(world.mask->read(region, pixels).ok());
	Rect changed_rect;
	REQUIRE(world.mask->paint({Brush::Mode::erase, {20.0, 60.0}, 15.0, 0.7, 0.3}, changed_rect).ok());
	CHECK(standing_in(world.layer(), terrain, tile_of_hills) != before);
	REQUIRE(world.mask->write(region, pixels, changed_rect).ok());
	world.shapes[0] = old;
	CHECK(standing_in(world.layer(), terrain, tile_of_hills) == before);
}

TEST_CASE("edits: shapes include and exclude the instances inside them") {
	LayerSettings layer;
	layer.set = {.seed = 4, .radius = 1.0, .levels = 1, .layer = 0};
	const FlatTerrain terrain(3.0f);
	const auto all = standing_in(layer, terrain, tile_of_hills);
	for (const bool exclude : {false, true}) {
		Shape shape = cylinder({5.0, 60.0}, 20.0, exclude);
		shape.falloff = 0.0;
		auto set = std::make_shared<ShapeSet>();
		REQUIRE(set->set({shape}).ok());
		LayerSettings shaped = layer;
		shaped.rules.shapes = set;
		const auto remaining = standing_in(shaped, terrain, tile_of_hills);
		for (const auto &[id, standing] : all) {
			const double distance = std::hypot(standing.position.x - 5.0, standing.position.y - 60.0);
			if (std::abs(distance - 20.0) > 1e-4) {
				CHECK(remaining.contains(id) == ((distance < 20.0) != exclude));
			}
		}
	}
}

TEST_CASE("edge feather: a layer thins toward the edge of its ground, and nowhere else") {
	LayerSettings layer;
	layer.set = {.seed = 4, .radius = 0.5, .levels = 1, .layer = 0};
	layer.rules.max_height = 10.0;
	// Ground that rises along +x. The height limit is reached at x = 10.
	class Ramp final : public Terrain {
	public:
		Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override {
			std::ranges::transform(positions, r_ground.begin(),
					[](glm::dvec2 at) { return Ground{static_cast<float>(at.x), {-1.0f, 1.0f, 0.0f}}; });
			return {};
		}
	};
	const Rect rect{{-20.0, -30.0}, {20.0, 30.0}};
	const auto hard = standing_in(layer, Ramp(), rect);
	layer.rules.edge_feather = 8.0;
	const auto soft = standing_in(layer, Ramp(), rect);
	std::vector<double> total(32, 0.0);
	std::vector<double> left(32, 0.0);
	for (const auto &[id, standing] : hard) {
		const auto meter = static_cast<std::size_t>(10.0 - standing.position.x);
		total[meter] += 1.0;
		left[meter] += soft.contains(id) ? 1.0 : 0.0;
	}
	for (std::size_t meter = 8; meter < 30; ++meter) {
		CHECK(left[meter] == total[meter]);
	}
	CHECK(left[0] / total[0] < 0.15);
	CHECK(left[3] / total[3] > 0.2);
	CHECK(left[3] / total[3] < 0.8);
	CHECK(left[6] / total[6] > left[2] / total[2]);
	CHECK(edge_density(edge_probes) == 1.0);
	CHECK(edge_density(edge_probes / 2) == 0.0);
	CHECK(edge_density(0) == 0.0);
}

TEST_CASE("edge feather: holes, masks and shapes are edges, too") {
	LayerSettings layer;
	layer.set = {.seed = 4, .radius = 0.5, .levels = 1, .layer = 0};
	layer.rules.edge_feather = 6.0;
	const FlatTerrain terrain(0.0f);
	const auto soft_near = [&](const Rules &rules, glm::dvec2 edge) {
		LayerSettings changed_layer = layer;
		changed_layer.rules = rules;
		changed_layer.rules.edge_feather = 0.0;
		const Rect strip{edge - 1.0, edge + 1.0};
		const auto hard = standing_in(changed_layer, terrain, strip);
		changed_layer.rules.edge_feather = layer.rules.edge_feather;
		return static_cast<double>(standing_in(changed_layer, terrain, strip).size()) /
				static_cast<double>(hard.size());
	};
	CHECK(soft_near(layer.rules, {20.0, 0.0}) == 1.0);
	Rules masked = layer.rules;
	auto mask = std::make_shared<PaintedMask>();
	REQUIRE(mask->reset(0.25, 1.0).ok());
	Rect changed_rect;
	REQUIRE(mask->paint({Brush::Mode::erase, {0.0, 0.0}, 20.0, 1.0, 1.0}, changed_rect).ok());
	masked.mask = mask;
	CHECK(soft_near(masked, {21.5, 0.0}) < 0.4);
	CHECK(soft_near(masked, {30.0, 0.0}) == 1.0);
	Rules shaped = layer.rules;
	auto shapes = std::make_shared<ShapeSet>();
	Shape hole = cylinder({0.0, 0.0}, 20.0, true);
	hole.falloff = 0.0;
	REQUIRE(shapes->set({hole}).ok());
	shaped.shapes = shapes;
	CHECK(soft_near(shaped, {21.5, 0.0}) < 0.4);
	CHECK(soft_near(shaped, {30.0, 0.0}) == 1.0);
}
