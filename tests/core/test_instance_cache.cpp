// Tests the cache of layers after their rules, which the tiles of layers that fill gaps use.

#include "core/placement/instance_cache.hpp"

#include "core/placement/parallel_tile_builder.hpp"
#include "core/placement/tile_builder.hpp"
#include "core/rules/curve_table.hpp"
#include "core/sampling/block_cache.hpp"
#include "core/terrain/combined_terrain.hpp"
#include "core/terrain/flat_terrain.hpp"
#include "counted_threads.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

using Layers = std::vector<std::shared_ptr<LayerSettings>>;

void fill_around(LayerSettings &r_layer, std::shared_ptr<const LayerSettings> other, double distance) {
	r_layer.neighbors.push_back({std::move(other), distance, nullptr});
	r_layer.spacing_fills = true;
}

/// Returns a forest: each layer keeps a distance from all earlier ones, and all but the grass fill.
/// `edit` may change the layers before the next one refers to them.
Layers forest(const std::function<void(LayerSettings &)> &edit = {}) {
	struct Species {
		double radius;
		double density;
		double distance;
	};
	Layers layers;
	for (const Species &species : {Species{6.0, 0.7, 0.0}, Species{4.0, 0.6, 4.0}, Species{3.0, 0.8, 2.0},
				 Species{1.5, 1.0, 1.5}, Species{0.8, 1.0, 0.5}}) {
		auto layer = std::make_shared<LayerSettings>();
		const auto layer_index = static_cast<std::uint16_t>(layers.size());
		layer->set = {.seed = 7, .radius = species.radius, .levels = layer_index % 2 + 1u, .layer = layer_index};
		layer->rules.density = species.density;
		layer->rules.max_slope_degrees = 50.0;
		layer->rules.slope_falloff_degrees = 10.0;
		layer->placement.align_to_normal = 0.5;
		for (const std::shared_ptr<LayerSettings> &existing : layers) {
			fill_around(*layer, existing, species.distance);
		}
		layer->spacing_fills = layer_index > 0 && layer_index < 4;
		if (edit) {
			edit(*layer);
		}
		layers.push_back(std::move(layer));
	}
	return layers;
}

/// Returns the digests and counts of some tiles of the last layers, beginning with the last one. They
/// depend on all earlier layers. The tiles of some layers come from the cache themselves.
std::vector<std::uint64_t> digests(TileBuilder &builder, const Layers &layers, const Terrain &terrain) {
	std::vector<std::uint64_t> result;
	for (std::size_t i = layers.size(); i-- > 2;) {
		const double size = i == 2 ? 64.0 : 24.0;
		for (const glm::dvec2 at : {glm::dvec2(0.0, 0.0), {1.0, 0.0}, {-1.0, -1.0}}) {
			TileInstances tile;
			REQUIRE(builder.build(*layers[i], terrain, {size * at, size * (at + 1.0)}, tile).ok());
			result.insert(result.end(), {digest(tile), tile.counts.sampled, tile.counts.dense, tile.counts.placed});
		}
	}
	return result;
}

std::vector<std::uint64_t> fresh_digests(const Layers &layers, const Terrain &terrain) {
	TileBuilder builder;
	return digests(builder, layers, terrain);
}

/// Hills whose height a test may change at any time, as a script may.
class ChangingHills final : public Terrain {
public:
	std::uint64_t version() const override { return 0; }

	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override {
		const Status status = hills_.sample(positions, r_ground);
		for (Ground &ground : r_ground) {
			ground.height = rise_ - ground.height;
		}
		return status;
	}

	void rise(float height) { rise_ += height; }

private:
	Heightfield hills_ = hills();
	float rise_ = 0.0f;
};

} // namespace

TEST_CASE("instance cache: tiles have the same bits with and without a cache, in any order and on any threads") {
	const Heightfield terrain = hills();
	const Layers layers = forest();
	const std::vector<std::uint64_t> expected = fresh_digests(layers, terrain);
	const auto blocks = std::make_shared<BlockCache>();
	for (const std::size_t bytes : {std::size_t{0}, std::size_t{600} << 10, InstanceCache::default_bytes}) {
		const auto cache = std::make_shared<InstanceCache>(bytes);
		TileBuilder builder({}, blocks, cache);
		CHECK(digests(builder, layers, terrain) == expected);
		CHECK(digests(builder, layers, terrain) == expected);
		CHECK(cache->bytes() <= bytes);
		CHECK((cache->bytes() > 0) == (bytes > 0));
	}
	const auto cache = std::make_shared<InstanceCache>();
	std::array<std::vector<std::uint64_t>, 4> digests_of_thread;
	std::vector<std::jthread> threads;
	for (std::vector<std::uint64_t> &own_digests : digests_of_thread) {
		threads.emplace_back([&] {
			TileBuilder builder({}, blocks, cache);
			own_digests = digests(builder, layers, terrain);
		});
	}
	threads.clear();
	for (const std::vector<std::uint64_t> &own_digests : digests_of_thread) {
		CHECK(own_digests == expected);
	}
}

