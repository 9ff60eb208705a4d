// Tests of expressions that use biomes, ground textures, distances to other layers and the mask texture.

#include "core/placement/instance_cache.hpp"
#include "core/placement/layer_edits.hpp"
#include "core/placement/layer_links.hpp"
#include "core/placement/mesh_rules.hpp"
#include "core/rules/image_mask.hpp"
#include "core/sampling/block_cache.hpp"
#include "core/terrain/triangle_parts.hpp"
#include "core/terrain/triangle_terrain.hpp"
#include "core/terrain/weight_map.hpp"
#include "counted_threads.hpp"
#include "mesh_fixture.hpp"
#include "refusal.hpp"
#include "surface_fixture.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

/// Returns stripes along z of three biomes, 32 m wide and with irregular borders.
std::shared_ptr<const BiomeMap> stripes(int shift = 0) {
	std::vector<std::uint8_t> pixels;
	for (int y = 0; y < 40; ++y) {
		for (int x = 0; x < 60; ++x) {
			pixels.push_back(static_cast<std::uint8_t>((x + (y > 25 ? shift : 0)) / 3 % 3));
		}
	}
	auto map = std::make_shared<BiomeMap>();
	REQUIRE(map->set({60, 40}, pixels, {{-300.0, -200.0}, {300.0, 200.0}}, BiomeEdge::nothing,
					   {.width = 6.0, .noise = 8.0, .noise_size = 20.0})
					.ok());
	return map;
}

std::shared_ptr<const BiomeDensity> weight_of(std::shared_ptr<const BiomeMap> map, std::size_t biome) {
	PerBiome<float> weights{};
	weights[biome] = 1.0f;
	return std::make_shared<const BiomeDensity>(std::move(map), weights);
}

std::shared_ptr<const ImageMask> checkerboard() {
	std::vector<std::uint8_t> pixels;
	for (int i = 0; i < 32 * 32; ++i) {
		pixels.push_back((i / 2 + i / 64) % 2 == 0 ? 255 : 0);
	}
	auto mask = std::make_shared<ImageMask>();
	REQUIRE(mask->set({32, 32}, pixels, {{-150.0, -60.0}, {150.0, 200.0}}, MaskEdge::clamp).ok());
	return mask;
}

/// Returns the hills of the fixture with the weights of two textures.
Heightfield textured_hills() {
	Heightfield field = hills();
	std::vector<std::uint8_t> bytes;
	for (int i = 0; i < 61 * 41; ++i) {
		bytes.push_back(static_cast<std::uint8_t>(i * 37 % 256));
		bytes.push_back(static_cast<std::uint8_t>(255 - i * 37 % 256));
	}
	WeightMap weights;
	REQUIRE(weights.set({61, 41}, 2, bytes).ok());
	field.set_weights(std::move(weights));
	return field;
}

/// Returns rocks that are 14 m apart.
std::shared_ptr<LayerSettings> rocks() {
	auto layer = std::make_shared<LayerSettings>();
	layer->set = {.seed = 7, .radius = 14.0, .levels = 1, .layer = 1};
	layer->rules.density = 0.7;
	return layer;
}

/// Adds the sources of all inputs of the layer's expressions.
void add_sources(LayerSettings &r_layer, const std::shared_ptr<const LayerSettings> &measured = nullptr,
		const std::shared_ptr<const BiomeMap> &map = stripes()) {
	static const auto mask = checkerboard();
	r_layer.world_sources = empty_sources(r_layer);
	for (WorldSource &source : r_layer.world_sources) {
		switch (source.input.kind) {
			case WorldInputKind::biome:
				source.biome = weight_of(map, static_cast<std::size_t>(source.input.number));
				break;
			case WorldInputKind::mask: source.mask = mask; break;
			case WorldInputKind::distance: source.layer = measured; break;
			case WorldInputKind::texture: break;
		}
	}
}

LayerSettings plants() {
	LayerSettings layer;
	layer.set = {.seed = 99, .radius = 1.5, .levels = 2, .layer = 3};
	layer.rules.max_slope_degrees = 70.0;
	return layer;
}

