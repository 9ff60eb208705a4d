// Tests of the rules of single meshes, which decide which mesh an instance gets.

#include "core/placement/instance_cache.hpp"
#include "core/placement/instance_writer.hpp"
#include "core/placement/layer_edits.hpp"
#include "core/placement/mesh_rules.hpp"
#include "core/sampling/block_cache.hpp"
#include "core/terrain/flat_terrain.hpp"
#include "counted_threads.hpp"
#include "mesh_fixture.hpp"
#include "refusal.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

Rules by_expression(const char *text) {
	Rules rules = open_rules();
	rules.expression = compiled(text);
	return rules;
}

/// Returns the rules of a forest: spruces below, oaks above, and birches in clumps.
std::vector<std::optional<Rules>> rules_by_height() {
	Rules birches;
	birches.clumping = {12.0, 0.4, 0.5};
	return {by_expression("smoothstep(70, 20, height)"), by_expression("smoothstep(20, 70, height)"), birches};
}

LayerSettings mixed_layer() {
	LayerSettings layer = rich_layer();
	layer.mesh_rules = rules_by_height();
	return layer;
}

std::uint64_t digest_in_caches(const LayerSettings &layer, const Terrain &terrain, const Rect &rect) {
	TileBuilder builder({}, std::make_shared<BlockCache>(), std::make_shared<InstanceCache>());
	TileInstances tile;
	REQUIRE(builder.build(layer, terrain, rect, tile).ok());
	return digest(tile);
}

} // namespace

TEST_CASE("mesh rules: they change meshes, but neither the points nor their transforms") {
	const Heightfield terrain = hills();
	const TileInstances plain = built(rich_layer(), terrain, tile_of_hills);
	const TileInstances mixed = built(mixed_layer(), terrain, tile_of_hills);
	CHECK(transforms_of(plain) == transforms_of(mixed));
	CHECK(meshes_of(plain) != meshes_of(mixed));
	CHECK(mixed.counts.placed == size_of(mixed));
}

TEST_CASE("mesh rules: without a choice or an effect, all bits are as without rules") {
	const Heightfield terrain = hills();
	const std::uint64_t plain = digest(built(rich_layer(), terrain, tile_of_hills));
	LayerSettings layer = rich_layer();
	layer.mesh_rules = {std::nullopt, open_rules(), by_expression("2 + height * 0")};
	CHECK(digest(built(layer, terrain, tile_of_hills)) == plain);
	layer.mesh_rules = {by_expression("0"), by_expression("-1"), by_expression("sqrt(-1)")};
	CHECK(digest(built(layer, terrain, tile_of_hills)) == plain);
	layer.mesh_weights = {1.0f};
	const std::uint64_t single = digest(built(rich_layer(), terrain, tile_of_hills));
	CHECK(single == plain);
	layer.mesh_rules = {by_expression("0")};
	LayerSettings without_rules = layer;
	without_rules.mesh_rules.clear();
	CHECK(digest(built(layer, terrain, tile_of_hills)) == digest(built(without_rules, terrain, tile_of_hills)));
}

TEST_CASE("mesh rules: the fractions of meshes follow weights and densities") {
	LayerSettings layer;
	layer.set = {.seed = 4, .radius = 1.0, .levels = 1};
	layer.mesh_weights = {1.0f, 3.0f, 0.0f};
	layer.mesh_rules = {by_expression("clamp(x / 100, 0, 1)"), by_expression("0.5"), by_expression("1")};
	const Rect rect{{0.0, 0.0}, {100.0, 100.0}};
	const Meshes meshes = meshes_of(built(layer, FlatTerrain(5.0), rect));
	double expected = 0.0;
	double variance = 0.0;
	std::array<int, 3> counts{};
	const auto positions = positions_of(layer, rect);
	REQUIRE(meshes.size() == positions.size());
	for (const auto &[id, position] : positions) {
		const double weight = position.x / 100.0;
		const double probability = weight / (weight + 1.5);
		expected += probability;
		variance += probability * (1.0 - probability);
		++counts[meshes.at(id)];
	}
	CHECK(meshes.size() > 5000);
	CHECK(counts[2] == 0);
	CHECK(std::abs(counts[0] - expected) < 4.0 * std::sqrt(variance));
	// In the first tenth, only few instances have the first mesh.
	int first = 0, all = 0;
	for (const auto &[id, position] : positions) {
		first += position.x < 10.0 && meshes.at(id) == 0 ? 1 : 0;
		all += position.x < 10.0 ? 1 : 0;
	}
	CHECK(first < 0.08 * all);
	CHECK(first > 0);
}