TEST_CASE("instance cache: a large rectangle has the same bits on several threads with a cache") {
	const Heightfield terrain = hills();
	const Layers layers = forest();
	const Rect rect{{-150.0, -100.0}, {130.0, 90.0}};
	for (const std::shared_ptr<LayerSettings> &layer : {layers[1], layers[2], layers[3]}) {
		TileBuilder builder({}, nullptr, std::make_shared<InstanceCache>());
		CountedThreads threads(3);
		TileInstances tile;
		REQUIRE(builder.build(*layer, terrain, rect, tile, nullptr, &threads).ok());
		CHECK(digest(tile) == digest(built(*layer, terrain, rect)));
	}
}

TEST_CASE("instance cache: no edit of a rule, link, shape, seed or mesh of any layer serves former instances") {
	const Heightfield terrain = hills();
	TileBuilder builder({}, std::make_shared<BlockCache>(), std::make_shared<InstanceCache>());
	Shape clearing;
	clearing.kind = ShapeKind::sphere;
	clearing.exclude = true;
	clearing.center = {10.0, 30.0, 20.0};
	clearing.half_size = {25.0, 0.0, 0.0};
	const auto shapes = std::make_shared<ShapeSet>();
	REQUIRE(shapes->set({clearing}).ok());
	const std::vector<std::uint64_t> before = digests(builder, forest(), terrain);
	using Edit = std::function<void(LayerSettings &)>;
	const Edit edits[] = {
			[](LayerSettings &layer) { layer.rules.density *= 0.8; },
			[](LayerSettings &layer) { layer.rules.max_slope_degrees = 30.0; },
			[](LayerSettings &layer) { layer.rules.min_height = 20.0; },
			[](LayerSettings &layer) { layer.rules.clumping = {40.0, 0.5, 0.5}; },
			[](LayerSettings &layer) { layer.rules.edge_feather = 3.0; },
			[&](LayerSettings &layer) { layer.rules.shapes = shapes; },
			[](LayerSettings &layer) { layer.set.seed += 1; },
			[](LayerSettings &layer) { layer.set.radius *= 1.1; },
			[](LayerSettings &layer) { layer.spacing_fills = false; },
			[](LayerSettings &layer) { layer.placement.min_scale = 0.5; },
			[](LayerSettings &layer) {
				for (Neighbor &neighbor : layer.neighbors) {
					neighbor.distance *= 0.9;
				}
			},
	};
	for (const Edit &edit : edits) {
		for (const std::uint16_t layer_index : {std::uint16_t{0}, std::uint16_t{3}}) {
			const Layers layers = forest([&](LayerSettings &layer) {
				if (layer.set.layer == layer_index) {
					edit(layer);
				}
			});
			const std::vector<std::uint64_t> rebuilt_digests = digests(builder, layers, terrain);
			CHECK(rebuilt_digests == fresh_digests(layers, terrain));
			CHECK((layer_index == 0 || rebuilt_digests != before));
		}
	}
	CHECK(digests(builder, forest(), terrain) == before);
}

TEST_CASE("instance cache: edited ground, copied ground and ground that changes by itself have their own instances") {
	const Layers layers = forest();
	TileBuilder builder({}, std::make_shared<BlockCache>(), std::make_shared<InstanceCache>());
	const Heightfield before = hills();
	Heightfield after = before;
	CHECK(after.version() != before.version());
	const std::vector<std::uint16_t> raised(400, 30000);
	REQUIRE(after.patch({{20, 10}, {40, 30}}, raised).ok());
	const std::vector<std::uint64_t> first = digests(builder, layers, before);
	CHECK(first == fresh_digests(layers, before));
	CHECK(digests(builder, layers, after) == fresh_digests(layers, after));
	CHECK(digests(builder, layers, after) != first);
	CHECK(digests(builder, layers, before) == first);

	ChangingHills changing;
	for (int step = 0; step < 2; ++step) {
		CHECK(digests(builder, layers, changing) == fresh_digests(layers, changing));
		changing.rise(60.0f);
	}
	CombinedTerrain combined;
	const auto terrain_part = std::make_shared<ChangingHills>();
	REQUIRE(combined.set(std::array<CombinedTerrain::Part, 2>{terrain_part, std::make_shared<FlatTerrain>(-20.0f)})
					.ok());
	CHECK(combined.version() == 0);
	REQUIRE(combined.set(std::array<CombinedTerrain::Part, 1>{std::make_shared<FlatTerrain>(3.0f)}).ok());
	CHECK(combined.version() != 0);
}

