// What tiles ask of the ground: normals only where somebody looks at them.

#include "core/placement/density_probe.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

/// Counts the positions of each kind of question.
class AskedHills final : public Terrain {
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

	mutable std::size_t with_normals = 0;
	mutable std::size_t heights_alone = 0;

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

/// A tile of hills that tell no normals where none are asked for stands as one of hills that always do.
void check_stands_the_same(const LayerSettings &layer, const AskedHills &asked) {
	const TileInstances tile = built(layer, asked, tile_of_hills);
	CHECK(size_of(tile) > 500);
	CHECK(transforms_of(tile) ==
			transforms_of(built(layer, hills(), tile_of_hills))); // A zero equals one of the other sign.
}

} // namespace

TEST_CASE("ground: a layer that stands upright on any slope asks for no normal") {
	const AskedHills ground;
	check_stands_the_same(upright_layer(), ground);
	CHECK(ground.with_normals == 0);
	CHECK(ground.heights_alone > for_origin);
}

TEST_CASE("ground: normals are asked for where a placement, a look or a rule follows them") {
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
		const AskedHills ground;
		check_stands_the_same(layers[i], ground);
		CHECK(ground.with_normals > 500);
		CHECK(ground.heights_alone == for_origin);
	}
}

TEST_CASE("ground: an edge is looked for without normals where no rule of the layer looks at a slope") {
	LayerSettings layer = upright_layer();
	layer.placement.align_to_normal = 1.0;
	layer.rules.edge_feather = 4.0;
	const AskedHills ground;
	check_stands_the_same(layer, ground);
	CHECK(ground.with_normals > 500);
	CHECK(ground.heights_alone == 16 * ground.with_normals + for_origin);
}

TEST_CASE("ground: of the layers around only those with a rule for the slope ask for normals") {
	LayerSettings layer = upright_layer();
	auto around = std::make_shared<LayerSettings>(upright_layer());
	around->set.layer = 4;
	around->placement.align_to_normal = 1.0; // Nobody sees how it stands.
	layer.neighbors = {{around, 1.0, nullptr}};
	const AskedHills ground;
	check_stands_the_same(layer, ground);
	CHECK(ground.with_normals == 0);
	around->rules.max_slope_degrees = 40.0;
	const AskedHills steep;
	check_stands_the_same(layer, steep);
	CHECK(steep.with_normals > 500);
}

TEST_CASE("ground: an explanation knows the normal whatever the layer looks at") {
	const std::vector<glm::dvec2> places{{10.0, 10.0}, {-20.0, 30.0}};
	DensityProbe probe;
	REQUIRE(probe.find(upright_layer(), places).ok());
	for (const GroundQuery &query : probe.queries()) {
		CHECK(query.normals);
	}
}