TEST_CASE("mesh rules: species give way to each other with the height") {
	const Heightfield terrain = hills();
	LayerSettings layer = mixed_layer();
	layer.rules = {};
	layer.mesh_rules[2].reset();
	layer.mesh_weights[2] = 0.0f;
	const auto meshes = meshes_of(built(layer, terrain, tile_of_hills));
	std::array<std::array<int, 2>, 3> bands{}; // Below 20 m, between 20 and 70 m, above 70 m.
	for (const auto &[id, position] : positions_of(layer, tile_of_hills)) {
		const float height = terrain.at(position).height;
		++bands[height < 20.0f ? 0 : height < 70.0f ? 1 : 2][meshes.at(id)];
	}
	CHECK(bands[0][0] > 50);
	CHECK(bands[0][1] == 0);
	CHECK(bands[1][0] > 50);
	CHECK(bands[1][1] > 50);
	CHECK(bands[2][0] == 0);
	CHECK(bands[2][1] > 50);
}

TEST_CASE("mesh rules: where all weights are 0, the plain weights apply") {
	const Heightfield terrain = hills();
	LayerSettings layer = rich_layer();
	const auto plain = meshes_of(built(layer, terrain, tile_of_hills));
	layer.mesh_rules = {by_expression("x < 0"), by_expression("0"), by_expression("0")};
	int chosen = 0, fallen_back = 0;
	const auto positions = positions_of(layer, tile_of_hills);
	for (const auto &[id, mesh] : meshes_of(built(layer, terrain, tile_of_hills))) {
		const bool is_allowed = positions.at(id).x < 0.0;
		CHECK(mesh == (is_allowed ? 0 : plain.at(id)));
		++(is_allowed ? chosen : fallen_back);
	}
	CHECK(chosen > 100);
	CHECK(fallen_back > 100);
}

TEST_CASE("mesh rules: the mesh of an instance does not depend on tiles, caches or threads") {
	const Heightfield terrain = hills();
	LayerSettings layer = mixed_layer();
	layer.mesh_rules[1]->min_slope_degrees = 5.0;
	const TileInstances whole_tile = built(layer, terrain, tile_of_hills);
	const Meshes meshes = meshes_of(whole_tile);
	check_on_threads(layer, terrain, digest(whole_tile));
	CHECK(digest_in_caches(layer, terrain, tile_of_hills) == digest(whole_tile));
	Meshes from_parts;
	for (double x = -64.0; x < 64.0; x += 42.75) {
		for (double z = 0.0; z < 128.0; z += 31.5) {
			const glm::dvec2 corner(x, z);
			const Rect slice{corner, glm::min(corner + glm::dvec2(42.75, 31.5), tile_of_hills.max)};
			from_parts.merge(meshes_of(built(layer, terrain, slice)));
		}
	}
	CHECK(from_parts == meshes);

	layer.set.radius = 0.4; // Small enough that the tile is divided among threads.
	CountedThreads threads(3);
	TileBuilder builder;
	TileInstances shared;
	REQUIRE(builder.build(layer, terrain, tile_of_hills, shared, nullptr, &threads).ok());
	CHECK(threads.runs > 0);
	CHECK(digest(shared) == digest(built(layer, terrain, tile_of_hills)));
}

TEST_CASE("mesh rules: a layer that fills gaps has the same meshes with and without caches") {
	const Heightfield terrain = hills();
	LayerSettings shrubs = mixed_layer();
	shrubs.set = {.seed = 7, .radius = 2.0, .levels = 1, .layer = 8};
	shrubs.placement = {};
	shrubs.rules = {};
	shrubs.mesh_rules = {by_expression("slope < 60"), by_expression("slope >= 60"), std::nullopt};
	shrubs.neighbors = {{std::make_shared<const LayerSettings>(rich_layer()), 2.0, nullptr}};
	shrubs.spacing_fills = true;
	const TileInstances tile = built(shrubs, terrain, tile_of_hills);
	CHECK(digest_in_caches(shrubs, terrain, tile_of_hills) == digest(tile));
	for (std::size_t mesh : {0, 1}) {
		CHECK(tile.meshes[mesh].size() > 50);
		for (std::size_t i = 0; i < tile.meshes[mesh].size(); ++i) {
			const glm::dvec3 position = world_position(tile, tile.meshes[mesh], i);
			const double slope = std::acos(double{terrain.at({position.x, position.z}).normal.y}) * 57.29577951308232;
			CHECK((mesh == 0 ? slope < 60.01 : slope > 59.99));
		}
	}
}