LayerSettings with_rule(const std::string &text, const std::shared_ptr<const LayerSettings> &measured = nullptr) {
	LayerSettings layer = plants();
	layer.rules.expression = compiled(text);
	add_sources(layer, measured);
	return layer;
}

/// Returns a layer with a mesh for each text. The last mesh is used where all expressions are 0.
LayerSettings with_meshes(
		const std::vector<std::string> &texts, const std::shared_ptr<const LayerSettings> &measured = nullptr) {
	LayerSettings layer = plants();
	for (const std::string &text : texts) {
		layer.mesh_rules.emplace_back(open_rules()).value().expression = compiled(text);
		layer.mesh_weights.push_back(1.0f);
	}
	layer.mesh_weights.push_back(1e-30f);
	add_sources(layer, measured);
	return layer;
}

const std::vector<std::string> all_kinds{
		"biome(1)", "texture(0) > 0.6", "distance(\"Rocks\", 12) / 20", "mask_green * biome(2)"};

Meshes meshes_of(const LayerSettings &layer, const Terrain &terrain, const Rect &rect) {
	return test::meshes_of(built(layer, terrain, rect));
}

/// Returns the instances and meshes of `rect`, from tiles of `size` meters in reverse order.
Meshes in_small_tiles(const LayerSettings &layer, const Terrain &terrain, const Rect &rect, double size) {
	Meshes meshes;
	TileBuilder builder({}, std::make_shared<BlockCache>(), std::make_shared<InstanceCache>());
	for (double y = rect.max.y - size; y >= rect.min.y; y -= size) {
		for (double x = rect.max.x - size; x >= rect.min.x; x -= size) {
			TileInstances tile;
			REQUIRE(builder.build(layer, terrain, Rect{{x, y}, {x + size, y + size}}, tile).ok());
			meshes.merge(test::meshes_of(tile));
		}
	}
	return meshes;
}

/// Generates a tile in steps, as for ground that only the caller can query.
TileInstances built_in_steps(const LayerSettings &layer, const Terrain &terrain, const Rect &rect) {
	TileBuilder builder;
	TileInstances tile;
	std::vector<Ground> ground;
	REQUIRE(builder.find_points(layer, rect).ok());
	const auto query = [&] {
		ground.assign(builder.positions().size(), Ground{});
		std::size_t end = 0; // Callers may process the queries as consecutive parts of the positions.
		for (const GroundQuery &each : builder.queries()) {
			REQUIRE(each.first == end);
			end += each.count;
			const auto query_grounds = std::span(ground).subspan(each.first, each.count);
			REQUIRE(terrain.query(builder.positions().subspan(each.first, each.count), each.needs, query_grounds).ok());
		}
	};
	query();
	while (!builder.is_complete()) {
		REQUIRE(builder.find_further(ground).ok());
		query();
	}
	REQUIRE(builder.place(ground, tile).ok());
	return tile;
}

/// Checks that a layer is the same in one tile, in small tiles, in steps, and in pieces on several
/// threads.
void check_in_any_tiles(const LayerSettings &layer, const Terrain &terrain) {
	const Meshes meshes = meshes_of(layer, terrain, tile_of_hills);
	CHECK(meshes.size() > 500);
	CHECK(in_small_tiles(layer, terrain, tile_of_hills, 32.0) == meshes);
	const std::uint64_t expected = digest(built(layer, terrain, tile_of_hills));
	CHECK(digest(built_in_steps(layer, terrain, tile_of_hills)) == expected);
	check_on_threads(layer, terrain, expected);
	const Rect wide{{-256.0, -128.0}, {256.0, 192.0}};
	CountedThreads threads(2);
	TileBuilder builder;
	TileInstances tile;
	REQUIRE(builder.build(layer, terrain, wide, tile, nullptr, &threads).ok());
	CHECK(threads.runs > 0);
	CHECK(digest(tile) == digest(built(layer, terrain, wide)));
}

} // namespace