TEST_CASE("instance cache: assigned ground and copied settings get a new number, and compare equal") {
	Heightfield ground = hills();
	const std::uint64_t version = ground.version();
	ground = hills();
	CHECK(ground.version() != version);
	const LayerSettings layer = *forest()[1];
	const LayerSettings copy = layer;
	CHECK(copy.number.value() != layer.number.value());
	CHECK(copy == layer);
}

TEST_CASE(
		"instance cache: layers beside fields, surfaces and color sources take what the cache lacks from the points") {
	const Heightfield terrain = hills();
	Layers layers = forest();
	const auto near_curve = std::make_shared<CurveTable>();
	auto mushrooms = std::make_shared<LayerSettings>(*layers[4]);
	mushrooms->set.layer = 9;
	mushrooms->neighbors = {{layers[2], 6.0, near_curve}};
	mushrooms->instance_data.use_colors = true;
	mushrooms->instance_data.colors = std::make_shared<const ColorTable>(256, glm::vec4(0.5f));
	mushrooms->instance_data.color.kind = SourceKind::distance;
	mushrooms->instance_data.color.max = 30.0;
	mushrooms->instance_data.color.layer = layers[1];
	layers.push_back(mushrooms);
	auto colored = std::make_shared<LayerSettings>(*layers[2]);
	colored->instance_data = mushrooms->instance_data;
	layers.push_back(colored);
	TileBuilder builder({}, std::make_shared<BlockCache>(), std::make_shared<InstanceCache>());
	CHECK(digests(builder, layers, terrain) == fresh_digests(layers, terrain));
}

TEST_CASE("instance cache: errors and cancellation are those of a tile without a cache, and leave no block claimed") {
	const Heightfield terrain = hills();
	const Layers layers = forest();
	const auto cache = std::make_shared<InstanceCache>();
	TileBuilder builder({}, nullptr, cache);
	TileInstances tile;
	std::atomic<bool> cancel = true;
	CHECK(builder.build(*layers[2], terrain, tile_of_hills, tile, &cancel).code == ErrorCode::cancelled);
	const double limit = set_extent(layers[2]->set);
	for (const Rect &rect : {Rect{{0.0, 0.0}, {1e9, 1.0}}, Rect{{0.0, 0.0}, {0.0, NAN}},
				 Rect{{limit - 20.0, 0.0}, {limit + 1e4, 9.0}}}) {
		const Status expected = TileBuilder().build(*layers[2], terrain, rect, tile);
		const Status status = builder.build(*layers[2], terrain, rect, tile);
		CHECK_FALSE(expected.ok());
		CHECK(status.code == expected.code);
		CHECK(status.property == expected.property);
	}
	CHECK(digests(builder, layers, terrain) == fresh_digests(layers, terrain));

	InstanceCache::Key key{1, 2, {3, 4}};
	{
		InstanceCache::Claim first, second;
		CHECK(cache->find(key, first) == nullptr);
		CHECK(cache->find(key, second) == nullptr);
		CHECK((first && !second));
	}
	InstanceCache::Claim third;
	CHECK(cache->find(key, third) == nullptr);
	CHECK(static_cast<bool>(third));
}

TEST_CASE("instance cache: adjacent tiles generate no point of an earlier layer twice") {
	const Heightfield terrain = hills();
	const Layers layers = forest();
	TileBuilder builder({}, nullptr, std::make_shared<InstanceCache>());
	TileInstances tile;
	REQUIRE(builder.build(*layers[2], terrain, {{0.0, 0.0}, {32.0, 32.0}}, tile).ok());
	CHECK(builder.sample_stats().computed > 100);
	REQUIRE(builder.build(*layers[2], terrain, {{32.0, 0.0}, {64.0, 32.0}}, tile).ok());
	CHECK(builder.sample_stats().computed == 0);
}
