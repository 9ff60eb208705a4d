// Tests that sampling, rules and tiles return an error that names the invalid property, and keep
// their previous state, whichever allocation fails.

#include "core/rules/image_mask.hpp"
#include "core/rules/shape_edits.hpp"
#include "core/sampling/tile_sampler.hpp"
#include "core/terrain/triangle_terrain.hpp"
#include "mask_fixture.hpp"
#include "short_of_memory.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <memory>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

/// An object whose method is called, and the result of the call.
template <typename Tool, typename Answer>
struct Job {
	Tool tool;
	Answer answer;
};

constexpr auto anything = [](const auto &) {
};

/// Returns one shape for each way in which shapes are evaluated.
std::vector<Shape> some_shapes() {
	Shape ball;
	ball.kind = ShapeKind::sphere;
	ball.half_size.x = 60.0;
	ball.falloff = 2.0;
	Shape road;
	road.kind = ShapeKind::path;
	road.exclude = true;
	road.half_size.x = 3.0;
	for (int i = 0; i < 100; ++i) {
		road.outline.push_back({i, 0.1 * i});
	}
	Shape field;
	field.kind = ShapeKind::polygon;
	field.outline = {{-40.0, -40.0}, {40.0, -30.0}, {0.0, 60.0}};
	return {ball, road, field};
}

std::shared_ptr<const ShapeSet> some_shape_set() {
	auto set = std::make_shared<ShapeSet>();
	REQUIRE(set->set(some_shapes()).ok());
	return set;
}

/// Returns a layer with many kinds of rules: curves, textures, a mask, shapes, an edge feather, and
/// neighbors that have neighbors. Its sources are noise and another layer.
LayerSettings layer_with_many_rules() {
	auto curve = std::make_shared<CurveTable>();
	REQUIRE(curve->set(0.0, 90.0, std::vector<float>{1.0f, 0.5f, 0.9f}).ok());
	LayerSettings stones = rich_layer();
	stones.set = {.seed = 3, .radius = 6.0, .layer = 1};
	LayerSettings bushes = rich_layer();
	bushes.set = {.seed = 4, .radius = 4.0, .layer = 2};
	bushes.neighbors = {{std::make_shared<LayerSettings>(stones), 3.0, nullptr}};
	LayerSettings layer = rich_layer();
	layer.set.radius = 1.2;
	layer.rules.height_curve = curve;
	layer.rules.slope_curve = curve;
	layer.rules.fields = {std::make_shared<PaintedMask>(noisy_mask(1.0, 3))};
	layer.rules.ground_textures = {0, 2};
	layer.rules.edge_feather = 2.0;
	layer.rules.mask = std::make_shared<PaintedMask>(noisy_mask(1.0, 5));
	layer.rules.shapes = some_shape_set();
	layer.neighbors = {{std::make_shared<LayerSettings>(bushes), 5.0, curve},
			{std::make_shared<LayerSettings>(stones), 4.0, nullptr}};
	layer.instance_data.use_colors = true;
	layer.instance_data.colors = std::make_shared<const ColorTable>(5, glm::vec4(1.0f));
	layer.instance_data.color.kind = SourceKind::distance;
	layer.instance_data.color.max = 7.0;
	layer.mesh_rules = {open_rules(), std::nullopt, open_rules()};
	layer.mesh_rules[0]->fields = {std::make_shared<PaintedMask>(noisy_mask(1.0, 9))};
	layer.instance_data.color.layer = std::make_shared<LayerSettings>(stones);
	layer.instance_data.use_custom_data = true;
	layer.instance_data.variation.kind = SourceKind::noise;
	layer.instance_data.variation.noise = layer.rules.fields[0];
	return layer;
}

constexpr Rect small_tile{{-20.0, 0.0}, {20.0, 40.0}};

} // namespace