TEST_CASE("world inputs: an expression lists each input once, whatever its spelling") {
	const auto expression =
			compiled("biome('Forest') + biome( \"Forest\" ) * texture(3) + distance(\"Old oaks\",20.0) + mask_alpha "
					 "+ mask_alpha - biome(4) + distance('Old oaks', 5)");
	REQUIRE(expression->world_inputs().size() == 6);
	CHECK(expression->world_inputs()[0] == WorldInput{WorldInputKind::biome, "Forest", 0, 0.0});
	CHECK(expression->world_inputs()[1] == WorldInput{WorldInputKind::texture, "", 3, 0.0});
	CHECK(expression->world_inputs()[2] == WorldInput{WorldInputKind::distance, "Old oaks", 0, 20.0});
	CHECK(expression->world_inputs()[3] == WorldInput{WorldInputKind::mask, "", 3, 0.0});
	CHECK(expression->world_inputs()[4] == WorldInput{WorldInputKind::biome, "", 4, 0.0});
	CHECK(expression->world_inputs()[5] == WorldInput{WorldInputKind::distance, "Old oaks", 0, 5.0});
	const std::array<float, 6> values{0.5f, 0.25f, 8.0f, 0.125f, 1.0f, 5.0f};
	CHECK(expression->at({.world = values}, 0, false) == 0.5 + 0.5 * 0.25 + 8.0 + 0.25 - 1.0 + 5.0);
	std::vector<std::string> texts;
	for (const WorldInput &input : expression->world_inputs()) {
		texts.push_back(text_of(input));
	}
	CHECK(texts ==
			std::vector<std::string>{"biome(\"Forest\")", "texture(3)", "distance(\"Old oaks\")", "mask_alpha",
					"biome(4)", "distance(\"Old oaks\")"});
}

TEST_CASE("world inputs: an error names the allowed arguments") {
	const std::array<std::pair<const char *, const char *>, 14> cases{{
			{"biome()", "its index between 0 and 31"},
			{"biome(x)", "its index between 0 and 31"},
			{"biome(32)", "its index between 0 and 31"},
			{"biome(\"\")", "the name of a biome"},
			{"biome(\"Forest)", "the name of a biome"},
			{"texture(256)", "between 0 and 255"},
			{"texture(1.5)", "between 0 and 255"},
			{"texture(1, 2)", "between 0 and 255"},
			{"distance(\"Oaks\")", "a maximum distance between 0.001 and 1000 m"},
			{"distance(\"Oaks\", 0)", "a maximum distance between 0.001 and 1000 m"},
			{"distance(\"Oaks\", 1001)", "a maximum distance between 0.001 and 1000 m"},
			{"distance(3, 10)", "the name of a layer"},
			{"texture + 1", "expected \"(\" after texture"},
			{"mask_gray", "mask_blue and mask_alpha"},
	}};
	for (const auto &[text, message] : cases) {
		ExpressionError error;
		CHECK(DensityExpression::compile(text, error) == nullptr);
		CHECK_MESSAGE(error.message.find(message) != std::string::npos, error.message);
		CHECK(error.column == 1);
	}
	std::string expression = "0";
	for (int index = 0; index <= static_cast<int>(max_world_inputs); ++index) {
		expression += " + texture(" + std::to_string(index) + ")";
	}
	ExpressionError error;
	CHECK(DensityExpression::compile(expression, error) == nullptr);
	CHECK(error.message.find("at most 16 biomes, textures, distances") != std::string::npos);
}

TEST_CASE("world inputs: as a rule, each input has the same effect as the rule of the layer") {
	const Heightfield terrain = textured_hills();
	const auto stones = rocks();
	std::array<std::pair<LayerSettings, LayerSettings>, 4> pairs;
	pairs.fill({plants(), plants()});
	pairs[0].first = with_rule("biome(1)");
	pairs[0].second.rules.biome = weight_of(stripes(), 1);
	pairs[1].first = with_rule("texture(1)");
	pairs[1].second.rules.ground_textures = {1};
	pairs[2].first = with_rule("distance('Rocks', 9) >= 9", stones);
	pairs[2].second.neighbors = {{stones, 9.0, nullptr}};
	pairs[3].first = with_rule("mask_red");
	pairs[3].second.rules.fields = {checkerboard()};
	for (const auto &[expression, rule] : pairs) {
		const Meshes meshes = meshes_of(rule, terrain, tile_of_hills);
		CHECK(meshes.size() > 500);
		CHECK(meshes.size() < meshes_of(plants(), terrain, tile_of_hills).size());
		CHECK(meshes_of(expression, terrain, tile_of_hills) == meshes);
	}
}

