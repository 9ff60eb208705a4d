// Tests that every rule only removes points, and does so independently of tile size and order.

#include "core/explain/position_explainer.hpp"
#include "core/placement/tile_builder.hpp"
#include "core/rules/image_mask.hpp"
#include "core/terrain/heightfield.hpp"
#include "tests/analysis/curve_table.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

/// Hills whose texture 1 has a weight that increases from 0 to 1 along +x.
class TexturedHills final : public Terrain {
public:
	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override {
		return hills_.sample(positions, r_ground);
	}

	Status weigh(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
			std::span<Ground> r_ground) const override {
		const bool requested = std::find(textures.begin(), textures.end(), 1) != textures.end();
		for (std::size_t i = 0; i < positions.size(); ++i) {
			r_ground[i].weight = requested ? static_cast<float>((positions[i].x + 64.0) / 128.0) : 0.0f;
		}
		return {};
	}

private:
	Heightfield hills_ = hills();
};

std::shared_ptr<const ShapeSet> shape_set(ShapeKind kind, bool exclude) {
	Shape shape;
	shape.kind = kind;
	shape.exclude = exclude;
	shape.falloff = 6.0;
	shape.center = {-10.0, 45.0, 60.0};
	shape.half_size = {25.0, 60.0, 30.0};
	shape.outline = {{-60.0, 10.0}, {40.0, 20.0}, {20.0, 100.0}, {-50.0, 80.0}};
	auto set = std::make_shared<ShapeSet>();
	REQUIRE(set->set({shape}).ok());
	return set;
}

std::shared_ptr<const LayerSettings> trees() {
	auto layer = std::make_shared<LayerSettings>();
	layer->set = {.seed = 99, .radius = 6.0, .levels = 1, .layer = 4};
	layer->rules.max_slope_degrees = 60.0;
	return layer;
}

/// Returns a map with two biomes and a gap, with soft borders that noise displaces.
std::shared_ptr<const BiomeMap> biome_map() {
	const std::array<std::uint8_t, 6> pixels{0, 1, no_biome, 1, 1, 0};
	auto map = std::make_shared<BiomeMap>();
	REQUIRE(map->set({3, 2}, pixels, {{-60.0, 10.0}, {60.0, 110.0}}, BiomeEdge::clamp, {9.0, 12.0, 25.0, 5}).ok());
	return map;
}

std::shared_ptr<const BiomeDensity> biome_density() {
	PerBiome<float> densities{};
	densities[0] = 0.3F;
	densities[1] = 1.0F;
	return std::make_shared<BiomeDensity>(biome_map(), densities);
}

/// A density that depends on everything that a density rule receives. Closed for x below -50.
class MixedRule final : public DensityRule {
public:
	bool is_thread_safe() const override { return true; }
	Status sample(const DensityBatch &batch, std::span<float> r_densities) const override {
		for (std::size_t i = 0; i < r_densities.size(); ++i) {
			const double wave = 0.5 + 0.5 * batch.positions[i].y / (1.0 + std::abs(batch.positions[i].y));
			r_densities[i] = batch.positions[i].x < -50.0 ? 0.0f
														  : static_cast<float>(wave) * batch.normals[i].y *
							batch.weights[i] / (1.0f + batch.slopes[i] / 90.0f);
		}
		return {};
	}
	Status find_closed(const Box3 &box, bool &r_closed) const override {
		r_closed = box.max.x < -50.0;
		return {};
	}
};

struct NamedRule {
	std::string name;
	std::function<void(LayerSettings &)> add;
};

