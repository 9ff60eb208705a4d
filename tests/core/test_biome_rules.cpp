// Tests of biome and water rules of a layer, and of the area that an edit of them affects.

#include "core/placement/layer_edits.hpp"
#include "core/placement/tile_builder.hpp"
#include "core/terrain/flat_terrain.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

using Pixels = std::vector<std::uint8_t>;
using SharedMap = std::shared_ptr<const BiomeMap>;

/// Returns a map of 40 by 30 pixels of 8 meters around the origin: biome 0 on the left, biome 1 on
/// the right, and a patch of biome `patch`.
SharedMap map_with(std::uint8_t patch, const BiomeBorders &borders = {.width = 8.0, .noise = 10.0}) {
	Pixels pixels;
	for (int y = 0; y < 30; ++y) {
		for (int x = 0; x < 40; ++x) {
			const bool in_patch = x >= 28 && x < 34 && y >= 10 && y < 15;
			pixels.push_back(in_patch ? patch : x < 20 ? 0 : 1);
		}
	}
	auto map = std::make_shared<BiomeMap>();
	REQUIRE(map->set({40, 30}, pixels, {{-160.0, -120.0}, {160.0, 120.0}}, BiomeEdge::nothing, borders).ok());
	return map;
}

std::shared_ptr<const BiomeDensity> densities(SharedMap map, std::array<float, 3> values) {
	PerBiome<float> result{};
	std::ranges::copy(values, result.begin());
	return std::make_shared<BiomeDensity>(std::move(map), result);
}

std::shared_ptr<const WaterLevels> levels(SharedMap map, std::array<double, 3> values, double elsewhere = no_water) {
	PerBiome<double> result{};
	result.fill(elsewhere);
	std::ranges::copy(values, result.begin());
	return std::make_shared<WaterLevels>(std::move(map), result);
}

LayerSettings grass() {
	LayerSettings layer;
	layer.set = {.seed = 3, .radius = 1.5, .levels = 1, .layer = 2};
	return layer;
}

const FlatTerrain ground(0.0);

/// Ground that rises by 1 m per 10 m along +x. Its normals are vertical nevertheless.
class Slope final : public Terrain {
public:
	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override {
		for (std::size_t i = 0; i < positions.size(); ++i) {
			r_ground[i].height = static_cast<float>(0.1 * positions[i].x);
			r_ground[i].normal = {0.0F, 1.0F, 0.0F};
		}
		return {};
	}
};

std::map<std::uint64_t, glm::dvec3> standing(const LayerSettings &layer, const Terrain &terrain, const Rect &rect) {
	const TileInstances tile = built(layer, terrain, rect);
	std::map<std::uint64_t, glm::dvec3> result;
	for (const MeshInstances &mesh : tile.meshes) {
		for (std::size_t i = 0; i < mesh.size(); ++i) {
			result[mesh.ids[i]] = world_position(tile, mesh, i);
		}
	}
	return result;
}

constexpr Rect everything{{-200.0, -150.0}, {200.0, 150.0}};

EditedArea edits(const LayerSettings &before, const LayerSettings &after) {
	EditSearch search;
	return search.find(before, after);
}

/// Checks that the edited area contains every instance that only one of the two layers has.
void check_reach(const LayerSettings &before, const LayerSettings &after, const Terrain &terrain, double large_part) {
	const EditedArea area = edits(before, after);
	REQUIRE_FALSE(area.everywhere);
	const auto previous = standing(before, terrain, everything);
	const auto current = standing(after, terrain, everything);
	std::size_t changed_count = 0;
	const auto check = [&](const auto &from, const auto &other) {
		for (const auto &[id, position] : from) {
			if (!other.contains(id)) {
				++changed_count;
				CHECK(area.touches({{position.x, position.z}, {position.x, position.z}}));
			}
		}
	};
	check(previous, current);
	check(current, previous);
	CHECK(changed_count > 50);
	double size = 0.0;
	for (const Rect &rect : area.areas) {
		size += rect.size().x * rect.size().y;
	}
	CHECK(size < large_part * 320.0 * 240.0);
}

} // namespace

TEST_CASE("a layer's biome: instances exist only in the biome, thinned by the density, and keep their IDs") {
	LayerSettings layer = grass();
	const auto all = standing(layer, ground, everything);
	layer.rules.biome = densities(map_with(2, {}), {1.0F, 0.0F, 0.25F});
	const auto filtered = standing(layer, ground, everything);
	std::size_t remaining_count = 0;
	std::size_t patch = 0;
	for (const auto &[id, position] : filtered) {
		REQUIRE(all.contains(id));
		CHECK(all.at(id) == position);
		const bool in_patch = position.x >= 64.0 && position.x < 112.0 && position.z >= -40.0 && position.z < 0.0;
		CHECK((in_patch || (position.x >= -160.0 && position.x < 0.0 && std::abs(position.z) <= 120.0)));
		(in_patch ? patch : remaining_count) += 1;
	}
	const double per_area = static_cast<double>(remaining_count) / (160.0 * 240.0);
	CHECK(static_cast<double>(patch) / (48.0 * 40.0) == doctest::Approx(0.25 * per_area).epsilon(0.15));
}

