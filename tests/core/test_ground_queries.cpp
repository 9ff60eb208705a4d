// Tests the ground queries of tiles: normals and textures are queried only where something uses
// them.

#include "core/explain/density_probe.hpp"
#include "counted_threads.hpp"
#include "rounding.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <memory>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

/// Counts the positions of each kind of query.
class CountingHills final : public Terrain {
public:
	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override {
		with_normals += positions.size();
		return hills_.sample(positions, r_ground);
	}

	Status sample_heights(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override {
		heights_alone += positions.size();
		std::vector<Ground> ground(positions.size());
		const Status status = hills_.sample(positions, ground);
		for (std::size_t i = 0; i < ground.size(); ++i) {
			r_ground[i].height = ground[i].height;
		}
		return status;
	}

	Status weigh(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
			std::span<Ground> r_ground) const override {
		weighed += positions.size();
		return hills_.weigh(positions, textures, r_ground);
	}

	mutable std::size_t with_normals = 0;
	mutable std::size_t heights_alone = 0;
	mutable std::size_t weighed = 0;

private:
	Heightfield hills_ = hills();
};

constexpr std::size_t for_origin = 5;

LayerSettings upright_layer() {
	LayerSettings layer = rich_layer();
	layer.rules.max_slope_degrees = 90.0;
	layer.placement.align_to_normal = 0.0;
	return layer;
}

/// Checks that hills which return normals only on request produce the same tile as hills that
/// always return them.
void check_same_transforms(const LayerSettings &layer, const CountingHills &ground) {
	const TileInstances tile = built(layer, ground, tile_of_hills);
	CHECK(size_of(tile) > 500);
	// This comparison ignores the sign of zeros.
	CHECK(transforms_of(tile) == transforms_of(built(layer, hills(), tile_of_hills)));
}

} // namespace

TEST_CASE("ground: a layer that is upright on any slope queries no normals") {
	const CountingHills ground;
	check_same_transforms(upright_layer(), ground);
	CHECK(ground.with_normals == 0);
	CHECK(ground.heights_alone > for_origin);
}

TEST_CASE("ground: normals are queried if a placement, a source or a rule uses them") {
	std::vector<LayerSettings> layers(5, upright_layer());
	layers[0].placement.align_to_normal = 0.25;
	layers[1].placement.offset_along_normal = -0.5;
	layers[2].instance_data.use_custom_data = true;
	layers[2].instance_data.variation.kind = SourceKind::slope;
	layers[2].instance_data.variation.max = 45.0;
	layers[3].rules.max_slope_degrees = 45.0;
	CurveTable curve;
	REQUIRE(curve.set(0.0, 90.0, std::vector<float>{1.0f, 0.5f, 0.0f}).ok());
	layers[4].rules.slope_curve = std::make_shared<const CurveTable>(curve);
	for (std::size_t i = 0; i < layers.size(); ++i) {
		CAPTURE(i);
		const CountingHills ground;
		check_same_transforms(layers[i], ground);
		CHECK(ground.with_normals > 500);
		CHECK(ground.heights_alone == for_origin);
	}
}

TEST_CASE("ground: edges are probed without normals if no rule of the layer uses the slope") {
	LayerSettings layer = upright_layer();
	layer.placement.align_to_normal = 1.0;
	layer.rules.edge_feather = 4.0;
	const CountingHills ground;
	check_same_transforms(layer, ground);
	CHECK(ground.with_normals > 500);
	CHECK(ground.heights_alone == 16 * ground.with_normals + for_origin);
}

TEST_CASE("ground: of the neighbor layers, only those with a slope rule query normals") {
	LayerSettings layer = upright_layer();
	auto neighbor_layer = std::make_shared<LayerSettings>(upright_layer());
	neighbor_layer->set.layer = 4;
	neighbor_layer->placement.align_to_normal = 1.0; // Only the positions of this layer matter, not its orientation.
	layer.neighbors = {{neighbor_layer, 1.0, nullptr}};
	const CountingHills ground;
	check_same_transforms(layer, ground);
	CHECK(ground.with_normals == 0);
	neighbor_layer->rules.max_slope_degrees = 40.0;
	const CountingHills steep;
	check_same_transforms(layer, steep);
	CHECK(steep.with_normals > 500);
}

TEST_CASE("ground: an explanation includes the normal, even if the layer does not use it") {
	const std::vector<glm::dvec2> positions{{10.0, 10.0}, {-20.0, 30.0}};
	DensityProbe probe;
	REQUIRE(probe.find(upright_layer(), positions, true).ok());
	for (const GroundQuery &query : probe.queries()) {
		CHECK(query.needs.normals);
	}
}

TEST_CASE("ground: texture weights are queried only for layers with a texture rule") {
	LayerSettings layer = upright_layer();
	const CountingHills ground;
	check_same_transforms(layer, ground);
	CHECK(ground.weighed == 0);
	layer.rules.ground_textures = {2};
	check_same_transforms(layer, ground); // These hills have no textures, so all positions are permitted.
	CHECK(ground.weighed > 500);
}

TEST_CASE("ground: once a rule excludes a position, no other rule or source is evaluated") {
	// Computing the shape's depth rounds; the rules before it do not.
	LayerSettings layer;
	layer.rules.min_height = 10.0;
	Shape sphere;
	sphere.kind = ShapeKind::sphere;
	sphere.center = {0.3, 0.1, 0.2};
	sphere.half_size = {7.7, 0.0, 0.0};
	sphere.falloff = 20.3;
	ShapeSet shapes;
	REQUIRE(shapes.set({sphere}).ok());
	layer.rules.shapes = std::make_shared<const ShapeSet>(shapes);
	auto trees = std::make_shared<LayerSettings>();
	trees->set = {.seed = 3, .radius = 1.0, .layer = 2};
	layer.instance_data.use_colors = true;
	layer.instance_data.colors = std::make_shared<const ColorTable>(16, glm::vec4(1.0f));
	layer.instance_data.color.kind = SourceKind::distance;
	layer.instance_data.color.layer = trees;
	layer.instance_data.color.max = 6.0;
	DensityProbe probe;
	REQUIRE(probe.find(layer, std::vector<glm::dvec2>{{1.0, 2.0}}).ok());
	CHECK(probe.positions().size() == 1); // No positions of trees are queried.
	const auto computes_shape = [&probe](float height) {
		double density = 0.0;
		REQUIRE(probe.evaluate(std::vector<Ground>{{height}}).ok());
		const bool computed = rounds([&] { density = probe.density_at(0); });
		CHECK(density < 1.0);
		return computed;
	};
	CHECK_FALSE(computes_shape(8.0f));
	CHECK(computes_shape(10.0f));
}

TEST_CASE("ground: lent threads share the points of a large rectangle whose ground the caller queries") {
	CountedThreads threads(2);
	TileBuilder builder;
	REQUIRE(builder.find_points(upright_layer(), {{-200.0, -190.0}, {200.0, 190.0}}, nullptr, &threads).ok());
	CHECK(threads.runs > 0);
	const std::vector<glm::dvec2> all_positions(builder.positions().begin(), builder.positions().end());
	REQUIRE(builder.find_points(upright_layer(), {{-200.0, -190.0}, {200.0, 190.0}}).ok());
	CHECK(std::ranges::equal(builder.positions(), all_positions));
}