const std::vector<NamedRule> every_rule{
		{"density", [](LayerSettings &layer) { layer.rules.density = 0.4; }},
		{"slope range", [](LayerSettings &layer) { layer.rules.min_slope_degrees = 25.0; }},
		{"slope falloff",
				[](LayerSettings &layer) {
					layer.rules.max_slope_degrees = 60.0;
					layer.rules.slope_falloff_degrees = 30.0;
				}},
		{"height range", [](LayerSettings &layer) { layer.rules.min_height = 35.0; }},
		{"height falloff",
				[](LayerSettings &layer) {
					layer.rules.max_height = 60.0;
					layer.rules.height_falloff = 25.0;
				}},
		{"density over height",
				[](LayerSettings &layer) {
					layer.rules.height_curve = analysis::curve_table(0.0, 90.0, {0.1f, 1.0f, 0.3f});
				}},
		{"density over slope",
				[](LayerSettings &layer) { layer.rules.slope_curve = analysis::curve_table(0.0, 90.0, {1.0f, 0.2f}); }},
		{"expression",
				[](LayerSettings &layer) {
					ExpressionError error;
					layer.rules.water = std::make_shared<WaterLevels>(20.0);
					layer.rules.expression =
							DensityExpression::compile("smoothstep(80, 30, height) * (slope < 40) * (noise(30) > 0.3) "
													   "- 0.01 * abs(x) * (water_depth > 0)",
									error);
					REQUIRE(layer.rules.expression != nullptr);
				}},
		{"field",
				[](LayerSettings &layer) {
					auto image = std::make_shared<ImageMask>();
					const std::array<std::uint8_t, 6> pixels{255, 0, 128, 60, 255, 10};
					REQUIRE(image->set({3, 2}, pixels, {{-50.0, 10.0}, {-20.0, 40.0}}, MaskEdge::repeat).ok());
					layer.rules.fields = {image};
				}},
		{"mask",
				[](LayerSettings &layer) {
					auto mask = std::make_shared<PaintedMask>();
					Rect changed_rect;
					REQUIRE(mask->reset(0.7, 1.0).ok());
					REQUIRE(mask->paint({Brush::Mode::erase, {-5.0, 66.0}, 28.0, 0.8, 0.2}, changed_rect).ok());
					layer.rules.mask = mask;
				}},
		{"clumps", [](LayerSettings &layer) { layer.rules.clumping = {18.0, 0.5, 0.4}; }},
		{"biome", [](LayerSettings &layer) { layer.rules.biome = biome_density(); }},
		{"water depth",
				[](LayerSettings &layer) {
					layer.rules.water = std::make_shared<WaterLevels>(55.0);
					layer.rules.min_water_depth = -30.0;
					layer.rules.max_water_depth = 10.0;
					layer.rules.water_depth_falloff = 8.0;
				}},
		{"water of biomes",
				[](LayerSettings &layer) {
					PerBiome<double> levels{};
					levels.fill(no_water);
					levels[1] = 60.0;
					layer.rules.water = std::make_shared<WaterLevels>(biome_map(), levels);
				}},
		{"density rules",
				[](LayerSettings &layer) {
					layer.rules.density_rules = {std::make_shared<MixedRule>(), std::make_shared<MixedRule>()};
				}},
		{"density rules, textures and edge",
				[](LayerSettings &layer) {
					layer.rules.density_rules = {std::make_shared<MixedRule>()};
					layer.rules.ground_textures = {1};
					layer.rules.edge_feather = 5.0;
				}},
		{"ground textures", [](LayerSettings &layer) { layer.rules.ground_textures = {1}; }},
		{"edge feather",
				[](LayerSettings &layer) {
					layer.rules.max_slope_degrees = 70.0;
					layer.rules.edge_feather = 5.0;
				}},
		{"box", [](LayerSettings &layer) { layer.rules.shapes = shape_set(ShapeKind::box, false); }},
		{"sphere", [](LayerSettings &layer) { layer.rules.shapes = shape_set(ShapeKind::sphere, true); }},
		{"cylinder", [](LayerSettings &layer) { layer.rules.shapes = shape_set(ShapeKind::cylinder, false); }},
		{"polygon", [](LayerSettings &layer) { layer.rules.shapes = shape_set(ShapeKind::polygon, true); }},
		{"path", [](LayerSettings &layer) { layer.rules.shapes = shape_set(ShapeKind::path, true); }},
		{"spacing", [](LayerSettings &layer) { layer.neighbors = {{trees(), 3.0, nullptr}}; }},
		{"proximity",
				[](LayerSettings &layer) {
					layer.neighbors = {{trees(), 6.0, analysis::curve_table(0.0, 6.0, {1.0f, 0.0f})}};
				}},
};

LayerSettings plain_layer() {
	LayerSettings layer;
	layer.set = {.seed = 99, .radius = 1.5, .levels = 2, .layer = 3};
	layer.placement.align_to_normal = 0.7;
	layer.placement.min_scale = 0.5;
	return layer;
}