TEST_CASE("a layer's biome: layers of two biomes that share a border fill it together, once") {
	const SharedMap map = map_with(1, {.width = 40.0});
	const auto first_density = densities(map, {1.0F, 0.0F, 0.0F});
	const auto right = densities(map, {0.0F, 1.0F, 0.0F});
	const auto both_densities = densities(map, {1.0F, 1.0F, 0.0F});
	std::vector<glm::dvec2> positions;
	for (double x = -40.0; x < 40.0; x += 0.37) {
		positions.emplace_back(x, 1.5 * x);
	}
	const auto sampled = [&positions](const BiomeDensity &field) {
		std::vector<float> result(positions.size(), -1.0F);
		REQUIRE(field.sample(positions, result).ok());
		return result;
	};
	const auto l = sampled(*first_density);
	const auto r = sampled(*right);
	const auto b = sampled(*both_densities);
	std::size_t mixed = 0;
	for (std::size_t i = 0; i < positions.size(); ++i) {
		CHECK(l[i] + r[i] == 1.0F);
		CHECK(b[i] == 1.0F);
		mixed += l[i] > 0.0F && l[i] < 1.0F ? 1 : 0;
	}
	CHECK(mixed > 80);
}

TEST_CASE("a layer's biome: a position alone and one among many are bit-identical") {
	const auto field = densities(map_with(2), {1.0F, 0.3F, 0.7F});
	std::vector<glm::dvec2> positions;
	for (int i = 0; i < 4000; ++i) {
		positions.emplace_back(std::fmod(i * 17.317, 400.0) - 200.0, std::fmod(i * 7.931, 300.0) - 150.0);
	}
	std::vector<float> many(positions.size());
	REQUIRE(field->sample(positions, many).ok());
	for (std::size_t i = 0; i < positions.size(); ++i) {
		float density = -1.0F;
		REQUIRE(field->sample(std::span(positions).subspan(i, 1), {&density, 1}).ok());
		CHECK(density == many[i]);
	}
	const glm::dvec2 invalid_position(std::nan(""), 0.0);
	float density = -1.0F;
	REQUIRE(field->sample({&invalid_position, 1}, {&density, 1}).ok());
	CHECK(density == 0.0F);
}

TEST_CASE("a layer's biome: no points are sampled outside the biome") {
	LayerSettings layer = grass();
	layer.rules.biome = densities(map_with(1), {1.0F, 0.0F, 0.0F});
	const TileInstances mirrored = built(layer, ground, {{-100.0, 0.0}, {-60.0, 40.0}});
	const TileInstances outside_tile = built(layer, ground, {{60.0, 0.0}, {100.0, 40.0}});
	CHECK(mirrored.counts.sampled > 300);
	CHECK(outside_tile.counts.sampled == 0);
}

TEST_CASE("water: without water, layers are unchanged, and water layers are empty") {
	LayerSettings layer = grass();
	const std::size_t all = standing(layer, ground, everything).size();
	layer.rules.max_water_depth = unlimited_height;
	CHECK(standing(layer, ground, everything).size() == all);
	layer.rules.min_water_depth = -0.5;
	CHECK(standing(layer, ground, everything).empty());
	layer.rules.water = std::make_shared<WaterLevels>(no_water);
	CHECK(standing(layer, ground, everything).empty());
}

TEST_CASE("water: layers stay dry, or are at the shore or in the required depth") {
	const Slope slope; // With a water level of 2 m, the shore is at x = 20.
	LayerSettings layer = grass();
	layer.rules.water = std::make_shared<WaterLevels>(2.0);
	const auto bounds = [&](double min, double max) {
		layer.rules.min_water_depth = min;
		layer.rules.max_water_depth = max;
		double first = 1e9;
		double last = -1e9;
		for (const auto &[id, position] : standing(layer, slope, everything)) {
			first = std::min(first, position.x);
			last = std::max(last, position.x);
		}
		return std::array{first, last};
	};
	const auto dry = bounds(-unlimited_height, 0.0);
	CHECK(dry[0] == doctest::Approx(20.0).epsilon(0.02));
	CHECK(dry[0] >= 20.0);
	CHECK(dry[1] > 195.0);
	const auto reeds = bounds(-0.5, 1.0);
	CHECK(reeds[0] >= 10.0 - 1e-4);
	CHECK(reeds[0] < 10.5);
	CHECK(reeds[1] <= 25.0 + 1e-4);
	CHECK(reeds[1] > 24.5);
	const auto deep = bounds(5.0, unlimited_height);
	CHECK(deep[0] < -195.0);
	CHECK(deep[1] <= -30.0 + 1e-4);
}