TEST_CASE("world inputs: rules do not depend on tiles, order and threads, and neither do their edges") {
	const Heightfield terrain = textured_hills();
	LayerSettings layer =
			with_rule("(biome(0) + texture(0) > 0.3) * (distance('Rocks', 8) > 5) * (0.2 + mask_blue)", rocks());
	check_in_any_tiles(layer, terrain);
	layer.rules.edge_feather = 7.0;
	check_in_any_tiles(layer, terrain);
}

TEST_CASE("world inputs: they choose the mesh of an instance") {
	const Heightfield terrain = textured_hills();
	const auto stones = rocks();
	const std::map<std::uint64_t, glm::dvec2> stone_positions = positions_of(*stones, expanded(tile_of_hills, 20.0));
	const Meshes present = meshes_of(*stones, terrain, expanded(tile_of_hills, 20.0));
	const auto distance_at = [&](glm::dvec2 position) {
		double nearest = 10.0;
		for (const auto &[id, mesh] : present) {
			nearest = std::min(nearest, glm::distance(position, stone_positions.at(id)));
		}
		return nearest;
	};
	const auto mask = checkerboard();
	const auto biome = weight_of(stripes(), 2);
	const auto value_of = [&](int kind, glm::dvec2 position) {
		float value = 0.0f;
		Ground ground = terrain.at(position);
		const std::array<std::int32_t, 1> texture{1};
		switch (kind) {
			case 0: REQUIRE(biome->sample({&position, 1}, {&value, 1}).ok()); return double{value};
			case 1: REQUIRE(terrain.weigh({&position, 1}, texture, {&ground, 1}).ok()); return double{ground.weight};
			case 2: return distance_at(position);
			default: REQUIRE(mask->sample({&position, 1}, {&value, 1}).ok()); return double{value};
		}
	};
	const std::array<const char *, 4> texts{
			"biome(2) > 0.5", "texture(1) > 0.5", "distance('Rocks', 10) > 5", "mask_red > 0.5"};
	for (int kind = 0; kind < 4; ++kind) {
		const LayerSettings layer = with_meshes({texts[static_cast<std::size_t>(kind)]}, stones);
		const Meshes meshes = meshes_of(layer, terrain, tile_of_hills);
		const auto positions = positions_of(layer, tile_of_hills);
		std::array<int, 2> counts{};
		for (const auto &[id, mesh] : meshes) {
			CHECK(mesh == (value_of(kind, positions.at(id)) > (kind == 2 ? 5.0 : 0.5) ? 0 : 1));
			++counts[mesh];
		}
		CHECK(counts[0] > 100);
		CHECK(counts[1] > 100);
		LayerSettings plain = layer;
		plain.mesh_rules.clear();
		plain.world_sources.clear();
		CHECK(transforms_of(built(plain, terrain, tile_of_hills)) ==
				transforms_of(built(layer, terrain, tile_of_hills)));
	}
}

TEST_CASE("world inputs: meshes do not depend on tiles, order and threads, also in layers that fill gaps") {
	const Heightfield terrain = textured_hills();
	LayerSettings layer = with_meshes(all_kinds, rocks());
	check_in_any_tiles(layer, terrain);
	layer.neighbors = {{rocks(), 4.0, nullptr}};
	layer.spacing_fills = true;
	check_in_any_tiles(layer, terrain);
	layer = with_meshes({"biome(1)", "distance('Rocks', 12) / 20"}, rocks()); // These tiles come from the cache.
	layer.neighbors = {{rocks(), 4.0, nullptr}};
	layer.spacing_fills = true;
	check_in_any_tiles(layer, terrain);
}