/// Returns the world position of each instance, rounded to 1 mm, and its thinning rank. They are
/// the same for any tile size, except for rounding.
std::map<std::uint64_t, std::pair<glm::ivec3, std::uint32_t>> instance_positions(
		const LayerSettings &layer, const Terrain &terrain, const Rect &rect) {
	const TileInstances tile = built(layer, terrain, rect);
	std::map<std::uint64_t, std::pair<glm::ivec3, std::uint32_t>> result;
	for (const MeshInstances &mesh : tile.meshes) {
		for (std::size_t i = 0; i < mesh.size(); ++i) {
			const glm::dvec3 position = world_position(tile, mesh, i);
			result[mesh.ids[i]] = {glm::ivec3(glm::floor(position * 1e3 + 0.5)), mesh.ranks[i]};
		}
	}
	return result;
}

bool near(const std::pair<glm::ivec3, std::uint32_t> &a, const std::pair<glm::ivec3, std::uint32_t> &b) {
	const glm::ivec3 offset = glm::abs(a.first - b.first);
	return std::max({offset.x, offset.y, offset.z}) <= 1 && a.second == b.second;
}

/// Returns the ground that a probe or an explainer queries.
std::vector<Ground> ground_for(const auto &asker, const Terrain &terrain) {
	std::vector<Ground> ground(asker.positions().size());
	REQUIRE(query_ground(terrain, asker.positions(), asker.queries(), ground).ok());
	return ground;
}

std::vector<SamplePoint> points_of(const PointSet &set, const Rect &rect) {
	TileSampler sampler;
	std::vector<SamplePoint> points;
	REQUIRE(sampler.sample(set, rect, points).ok());
	return points;
}

/// Returns the thinning ranks of all instances, by ID.
std::map<std::uint64_t, std::uint32_t> ranks_of(const TileInstances &tile) {
	std::map<std::uint64_t, std::uint32_t> ranks;
	for (const MeshInstances &mesh : tile.meshes) {
		for (std::size_t i = 0; i < mesh.size(); ++i) {
			ranks[mesh.ids[i]] = mesh.ranks[i];
		}
	}
	return ranks;
}

/// Returns a layer with all the rules that have these names.
LayerSettings layer_with_rules(std::span<const char *const> names) {
	LayerSettings layer = plain_layer();
	for (const NamedRule &rule : every_rule) {
		if (std::ranges::find(names, rule.name) != names.end()) {
			rule.add(layer);
		}
	}
	return layer;
}

/// Checks every point of the set in tile_of_hills: the product of its factors must be the density
/// with which the tile was generated. If the point has no instance, a factor must explain its
/// absence. Returns the number of points without an instance.
std::size_t check_factors(const LayerSettings &layer, const Terrain &terrain) {
	const auto standing_ranks = ranks_of(built(layer, terrain, tile_of_hills));
	const std::vector<SamplePoint> points = points_of(layer.set, tile_of_hills);
	std::vector<glm::dvec2> instance_positions;
	for (const SamplePoint &point : points) {
		instance_positions.push_back(point.position);
	}
	DensityProbe probe;
	REQUIRE(probe.find(layer, instance_positions).ok());
	REQUIRE(probe.evaluate(ground_for(probe, terrain)).ok());
	std::vector<RuleFactor> factors;
	std::size_t removed_count = 0;
	for (std::size_t i = 0; i < points.size(); ++i) {
		REQUIRE(probe.factors_at(i, factors).ok());
		const double density = product_of(factors);
		REQUIRE(density == probe.density_at(i));
		const auto match = standing_ranks.find(points[i].id);
		REQUIRE(is_placed(points[i].rank, density) == (match != standing_ranks.end()));
		if (match != standing_ranks.end()) {
			REQUIRE(thinning_rank(points[i].rank, density) == match->second);
			continue;
		}
		++removed_count;
		const RuleFactor *strictest_factor = strictest(factors);
		REQUIRE(strictest_factor != nullptr);
		REQUIRE((density > 0.0 || strictest_factor->density <= 0.0));
	}
	return removed_count;
}

} // namespace

TEST_CASE("every rule: removes points, and the remaining ones are bit-identical") {
	const TexturedHills terrain;
	const LayerSettings open = plain_layer();
	const Transforms all = transforms_of(built(open, terrain, tile_of_hills));
	for (const NamedRule &rule : every_rule) {
		CAPTURE(rule.name);
		LayerSettings ruled = open;
		rule.add(ruled);
		const Transforms filtered = transforms_of(built(ruled, terrain, tile_of_hills));
		check_filtered(all, filtered);
	}
}