TEST_CASE("out of memory: sampling a window leaves no points and a usable sampler") {
	for (const std::uint32_t levels : {1u, 3u}) {
		const PointSet set{.seed = 5, .radius = 1.0, .levels = levels};
		const Rect window{{-30.0, 10.0}, {10.0, 30.0}};
		std::vector<SamplePoint> expected;
		REQUIRE(TileSampler().sample(set, window, expected).ok());
		using Sampling = Job<TileSampler, std::vector<SamplePoint>>;
		for (const bool is_used : {false, true}) {
			fail_every_request(
					"rect",
					[&] {
						Sampling job;
						if (is_used) { // The sampler has sampled a smaller window, so all its buffers must grow.
							REQUIRE(job.tool.sample(PointSet{.seed = 9}, {{0.0, 0.0}, {3.0, 1.0}}, job.answer).ok());
						}
						return job;
					},
					[&](Sampling &job) { return job.tool.sample(set, window, job.answer); },
					[](const Sampling &job) { REQUIRE(job.answer.empty()); },
					[&](const Sampling &job) { REQUIRE(job.answer == expected); });
		}
	}
}

TEST_CASE("out of memory: after a failure, a sampler accepts any window, larger or smaller") {
	const PointSet set{.seed = 5, .radius = 1.0, .levels = 2};
	std::mt19937 random(7);
	TileSampler used;
	std::vector<SamplePoint> points;
	std::vector<SamplePoint> expected;
	for (int i = 0; i < 200; ++i) {
		const glm::dvec2 corner(random() % 1000, random() % 1000);
		const Rect window{corner, corner + glm::dvec2(1 + random() % (1 + i), 1 + random() % 60)};
		const std::size_t allowed = random() % 12;
		{
			const AllocationLimit limit(allowed);
			static_cast<void>(used.sample(set, window, points));
		}
		const Rect other{corner, corner + glm::dvec2(1 + random() % (1 + i), 1 + random() % 60)};
		REQUIRE(used.sample(set, other, points).ok());
		REQUIRE(TileSampler().sample(set, other, expected).ok());
		REQUIRE(points == expected);
	}
}

TEST_CASE("out of memory: rules that cannot be set leave the previous ones") {
	Rules before;
	before.density = 0.5;
	before.ground_textures = {7};
	const Rules after = layer_with_many_rules().rules;
	using Taking = Job<PreparedRules, std::vector<float>>;
	fail_every_request(
			"rules",
			[&] {
				Taking job;
				REQUIRE(job.tool.set(before, 1).ok());
				return job;
			},
			[&](Taking &job) { return job.tool.set(after, 2); },
			[&](const Taking &job) { REQUIRE(job.tool.rules() == before); },
			[&](const Taking &job) { REQUIRE(job.tool.rules() == after); });

	const std::vector<glm::dvec2> positions(50, glm::dvec2(3.0, 4.0));
	std::vector<double> densities(50);
	fail_every_request(
			"positions",
			[&] {
				Taking job;
				REQUIRE(job.tool.set(after, 2).ok());
				return job;
			},
			[&](Taking &job) { return job.tool.position_densities({positions}, densities, job.answer); }, anything,
			[&](const Taking &) { REQUIRE(densities == std::vector<double>(50, densities[0])); });
}

TEST_CASE("out of memory: tables, masks and shapes stay unchanged") {
	const std::vector<float> samples{0.25f, 0.5f, 0.75f};
	fail_every_request(
			"samples", [] { return CurveTable(); }, [&](CurveTable &table) { return table.set(0.0, 1.0, samples); },
			[](const CurveTable &table) { REQUIRE(table == CurveTable()); },
			[](const CurveTable &table) { REQUIRE(table.at(0.5) == 0.5); });

	const std::vector<std::uint8_t> pixels{0, 64, 128, 255};
	const Rect area{{0.0, 0.0}, {2.0, 2.0}};
	fail_every_request(
			"pixels", [] { return ImageMask(); },
			[&](ImageMask &mask) { return mask.set({2, 2}, pixels, area, MaskEdge::clamp); },
			[](const ImageMask &mask) { REQUIRE(mask == ImageMask()); },
			[](const ImageMask &mask) { REQUIRE(density(mask, {0.0, 0.0}) == 0.0f); });

	const std::vector<Shape> shapes = some_shapes();
	const auto near_all = [](const ShapeSet &set) {
		std::vector<std::uint32_t> near_shapes;
		REQUIRE(set.find_nearby({{-99.0, -99.0}, {99.0, 99.0}}, near_shapes).ok());
		return near_shapes.size();
	};
	using Shaping = Job<ShapeSet, std::vector<Shape>>;
	fail_every_request(
			"shapes",
			[&] {
				return Shaping{{}, shapes}; // `set` takes the shapes by value, so each job has a copy.
			},
			[](Shaping &job) { return job.tool.set(std::move(job.answer)); },
			[&](Shaping &job) {
				REQUIRE(job.tool.empty());
				job.answer = shapes;
			},
			[&](const Shaping &job) { REQUIRE(near_all(job.tool) == 3); });

	const std::shared_ptr<const ShapeSet> set = some_shape_set();
	using Near = Job<const ShapeSet *, std::vector<std::uint32_t>>;
	fail_every_request(
			"shapes", [&] { return Near{set.get(), {}}; },
			[&](Near &job) { return job.tool->find_nearby({{-99.0, -99.0}, {99.0, 99.0}}, job.answer); },
			[](const Near &job) { REQUIRE(job.answer.empty()); },
			[](const Near &job) { REQUIRE(job.answer.size() == 3); });
}