TEST_CASE("world inputs: on a sphere, meshes and rules use the same values in any tile") {
	const auto triangles = surfaces::sphere(40.0, 24);
	std::vector<glm::dvec3> corners;
	for (const std::uint32_t index : triangles.indices) {
		corners.push_back(triangles.vertices[index]);
	}
	auto terrain_part = std::make_shared<TriangleTerrain>();
	REQUIRE(terrain_part->set(corners, nullptr, Winding::counterclockwise).ok());
	TriangleParts terrain;
	const std::array<TriangleParts::Part, 1> parts{terrain_part};
	REQUIRE(terrain.set(parts).ok());
	for (const bool on_planet : {false, true}) {
		auto stones = rocks();
		stones->set.on_surface = true;
		stones->rules = open_rules();
		LayerSettings layer = with_meshes({"biome(1)", "distance('Rocks', 12) / 20", "mask_green * biome(2)"}, stones);
		layer.set.on_surface = true;
		layer.set.levels = 1;
		layer.rules = open_rules();
		layer.rules.expression = compiled("(distance('Rocks', 9) > 4) * (0.5 + biome(0))");
		if (on_planet) {
			layer.planet = {{}, 40.0};
			stones->planet = layer.planet;
		}
		add_sources(layer, stones);
		const Rect rect{{-40.0, -40.0}, {40.0, 40.0}};
		const Meshes meshes = meshes_of(layer, terrain, rect);
		std::array<int, 4> counts{};
		for (const auto &[id, mesh] : meshes) {
			++counts[mesh];
		}
		CHECK(counts[0] > 50);
		CHECK(counts[1] > 50);
		CHECK(in_small_tiles(layer, terrain, rect, 20.0) == meshes);
	}
}

TEST_CASE("world inputs: without a source, a value is 0 or the maximum distance") {
	const Heightfield terrain = textured_hills();
	const std::uint64_t all = digest(built(plants(), terrain, tile_of_hills));
	LayerSettings layer = plants();
	layer.rules.expression = compiled("(distance('Nobody', 5) >= 5) * (1 - biome('Nowhere')) * (1 - mask_red)");
	layer.world_sources = empty_sources(layer);
	CHECK(digest(built(layer, terrain, tile_of_hills)) == all);
}

TEST_CASE("world inputs: a renamed layer is renamed in distances, and nowhere else") {
	const auto renamed = [](const char *text) {
		return with_renamed_layer(text, "Oaks", "Old oaks");
	};
	CHECK(renamed("distance('Oaks', 5) + distance ( \"Oaks\", 6) * biome('Oaks')") ==
			"distance(\"Old oaks\", 5) + distance ( \"Old oaks\", 6) * biome('Oaks')");
	CHECK(renamed("distance('Oaks 2', 5) * height") == "distance('Oaks 2', 5) * height");
	CHECK(renamed("height + distance") == "height + distance");
	CHECK(with_renamed_layer("distance('A', 5)", "A", "the \"best\"") == "distance('the \"best\"', 5)");
}

TEST_CASE("world inputs: textures on surfaces and missing sources are errors") {
	TileBuilder builder;
	TileInstances tile;
	LayerSettings layer = with_rule("texture(1)");
	layer.set.on_surface = true;
	check_refused(
			builder.build(layer, textured_hills(), tile_of_hills, tile), ErrorCode::out_of_range, "on_surfaces", 1.0);
	layer.set.on_surface = false;
	layer.world_sources.clear();
	check_refused(
			builder.build(layer, textured_hills(), tile_of_hills, tile), ErrorCode::missing, "world_sources", 0.0);
	std::vector<std::string> names;
	for (std::size_t mesh = 0; mesh <= max_world_sources; ++mesh) {
		names.push_back("texture(" + std::to_string(mesh) + ")");
	}
	check_refused(builder.build(with_meshes(names), textured_hills(), tile_of_hills, tile), ErrorCode::out_of_range,
			"mesh_density_expressions", static_cast<double>(max_world_sources + 1));
}