TEST_CASE("every rule: tiles of any size, strips and negative tiles together equal one large tile") {
	const TexturedHills terrain;
	const std::array<glm::dvec2, 3> sizes{glm::dvec2(128.0, 11.0), glm::dvec2(23.5, 40.0), glm::dvec2(64.0, 64.0)};
	for (const NamedRule &rule : every_rule) {
		CAPTURE(rule.name);
		LayerSettings layer = plain_layer();
		rule.add(layer);
		const auto whole_tile = instance_positions(layer, terrain, tile_of_hills);
		for (const glm::dvec2 size : sizes) {
			std::size_t count = 0;
			for (double y = tile_of_hills.max.y; y > tile_of_hills.min.y; y -= size.y) {
				for (double x = tile_of_hills.min.x; x < tile_of_hills.max.x; x += size.x) {
					const Rect slice{{x, std::max(y - size.y, tile_of_hills.min.y)},
							{std::min(x + size.x, tile_of_hills.max.x), y}};
					for (const auto &[id, position] : instance_positions(layer, terrain, slice)) {
						const auto match = whole_tile.find(id);
						REQUIRE(match != whole_tile.end());
						CHECK(near(match->second, position));
						++count;
					}
				}
			}
			CHECK(count == whole_tile.size());
		}
	}
}

TEST_CASE("every rule: all rules combined produce the same digest on several threads") {
	const TexturedHills terrain;
	LayerSettings layer = plain_layer();
	for (const char *name : {"density over height", "field", "mask", "clumps", "edge feather", "path", "proximity"}) {
		for (const NamedRule &rule : every_rule) {
			if (rule.name == name) {
				rule.add(layer);
			}
		}
	}
	const TileInstances tile = built(layer, terrain, tile_of_hills);
	CHECK(size_of(tile) > 20);
	check_on_threads(layer, terrain, digest(tile));
	LayerSettings wet = plain_layer();
	for (const NamedRule &rule : every_rule) {
		if (rule.name == "biome" || rule.name == "water of biomes" || rule.name == "edge feather") {
			rule.add(wet);
		}
	}
	const TileInstances shore = built(wet, terrain, tile_of_hills);
	CHECK(size_of(shore) > 20);
	check_on_threads(wet, terrain, digest(shore));
}

TEST_CASE("every rule: the product of its factors is bit-identical to the density of the tile") {
	const TexturedHills terrain;
	for (const NamedRule &rule : every_rule) {
		CAPTURE(rule.name);
		LayerSettings layer = plain_layer();
		rule.add(layer);
		CHECK(check_factors(layer, terrain) > 50);
	}
	constexpr std::array common_rules{"density", "height falloff", "density over height", "density over slope", "field",
			"mask", "clumps", "ground textures", "edge feather", "path", "proximity"};
	CHECK(check_factors(layer_with_rules(common_rules), terrain) > 1000);
	CHECK(check_factors(plain_layer(), terrain) == 0);
}

TEST_CASE("every rule: a position is explained by the set's nearest point, as in its tile") {
	const TexturedHills terrain;
	constexpr std::array partial_rules{"slope falloff", "mask", "edge feather", "path", "spacing"};
	const LayerSettings layer = layer_with_rules(partial_rules);
	const auto standing_ranks = ranks_of(built(layer, terrain, tile_of_hills));
	const std::vector<SamplePoint> points = points_of(layer.set, tile_of_hills);
	std::mt19937 random(7);
	std::uniform_real_distribution<double> along(4.0, 124.0);
	PositionExplainer explainer;
	PositionExplanation explanation;
	std::size_t count = 0;
	for (int i = 0; i < 1000; ++i) {
		const glm::dvec2 position = tile_of_hills.min + glm::dvec2(along(random), along(random));
		REQUIRE(explainer.find(layer, {position.x, 0.0, position.y}).ok());
		REQUIRE(explainer.explain(ground_for(explainer, terrain), explanation).ok());
		const auto nearest = std::ranges::min_element(
				points, {}, [&](const SamplePoint &point) { return glm::distance(point.position, position); });
		REQUIRE(explanation.point == *nearest);
		REQUIRE(explanation.distance == doctest::Approx(glm::distance(nearest->position, position)));
		REQUIRE(explanation.distance <= layer.set.radius);
		REQUIRE(explanation.is_placed() == standing_ranks.contains(nearest->id));
		REQUIRE(explanation.at_position.density == product_of(explanation.at_position.factors));
		REQUIRE(explanation.at_position.ground.height == terrain.at(position).height);
		count += explanation.is_placed() ? 1 : 0;
	}
	CHECK(count > 50);
	CHECK(count < 950);
}

