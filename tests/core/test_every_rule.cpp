// What holds for every rule alike: it takes points away and changes nothing else, in tiles of whatever size and order.

#include "core/placement/tile_builder.hpp"
#include "core/rules/image_mask.hpp"
#include "core/terrain/heightfield.hpp"
#include "tests/analysis/curve_table.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

/// Hills whose texture 1 fades from left to right.
class TexturedHills final : public Terrain {
public:
	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override {
		return hills_.sample(positions, r_ground);
	}

	Status weigh(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
			std::span<Ground> r_ground) const override {
		const bool asked = std::find(textures.begin(), textures.end(), 1) != textures.end();
		for (std::size_t i = 0; i < positions.size(); ++i) {
			r_ground[i].weight = asked ? static_cast<float>((positions[i].x + 64.0) / 128.0) : 0.0f;
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
					layer.rules.slope_falloff = 30.0;
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
					Rect changed;
					REQUIRE(mask->reset(0.7, 1.0).ok());
					REQUIRE(mask->paint({Brush::Mode::erase, {-5.0, 66.0}, 28.0, 0.8, 0.2}, changed).ok());
					layer.rules.mask = mask;
				}},
		{"clumps", [](LayerSettings &layer) { layer.rules.clumping = {18.0, 0.5, 0.4}; }},
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

/// Where each instance stands in the world, to 0.1 mm, and its thinning rank: the same from any tile.
std::map<std::uint64_t, std::pair<glm::ivec3, std::uint32_t>> places(
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
	const glm::ivec3 apart = glm::abs(a.first - b.first);
	return std::max({apart.x, apart.y, apart.z}) <= 1 && a.second == b.second;
}

} // namespace

TEST_CASE("every rule: takes points away, and what stays keeps every bit") {
	const TexturedHills terrain;
	const LayerSettings open = plain_layer();
	const Transforms all = transforms_of(built(open, terrain, tile_of_hills));
	for (const NamedRule &rule : every_rule) {
		CAPTURE(rule.name);
		LayerSettings ruled = open;
		rule.add(ruled);
		const Transforms some = transforms_of(built(ruled, terrain, tile_of_hills));
		check_filtered(all, some);
	}
}

TEST_CASE("every rule: tiles of any size, strips and negative ones together hold what one tile holds") {
	const TexturedHills terrain;
	const std::array<glm::dvec2, 3> sizes{glm::dvec2(128.0, 11.0), glm::dvec2(23.5, 40.0), glm::dvec2(64.0, 64.0)};
	for (const NamedRule &rule : every_rule) {
		CAPTURE(rule.name);
		LayerSettings layer = plain_layer();
		rule.add(layer);
		const auto whole = places(layer, terrain, tile_of_hills);
		for (const glm::dvec2 size : sizes) {
			std::size_t count = 0;
			for (double y = tile_of_hills.max.y; y > tile_of_hills.min.y; y -= size.y) {
				for (double x = tile_of_hills.min.x; x < tile_of_hills.max.x; x += size.x) {
					const Rect part{{x, std::max(y - size.y, tile_of_hills.min.y)},
							{std::min(x + size.x, tile_of_hills.max.x), y}};
					for (const auto &[id, place] : places(layer, terrain, part)) {
						const auto found = whole.find(id);
						REQUIRE(found != whole.end());
						CHECK(near(found->second, place));
						++count;
					}
				}
			}
			CHECK(count == whole.size());
		}
	}
}

TEST_CASE("every rule: all of them at once, on several threads, give one digest") {
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
}