TEST_CASE("water: a falloff thins toward the depth's limit") {
	const Slope slope;
	LayerSettings layer = grass();
	layer.rules.water = std::make_shared<WaterLevels>(0.0);
	layer.rules.min_water_depth = -4.0; // The permitted depths cover the area 0 < x < 40.
	layer.rules.water_depth_falloff = 2.0;
	std::array<std::size_t, 4> counts{};
	for (const auto &[id, position] : standing(layer, slope, everything)) {
		++counts[static_cast<std::size_t>(std::clamp(position.x / 10.0, 0.0, 3.0))];
	}
	const double half = static_cast<double>(counts[0] + counts[1]) / 2.0;
	CHECK(counts[0] < counts[1]);
	CHECK(counts[3] < counts[2]);
	CHECK(static_cast<double>(counts[0]) == doctest::Approx(0.5 * half).epsilon(0.15));
}

TEST_CASE("water: a biome's level applies where the biome has the greatest weight, also at its border") {
	const SharedMap map = map_with(2);
	const auto water = levels(map, {1.0, no_water, 7.0}, -3.0);
	for (int i = 0; i < 4000; ++i) {
		const glm::dvec2 at(std::fmod(i * 17.317, 400.0) - 200.0, std::fmod(i * 7.931, 300.0) - 150.0);
		const std::uint8_t biome = map->dominant_at(at);
		const double expected = biome == 0 ? 1.0 : biome == 1 ? no_water : biome == 2 ? 7.0 : -3.0;
		CHECK(water->at(at) == expected);
	}
}

TEST_CASE("water: invalid limits of the water depth are rejected") {
	Rules rules;
	rules.min_water_depth = 1.0; // The maximum is 0 by default.
	CHECK(validate(rules).code == ErrorCode::inverted);
	CHECK(validate(rules).property == std::string("max_water_depth"));
	rules.max_water_depth = 2.0;
	CHECK(validate(rules).ok());
	rules.water_depth_falloff = -1.0;
	CHECK(validate(rules).property == std::string("water_depth_falloff"));
}

TEST_CASE("edits of biomes: a changed pixel, density or biome has no effect outside of its area") {
	LayerSettings before = grass();
	before.rules.edge_feather = 3.0;
	LayerSettings after = before;
	before.rules.biome = densities(map_with(1), {1.0F, 0.0F, 0.0F});
	after.rules.biome = densities(map_with(0), {1.0F, 0.0F, 0.0F});
	check_reach(before, after, ground, 0.2);
	const SharedMap map = map_with(2);
	before.rules.biome = densities(map, {1.0F, 0.0F, 0.0F});
	after.rules.biome = densities(map, {1.0F, 0.0F, 0.8F});
	check_reach(before, after, ground, 0.2);
	CHECK(edits(after, after).empty());
}

TEST_CASE("edits of biomes: also through a layer with spacing from a biome's layer") {
	LayerSettings trees = grass();
	trees.set.layer = 1;
	trees.set.radius = 5.0;
	LayerSettings before = grass();
	LayerSettings after = before;
	trees.rules.biome = densities(map_with(1), {1.0F, 0.0F, 0.0F});
	before.neighbors = {{std::make_shared<LayerSettings>(trees), 4.0, nullptr}};
	trees.rules.biome = densities(map_with(0), {1.0F, 0.0F, 0.0F});
	after.neighbors = {{std::make_shared<LayerSettings>(trees), 4.0, nullptr}};
	check_reach(before, after, ground, 0.2);
}

TEST_CASE("edits of water: only in the biome whose level changes, and only for layers with water rules") {
	const Slope slope;
	const SharedMap map = map_with(2);
	LayerSettings before = grass();
	before.rules.water = levels(map, {no_water, no_water, no_water});
	LayerSettings after = before;
	after.rules.water = levels(map, {no_water, no_water, 9.0});
	check_reach(before, after, slope, 0.2);
	before.rules.max_water_depth = unlimited_height;
	after.rules.max_water_depth = unlimited_height;
	CHECK(edits(before, after).empty());
	ExpressionError error;
	before.rules.expression = after.rules.expression = DensityExpression::compile("water_depth < 2", error);
	CHECK_FALSE(edits(before, after).empty());
	before.rules.expression = after.rules.expression = DensityExpression::compile("height < 2", error);
	CHECK(edits(before, after).empty());
	after.rules.max_water_depth = before.rules.max_water_depth = 0.0;
	after.rules.water = std::make_shared<WaterLevels>(4.0);
	before.rules.water = nullptr;
	CHECK(edits(before, after).everywhere);
}