TEST_CASE("every rule: the mesh of an instance is explained as in its tile") {
	const TexturedHills terrain;
	LayerSettings layer = plain_layer();
	layer.mesh_weights = {1.0f, 2.0f, 0.5f};
	Rules low = open_rules();
	low.max_height = 60.0;
	low.height_falloff = 40.0;
	Rules clumps = open_rules();
	clumps.clumping = {18.0, 0.5, 0.4};
	Rules by_world = open_rules();
	ExpressionError error;
	by_world.expression = DensityExpression::compile("texture(1) + distance('Trees', 9) / 9", error);
	layer.mesh_rules = {low, by_world, clumps};
	layer.world_sources = empty_sources(layer);
	auto trees = std::make_shared<LayerSettings>(plain_layer());
	trees->set.radius = 8.0;
	layer.world_sources[1].layer = trees;
	const TileInstances tile = built(layer, terrain, tile_of_hills);
	const std::vector<SamplePoint> points = points_of(layer.set, tile_of_hills);
	PositionExplainer explainer;
	PositionExplanation explanation;
	std::array<double, 3> expected{};
	for (const SamplePoint &point : points) {
		REQUIRE(explainer.find(layer, {point.position.x, 0.0, point.position.y}).ok());
		REQUIRE(explainer.explain(ground_for(explainer, terrain), explanation).ok());
		REQUIRE(explanation.point.id == point.id);
		REQUIRE(explanation.meshes[1].inputs.size() == 2);
		const double value = explanation.meshes[1].inputs[0].value + explanation.meshes[1].inputs[1].value / 9.0;
		REQUIRE(explanation.meshes[1].density == doctest::Approx(std::min(value, 1.0)));
		const std::vector<std::uint64_t> ids(
				tile.meshes[explanation.mesh].ids.begin(), tile.meshes[explanation.mesh].ids.end());
		REQUIRE((std::ranges::find(ids, point.id) != ids.end()) == explanation.is_placed());
		for (std::size_t mesh = 0; mesh < 3 && explanation.is_placed(); ++mesh) {
			expected[mesh] += explanation.meshes[mesh].probability;
		}
	}
	for (std::size_t mesh = 0; mesh < 3; ++mesh) {
		CHECK(expected[mesh] > 50.0);
		CHECK(std::abs(expected[mesh] - static_cast<double>(tile.meshes[mesh].size())) <
				2.5 * std::sqrt(expected[mesh]));
	}
	layer.mesh_rules[0]->fields = {std::make_shared<FailingField>()};
	REQUIRE(explainer.find(layer, {0.0, 0.0, 10.0}).ok());
	const Status status = explainer.explain(ground_for(explainer, terrain), explanation);
	CHECK(status.code == ErrorCode::wrong_type);
	CHECK(std::string(status.property) == "noise");
}

TEST_CASE("every rule: the error for a position that cannot be explained names the property") {
	const TexturedHills terrain;
	PositionExplainer explainer;
	const double nan = std::numeric_limits<double>::quiet_NaN();
	CHECK(std::string(explainer.find(plain_layer(), {0.0, 0.0, nan}).property) == "position");
	CHECK(explainer.find(plain_layer(), {1e12, 0.0, 0.0}).code == ErrorCode::out_of_range);
	LayerSettings invalid_layer = plain_layer();
	invalid_layer.rules.density = 2.0;
	CHECK(std::string(explainer.find(invalid_layer, {0.0, 0.0, 0.0}).property) == "density");
	DensityProbe probe;
	CHECK(probe.evaluate({}).code == ErrorCode::missing);
	CHECK(probe.find(plain_layer(), {}).code == ErrorCode::missing);
	LayerSettings near_grass = plain_layer();
	auto grass = std::make_shared<LayerSettings>(plain_layer());
	grass->set.radius = 0.01;
	near_grass.neighbors = {{grass, 1.0, nullptr}};
	const std::array<glm::dvec2, 2> far_apart{glm::dvec2(0.0), glm::dvec2(100.0)};
	CHECK(probe.find(near_grass, far_apart).code == ErrorCode::too_many_points);
	REQUIRE(probe.find(plain_layer(), far_apart).ok());
	CHECK(probe.evaluate({}).code == ErrorCode::wrong_size);
}