TEST_CASE("out of memory: shapes near an area are returned completely or not at all") {
	const std::vector<Shape> shapes = some_shapes();
	const std::vector<Rect> known_rects{small_tile};
	using Areas = std::vector<Rect>;
	fail_every_request(
			"shapes", [&] { return Areas(known_rects); }, [&](Areas &areas) { return add_touched(shapes[1], areas); },
			[](const Areas &areas) { REQUIRE(areas.size() == 1); },
			[](const Areas &areas) { REQUIRE(areas.size() == 1 + 50); });

	const std::shared_ptr<const ShapeSet> before = some_shape_set();
	ShapeSet after;
	REQUIRE(after.set({shapes[0], shapes[2]}).ok());
	for (std::size_t allowed = 0, done = 0; done == 0; ++allowed) {
		Areas areas(known_rects);
		const AllocationLimit limit(allowed);
		const bool reported = find_shape_edits(before.get(), &after, areas);
		done = limit.reached() ? 0 : 1;
		REQUIRE(areas.size() == (reported ? 1 + 50 : 1));
	}
}

TEST_CASE("out of memory: terrains stay unchanged") {
	const HeightfieldFrame frame{{2, 2}, {{0.0, 0.0}, {1.0, 1.0}}, 0.0, 65535.0};
	const std::vector<std::uint16_t> posts{10, 10, 10, 10};
	const std::vector<float> meters(4, 20.0f);
	const auto prepare = [&] {
		Heightfield field;
		REQUIRE(field.set(frame, posts).ok());
		return field;
	};
	const auto height_is = [](float height) {
		return [height](const Terrain &terrain) {
			REQUIRE(terrain.at({0.5, 0.5}).height == height);
		};
	};
	fail_every_request(
			"posts", prepare, [&](Heightfield &field) { return field.set_meters(frame, meters); }, height_is(10.0f),
			height_is(20.0f));
	const std::vector<std::uint16_t> higher(4, 30);
	fail_every_request(
			"posts", prepare, [&](Heightfield &field) { return field.set(frame, higher); }, height_is(10.0f),
			height_is(30.0f));
	const std::vector<std::uint8_t> weights(8, 255);
	fail_every_request(
			"weights", [] { return WeightMap(); }, [&](WeightMap &map) { return map.set({2, 2}, 2, weights); },
			[](const WeightMap &map) { REQUIRE(map.empty()); },
			[](const WeightMap &map) { REQUIRE(map.weight({0.5, 0.5}, 1u) == 1.0f); });
	const std::vector<glm::dvec3> corners{{0.0, 5.0, 0.0}, {9.0, 5.0, 0.0}, {0.0, 5.0, 9.0}};
	fail_every_request(
			"corners", [] { return TriangleTerrain(); }, [&](TriangleTerrain &terrain) { return terrain.set(corners); },
			[](const TriangleTerrain &terrain) { REQUIRE(terrain.area().empty()); }, height_is(5.0f));
}