TEST_CASE("mesh rules: all kinds of rules choose, and they use the layer's water") {
	const Heightfield terrain = hills();
	std::vector<Rules> kinds(6, open_rules());
	kinds[0].max_height = 45.0;
	kinds[1].max_slope_degrees = 25.0;
	kinds[2].clumping = {20.0, 0.5, 0.0};
	auto mask = std::make_shared<PaintedMask>();
	Rect changed_rect;
	REQUIRE(mask->reset(1.0, 1.0).ok());
	REQUIRE(mask->paint({Brush::Mode::erase, {0.0, 64.0}, 40.0, 1.0, 1.0}, changed_rect).ok());
	kinds[3].mask = mask;
	kinds[4].min_water_depth = 0.0;
	kinds[5].density = 0.0;
	for (const Rules &kind : kinds) {
		LayerSettings layer = rich_layer();
		layer.rules = open_rules();
		layer.rules.water = std::make_shared<WaterLevels>(50.0);
		layer.mesh_weights = {1.0f, 1e-30f};
		layer.mesh_rules = {kind};
		Rules with_water = kind;
		with_water.water = layer.rules.water;
		PreparedRules rules;
		REQUIRE(rules.set(with_water, layer.set.seed).ok());
		const auto meshes = meshes_of(built(layer, terrain, tile_of_hills));
		int refused_count = 0;
		for (const auto &[id, position] : positions_of(layer, tile_of_hills)) {
			double density = 0.0;
			std::vector<float> scratch;
			REQUIRE(rules.position_densities({{&position, 1}}, {&density, 1}, scratch).ok());
			density *= rules.ground_density(terrain.at(position), position);
			CHECK(meshes.at(id) == (density > 0.0 ? 0 : 1));
			refused_count += density > 0.0 ? 0 : 1;
		}
		CHECK(refused_count > 20);
	}
}

TEST_CASE("mesh rules: on surfaces, noise depends on the height, and slopes exceed 90 degrees") {
	LayerSettings layer;
	layer.set = {.seed = 3, .radius = 1.0, .on_surface = true};
	layer.mesh_weights = {1.0f, 1e-30f};
	layer.mesh_rules = {by_expression("(slope > 100) * (noise(3) > 0.5)")};
	MeshRules rules;
	rules.set(layer);
	std::vector<MeshPoint> points;
	for (std::uint64_t id = 0; id < 200; ++id) {
		const bool hangs = id % 2 == 0;
		points.push_back({id, {1.0, 2.0}, {static_cast<float>(id), {0.0f, hangs ? -1.0f : 1.0f, 0.0f}, 1.0f}});
	}
	std::vector<std::uint8_t> meshes(points.size());
	MeshRules::Scratch scratch;
	REQUIRE(rules.choose(points, meshes, scratch).ok());
	int hanging = 0;
	for (std::size_t i = 0; i < points.size(); ++i) {
		CHECK((i % 2 == 0 || meshes[i] == 1));
		hanging += meshes[i] == 0 ? 1 : 0;
	}
	CHECK(hanging > 20);
	CHECK(hanging < 80);
}

TEST_CASE("mesh rules: heights are altitudes on a planet") {
	LayerSettings layer;
	layer.set = {.seed = 3, .radius = 1.0, .on_surface = true};
	layer.planet = {{}, 1000.0};
	layer.mesh_weights = {1.0f, 1e-30f};
	layer.mesh_rules = {by_expression("height > 5")};
	MeshRules rules;
	rules.set(layer);
	const std::array<MeshPoint, 2> points{MeshPoint{1, {1010.0, 0.0}, {0.0f, {1.0f, 0.0f, 0.0f}, 1.0f}},
			MeshPoint{2, {1000.0, 0.0}, {0.0f, {1.0f, 0.0f, 0.0f}, 1.0f}}};
	std::array<std::uint8_t, 2> meshes{};
	MeshRules::Scratch scratch;
	REQUIRE(rules.choose(points, meshes, scratch).ok());
	CHECK(meshes[0] == 0);
	CHECK(meshes[1] == 1);
}

TEST_CASE("mesh rules: shares are the probabilities of the choice") {
	LayerSettings layer;
	layer.set = {.seed = 3, .radius = 1.0};
	layer.mesh_weights = {1.0f, 3.0f, 4.0f};
	layer.mesh_rules = {by_expression("x"), std::nullopt, by_expression("0")};
	MeshRules rules;
	rules.set(layer);
	std::vector<MeshShare> shares;
	REQUIRE(rules.find_shares({1, {0.25, 0.0}, {5.0f}}, shares).ok());
	REQUIRE(shares.size() == 3);
	CHECK(shares[0].weight == 1.0);
	CHECK(shares[0].density == 0.25);
	CHECK(shares[0].probability == doctest::Approx(0.25 / 3.25));
	CHECK(shares[1].density == 1.0);
	CHECK(shares[1].probability == doctest::Approx(3.0 / 3.25));
	CHECK(shares[2].density == 0.0);
	CHECK(shares[2].probability == 0.0);
	layer.mesh_rules[1] = by_expression("0");
	rules.set(layer);
	REQUIRE(rules.find_shares({1, {-1.0, 0.0}, {5.0f}}, shares).ok());
	CHECK(shares[0].density == 0.0);
	CHECK(shares[0].probability == 0.125);
	CHECK(shares[2].probability == 0.5);
}