TEST_CASE("world inputs: links find the measured layers among the earlier ones") {
	LayerSettings oaks;
	LayerSettings forest = plants();
	forest.rules.expression = compiled("distance('Oaks', 5) > 2");
	forest.world_sources = empty_sources(forest);
	LayerLinks first;
	first.name = "Oaks";
	LayerLinks second;
	second.name = "Forest";
	second.measured_layers = {"Oaks", "Elms"};
	const std::array<UnlinkedLayer, 2> layers{UnlinkedLayer{&oaks, &first}, UnlinkedLayer{&forest, &second}};
	const std::vector<LinkedLayer> linked = link_layers(layers, {});
	CHECK(linked[1].settings->world_sources[0].layer == linked[0].settings);
	const std::array<UnlinkedLayer, 2> swapped{layers[1], layers[0]};
	CHECK(link_layers(swapped, {})[0].settings->world_sources[0].layer == nullptr);
	const std::array<const LayerLinks *, 2> names{&first, &second};
	const std::vector<std::string> problems = name_problems(names, 1);
	REQUIRE(problems.size() == 1);
	CHECK(problems[0].find("distance() in an expression is \"Elms\", and no layer has that name") == 0);
}

TEST_CASE("world inputs: an edit affects the instances and meshes around it, and nothing else") {
	const Heightfield terrain = textured_hills();
	const auto stones = rocks();
	auto moved_stones = std::make_shared<LayerSettings>(*stones);
	auto mask = std::make_shared<PaintedMask>();
	Rect painted;
	REQUIRE(mask->reset(1.0, 1.0).ok());
	stones->rules.mask = std::make_shared<PaintedMask>(*mask);
	REQUIRE(mask->paint({Brush::Mode::erase, {0.0, 64.0}, 20.0, 1.0, 1.0}, painted).ok());
	moved_stones->rules.mask = mask;
	const std::string text = "biome(1) + distance('Rocks', 12) / 20";
	for (const bool for_meshes : {false, true}) {
		for (const bool biome : {false, true}) {
			LayerSettings before = for_meshes ? with_meshes({text, "0.5"}, stones) : with_rule(text, stones);
			LayerSettings after = before;
			if (biome) {
				add_sources(before, stones, stripes(0));
				add_sources(after, stones, stripes(1));
			} else {
				add_sources(before, stones, before.world_sources.empty() ? nullptr : stripes());
				after = before;
				for (WorldSource &source : after.world_sources) {
					source.layer = source.layer != nullptr ? moved_stones : nullptr;
				}
			}
			EditSearch search;
			const EditedArea area = search.find(before, after);
			CHECK_FALSE(area.everywhere);
			CHECK_FALSE(area.areas.empty());
			const Meshes previous = meshes_of(before, terrain, tile_of_hills);
			const Meshes current = meshes_of(after, terrain, tile_of_hills);
			CHECK(previous != current);
			int kept_count = 0;
			for (const auto &[id, position] : positions_of(before, tile_of_hills)) {
				if (!area.touches({position, position})) {
					++kept_count;
					const auto a = previous.find(id);
					const auto b = current.find(id);
					REQUIRE((a == previous.end()) == (b == current.end()));
					CHECK((a == previous.end() || a->second == b->second));
				}
			}
			CHECK(kept_count > 100);
			// Other layers see only the instances, which the choice of meshes does not change.
			LayerSettings ferns = plants();
			ferns.neighbors = {{std::make_shared<const LayerSettings>(before), 1.0, nullptr}};
			LayerSettings later_ferns = ferns;
			later_ferns.neighbors[0].layer = std::make_shared<const LayerSettings>(after);
			CHECK(EditSearch().find(ferns, later_ferns).empty() == for_meshes);
		}
	}
	LayerSettings before = with_rule("mask_red");
	LayerSettings after = before;
	after.world_sources[0].mask = checkerboard();
	CHECK(EditSearch().find(before, after).everywhere);
}