TEST_CASE("out of memory: painting changes a mask completely or not at all") {
	const PaintedMask before = noisy_mask(1.0, 11);
	Brush brush;
	brush.radius = 80.0; // The dab covers several blocks.
	using Painting = Job<PaintedMask, std::vector<std::uint8_t>>;
	const auto prepare = [&] {
		return Painting{before, {1, 2, 3}};
	};
	const auto unchanged = [&](const Painting &job) {
		REQUIRE(job.tool == before);
		REQUIRE(job.answer == std::vector<std::uint8_t>{1, 2, 3});
	};
	for (const Brush::Mode mode : {Brush::Mode::paint, Brush::Mode::erase, Brush::Mode::smooth}) {
		brush.mode = mode;
		PaintedMask expected = before;
		Rect changed_rect;
		REQUIRE(expected.paint(brush, changed_rect).ok());
		fail_every_request(
				"radius", prepare, [&](Painting &job) { return job.tool.paint(brush, changed_rect); }, unchanged,
				[&](const Painting &job) { REQUIRE(job.tool == expected); });
	}
	const PixelRect region{{-70, -70}, {70, 70}};
	const std::vector<std::uint8_t> pixels(140 * 140, 200);
	Rect changed_rect;
	fail_every_request(
			"region", prepare, [&](Painting &job) { return job.tool.write(region, pixels, changed_rect); }, unchanged,
			[&](const Painting &job) { REQUIRE(read(job.tool, region) == pixels); });
	fail_every_request(
			"region", prepare, [&](Painting &job) { return job.tool.read(region, job.answer); }, unchanged,
			[&](const Painting &job) { REQUIRE(job.answer == read(before, region)); });
	const std::vector<std::uint8_t> bytes = noisy_mask(2.0, 12).to_bytes();
	fail_every_request(
			"data", prepare, [&](Painting &job) { return job.tool.from_bytes(bytes); }, unchanged,
			[&](const Painting &job) { REQUIRE(job.tool.to_bytes() == bytes); });
}

TEST_CASE("out of memory: the previous tile stays unchanged") {
	const Heightfield terrain = hills();
	const LayerSettings layer = layer_with_many_rules();
	const TileInstances expected = built(layer, terrain, small_tile);
	LayerSettings other = rich_layer();
	other.mesh_weights = {1.0f};
	const TileInstances before = built(other, terrain, {{0.0, 0.0}, {9.0, 9.0}});
	REQUIRE(size_of(expected) > 5);
	REQUIRE(size_of(before) > 2);
	using Building = Job<TileBuilder, TileInstances>;
	std::string refused;
	std::size_t failures = 0;
	for (const auto fails : {AllocationLimit::Fails::all_later, AllocationLimit::Fails::one}) {
		bool reached = true;
		for (std::size_t allowed = 0; reached; ++allowed) {
			CAPTURE(allowed);
			Building job{TileBuilder(), before};
			Status status;
			{
				const AllocationLimit limit(allowed, fails);
				status = job.tool.build(layer, terrain, small_tile, job.answer);
				reached = limit.reached();
			}
			if (!status.ok()) {
				++failures;
				REQUIRE(status.code == ErrorCode::out_of_memory);
				refused = status.property;
				REQUIRE((refused == "rect" || refused == "positions" || refused == "tile" || refused == "ground"));
				REQUIRE(digest(job.answer) == digest(before));
				REQUIRE(job.answer.counts.placed == before.counts.placed);
				REQUIRE(job.tool.build(layer, terrain, small_tile, job.answer).ok());
			}
			REQUIRE(digest(job.answer) == digest(expected));
		}
	}
	CHECK(failures > 50);
}

TEST_CASE("out of memory: a tile in two steps continues from the points that were found") {
	const Heightfield terrain = hills();
	const LayerSettings layer = layer_with_many_rules();
	const TileInstances expected = built(layer, terrain, small_tile);
	const TileInstances before = built(rich_layer(), terrain, {{0.0, 0.0}, {9.0, 9.0}});
	using Building = Job<TileBuilder, TileInstances>;
	std::vector<Ground> ground;
	fail_every_request(
			"tile",
			[&] {
				Building job{TileBuilder(), before};
				REQUIRE(job.tool.find_points(layer, small_tile).ok());
				ground.assign(job.tool.positions().size(), Ground{});
				for (const GroundQuery &query : job.tool.queries()) {
					const auto positions = job.tool.positions().subspan(query.first, query.count);
					const auto grounds = std::span(ground).subspan(query.first, query.count);
					REQUIRE(terrain.query(positions, query.needs, grounds).ok());
				}
				return job;
			},
			[&](Building &job) { return job.tool.place(ground, job.answer); },
			[&](const Building &job) { REQUIRE(digest(job.answer) == digest(before)); },
			[&](const Building &job) { REQUIRE(digest(job.answer) == digest(expected)); });
}