TEST_CASE("mesh rules: only a slope rule needs normals") {
	LayerSettings layer = rich_layer();
	layer.placement = {};
	layer.mesh_rules = {by_expression("height"), std::nullopt};
	CHECK_FALSE(follows_normals(layer));
	layer.mesh_rules[1] = by_expression("slope");
	CHECK(follows_normals(layer));
	layer.mesh_rules[1] = open_rules();
	CHECK_FALSE(follows_normals(layer));
	layer.mesh_rules[1]->min_slope_degrees = 3.0;
	CHECK(follows_normals(layer));
}

TEST_CASE("mesh rules: the error for invalid rules names the property and the value") {
	const auto refuse = [](std::vector<std::optional<Rules>> rules, ErrorCode code, const char *property,
								double value) {
		LayerSettings layer = rich_layer();
		layer.mesh_rules = std::move(rules);
		check_refused(validate(layer), code, property, value);
	};
	Rules rules;
	refuse(std::vector<std::optional<Rules>>(4), ErrorCode::out_of_range, "mesh_rules", 4.0);
	rules.edge_feather = 2.0;
	refuse({rules}, ErrorCode::wrong_type, "mesh_rules", 0.0);
	rules = {};
	rules.ground_textures = {1};
	refuse({rules}, ErrorCode::wrong_type, "mesh_rules", 0.0);
	rules = {};
	rules.shapes = std::make_shared<ShapeSet>();
	refuse({rules}, ErrorCode::wrong_type, "mesh_rules", 0.0);
	rules = {};
	rules.density = 1.5;
	refuse({std::nullopt, rules}, ErrorCode::out_of_range, "density", 1.5);
}

TEST_CASE("mesh rules: a failing field is an error, and leaves the tile unchanged") {
	const Heightfield terrain = hills();
	LayerSettings layer = rich_layer();
	TileInstances tile = built(layer, terrain, tile_of_hills);
	const std::uint64_t before = digest(tile);
	layer.mesh_rules = {Rules{}};
	layer.mesh_rules[0]->fields = {std::make_shared<FailingField>()};
	TileBuilder builder;
	check_refused(builder.build(layer, terrain, tile_of_hills, tile), ErrorCode::wrong_type, "noise", 0.0);
	CHECK(digest(tile) == before);
	MeshRules rules;
	rules.set(layer);
	std::vector<MeshShare> shares;
	check_refused(rules.find_shares({}, shares), ErrorCode::wrong_type, "noise", 0.0);
}

TEST_CASE("mesh rules: the choice of meshes can be cancelled") {
	const LayerSettings layer = mixed_layer();
	const std::array<glm::dvec2, 1> position{};
	const std::array<Ground, 1> ground{Ground{5.0f}};
	const std::array<std::uint64_t, 1> id{7};
	const std::array<std::uint32_t, 1> zero{};
	const PlacedPoints points{position, ground, id, zero, zero};
	TileInstances tile = built(layer, hills(), tile_of_hills);
	const std::uint64_t before = digest(tile);
	const std::atomic<bool> cancel{true};
	InstanceWriter writer;
	CHECK(writer.write(layer, points, {}, tile, &cancel).code == ErrorCode::cancelled);
	CHECK(digest(tile) == before);
}

TEST_CASE("mesh rules: an edit of them changes the layer everywhere, but no layer around it") {
	const LayerSettings before = mixed_layer();
	LayerSettings after = before;
	CHECK(EditSearch().find(before, after).empty());
	after.mesh_rules[2]->clumping.coverage = 0.6;
	CHECK(EditSearch().find(before, after).everywhere);
	LayerSettings shrubs = rich_layer();
	shrubs.neighbors = {{std::make_shared<const LayerSettings>(before), 3.0, nullptr}};
	LayerSettings shrubs_after = shrubs;
	shrubs_after.neighbors[0].layer = std::make_shared<const LayerSettings>(after);
	CHECK(EditSearch().find(shrubs, shrubs_after).empty());
}

TEST_CASE("mesh rules: edits of water reach them if they use its depth") {
	const auto is_changed = [](const char *text) {
		LayerSettings before = rich_layer();
		before.rules.max_water_depth = unlimited_height;
		before.rules.water = std::make_shared<WaterLevels>(3.0);
		before.mesh_rules = {by_expression(text)};
		LayerSettings after = before;
		after.rules.water = std::make_shared<WaterLevels>(4.0);
		return !EditSearch().find(before, after).empty();
	};
	CHECK_FALSE(is_changed("height > 1"));
	CHECK(is_changed("water_depth > 1"));
}
