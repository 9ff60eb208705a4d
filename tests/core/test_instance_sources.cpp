// Tests the sources of colors and variations: their ranges, the distance at which a layer queries
// its neighbors, errors, and the area that an edit affects.

#include "core/placement/layer_edits.hpp"
#include "core/placement/layer_graph.hpp"
#include "refusal.hpp"
#include "sources_fixture.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <span>

using namespace thicket;
using namespace thicket::test;

TEST_CASE("sources: a fraction is linear between the ends of its range, which may be a step") {
	const InstanceSource range{.kind = SourceKind::height, .min = -10.0, .max = 30.0};
	CHECK(fraction_of(range, -1e9) == 0.0f);
	CHECK(fraction_of(range, -10.0) == 0.0f);
	CHECK(fraction_of(range, 0.0) == 0.25f);
	CHECK(fraction_of(range, 30.0) == 1.0f);
	CHECK(fraction_of(range, 1e9) == 1.0f);
	const InstanceSource step{.kind = SourceKind::distance, .min = 5.0, .max = 5.0};
	CHECK(fraction_of(step, 4.999) == 0.0f);
	CHECK(fraction_of(step, 5.0) == 1.0f);
	CHECK(fraction_of(step, 5.001) == 1.0f);
}

TEST_CASE("sources: randomness blends from the fraction to the random number, within 0 to 1") {
	InstanceSource source{.kind = SourceKind::height};
	CHECK(mixed(source, 0.5f, 0.9) == 0.5);
	CHECK(mixed(source, unknown_fraction, 0.9) == 0.9);
	source.randomness = 1.0;
	CHECK(mixed(source, 0.5f, 0.9) == 0.9);
	for (int step = 0; step <= 100; ++step) {
		source.randomness = step / 100.0;
		CHECK(mixed(source, 0.0f, 0.0) == 0.0);
		CHECK(mixed(source, 1.0f, 1.0 - 0x1p-32) <= 1.0);
		CHECK(mixed(source, 1.0f, 0.0) == doctest::Approx(1.0 - source.randomness));
	}
}

TEST_CASE("sources: a curve maps the fraction, even if it is purely random") {
	const auto falling = std::make_shared<CurveTable>();
	REQUIRE(falling->set(0.0, 1.0, std::array{1.0f, 0.0f}).ok());
	const InstanceSource height{.kind = SourceKind::height, .randomness = 0.5, .curve = falling};
	CHECK(mixed(height, 0.25f, 0.75) == 0.5);
	CHECK(mixed(height, 1.0f, 1.0) == 0.0);
	CHECK(mixed({.curve = falling}, unknown_fraction, 0.25) == 0.75);
}

TEST_CASE("sources: the curve of a random color chooses the color") {
	const auto colors = std::make_shared<ColorTable>(ColorTable{{1, 0, 0, 1}, {0, 1, 0, 1}});
	const auto end = std::make_shared<CurveTable>(); // The default curve is 1 everywhere.
	InstanceData data{.use_colors = true, .colors = colors};
	int first = 0;
	for (std::uint64_t id = 0; id < 64; ++id) {
		std::array<float, 4> color{};
		write_instance_data(data, 1, id, 0, 1.0f, color);
		first += static_cast<int>(color[0]);
		data.color.curve = end;
		write_instance_data(data, 1, id, 0, 1.0f, color);
		CHECK(color[1] == 1.0f);
		data.color.curve = nullptr;
	}
	CHECK(first > 16);
	CHECK(first < 48);
}

TEST_CASE("sources: rules and sources that use the same neighbor sample it once, at the larger distance") {
	LayerSettings layer = layer_with_sources(source_of(SourceKind::distance), source_of(SourceKind::distance));
	layer.instance_data.variation.layer = layer.instance_data.color.layer;
	layer.instance_data.variation.max = 20.0;
	layer.neighbors = {{layer.instance_data.color.layer, 2.0, nullptr}};
	const LayerGraph graph(layer);
	REQUIRE(graph.nodes().size() == 2);
	CHECK(graph.nodes()[0].margin == 20.0);
	CHECK(graph.nodes()[0].max_dependent_distance == 20.0);
	CHECK(reach(layer) == 20.0);
	const double own_count = point_density(layer.set) * 64.0 * 64.0;
	const double oak_count = point_density(oaks()->set) * 104.0 * 104.0;
	CHECK(points_to_sample(layer, 64.0) == doctest::Approx(own_count + oak_count));
}

TEST_CASE("sources: unused sources and the sources of a neighbor cost nothing") {
	LayerSettings layer = layer_with_sources(source_of(SourceKind::distance), source_of(SourceKind::height));
	LayerSettings shrubs = rich_layer();
	shrubs.neighbors = {{std::make_shared<const LayerSettings>(layer), 2.0, nullptr}};
	CHECK(LayerGraph(shrubs).nodes().size() == 2);
	CHECK(reach(shrubs) == 2.0);
	CHECK(LayerGraph(layer).nodes().size() == 2);
	layer.instance_data.colors = nullptr;
	CHECK(LayerGraph(layer).nodes().size() == 1);
	layer.instance_data.colors = palette();
	layer.instance_data.use_colors = false;
	CHECK(LayerGraph(layer).nodes().size() == 1);
	CHECK(reach(layer) == 0.0);
}

TEST_CASE("sources: the error for an invalid range names the property, if the range is used") {
	const auto refuse = [](const InstanceSource &source, ErrorCode code, const char *property, double value) {
		LayerSettings layer = layer_with_sources(source, {});
		check_refused(validate(layer), code, property, value);
		layer.instance_data.use_colors = false;
		CHECK(validate(layer).ok());
	};
	InstanceSource source = source_of(SourceKind::height);
	source.max = 10.0;
	refuse(source, ErrorCode::inverted, "color_value.max_value", 10.0);
	source.max = nan_value;
	refuse(source, ErrorCode::not_finite, "color_value.max_value", nan_value);
	source.max = 100.0;
	source.min = -2e6;
	refuse(source, ErrorCode::out_of_range, "color_value.min_value", -2e6);
	source = source_of(SourceKind::distance);
	source.max = 1001.0;
	refuse(source, ErrorCode::out_of_range, "color_value.max_value", 1001.0);
	source.min = -1.0;
	source.max = 0.0;
	refuse(source, ErrorCode::not_positive, "color_value.max_value", 0.0);
	source = source_of(SourceKind::rank);
	source.randomness = 1.5;
	refuse(source, ErrorCode::out_of_range, "color_value.randomness", 1.5);
	LayerSettings layer = layer_with_sources({}, source);
	check_refused(validate(layer), ErrorCode::out_of_range, "variation_value.randomness", 1.5);
	layer.instance_data.variation = {};
	layer.instance_data.variation.min = 5.0; // A random source ignores its range.
	CHECK(validate(layer).ok());
	auto bad = std::make_shared<LayerSettings>(*oaks());
	bad->set.radius = -2.0;
	source = source_of(SourceKind::distance);
	source.layer = bad;
	check_refused(validate(layer_with_sources(source, {})), ErrorCode::not_positive, "radius", -2.0);
}

TEST_CASE("sources: an error of the noise fails the tile") {
	class Broken final : public DensityField {
	public:
		Status sample(std::span<const glm::dvec2>, std::span<float>) const override {
			return {ErrorCode::missing, "noise", 0.0};
		}
	};
	InstanceSource source = source_of(SourceKind::noise);
	source.noise = std::make_shared<const Broken>();
	const Heightfield terrain = hills();
	TileInstances tile = built(rich_layer(), terrain, tile_of_hills);
	const std::uint64_t before = digest(tile);
	check_refused(TileBuilder().build(layer_with_sources(source, {}), terrain, tile_of_hills, tile), ErrorCode::missing,
			"noise", 0.0);
	CHECK(digest(tile) == before);
}

TEST_CASE("sources: an edit of the layer on which a color depends reaches as far as the source's distance") {
	auto before_oaks = std::make_shared<LayerSettings>(*oaks());
	const auto shape_at = [](double x) {
		Shape shape;
		shape.kind = ShapeKind::sphere;
		shape.exclude = true;
		shape.center = {x, 0.0, 0.0};
		shape.half_size = {2.0, 0.0, 0.0};
		auto set = std::make_shared<ShapeSet>();
		REQUIRE(set->set({shape}).ok());
		return set;
	};
	before_oaks->rules.shapes = shape_at(0.0);
	auto after_oaks = std::make_shared<LayerSettings>(*before_oaks);
	after_oaks->rules.shapes = shape_at(50.0);
	const LayerSettings follower = layer_with_sources(source_of(SourceKind::distance), {});
	const auto layer_with = [&follower](const std::shared_ptr<const LayerSettings> &other) {
		LayerSettings layer = follower;
		layer.instance_data.color.layer = other;
		return layer;
	};
	const LayerSettings before = layer_with(before_oaks);
	LayerSettings after = layer_with(after_oaks);
	const EditedArea area = EditSearch().find(before, after);
	CHECK_FALSE(area.everywhere);
	REQUIRE(area.areas.size() == 2);
	for (const Rect &edited : area.areas) {
		CHECK(edited.size().x == doctest::Approx(2.0 * (2.0 + farthest)).epsilon(0.01));
	}
	// A layer that only keeps a distance from this one is not affected.
	LayerSettings shrubs = rich_layer();
	shrubs.neighbors = {{std::make_shared<const LayerSettings>(before), 2.0, nullptr}};
	LayerSettings later_shrubs = shrubs;
	later_shrubs.neighbors[0].layer = std::make_shared<const LayerSettings>(after);
	CHECK(EditSearch().find(shrubs, later_shrubs).empty());
	after.instance_data.color.max = 8.0;
	CHECK(EditSearch().find(before, after).everywhere);
	after = before;
	after.instance_data.color.layer = nullptr;
	CHECK(EditSearch().find(before, after).everywhere);
	auto otherwise = std::make_shared<LayerSettings>(*before_oaks);
	otherwise->placement.max_scale = 2.0;
	CHECK(EditSearch().find(before, layer_with(otherwise)).empty());
	otherwise->rules.density = 0.5;
	CHECK(EditSearch().find(before, layer_with(otherwise)).everywhere);
}

TEST_CASE("sources: hand-placed instances get the values of their position") {
	const glm::dvec3 position{3.0, 45.0, -7.0};
	const auto fractions = [&](SourceKind kind) {
		return fractions_by_hand(layer_with_sources(source_of(kind), {}).instance_data, position, false).color;
	};
	CHECK(fractions(SourceKind::height) == 0.5f);
	CHECK(fractions(SourceKind::rank) == 0.0f);
	const double noise = std::clamp(double{Waves::at({3.0, -7.0})}, 0.0, 1.0);
	CHECK(double{fractions(SourceKind::noise)} ==
			doctest::Approx(expected_fraction(source_of(SourceKind::noise), noise)));
	CHECK(fractions(SourceKind::slope) == unknown_fraction);
	CHECK(fractions(SourceKind::distance) == unknown_fraction);
	CHECK(fractions(SourceKind::random) == unknown_fraction);
	const InstanceData by_height = layer_with_sources(source_of(SourceKind::height), {}).instance_data;
	const Planet planet{{1.0, 2.0, 3.0}, 100.0};
	CHECK(fractions_by_hand(by_height, {1.0, 2.0, -142.0}, true, planet).color == 0.5f);
	CHECK(fractions_by_hand(by_height, {-144.0, 2.0, 3.0}, true, planet).color == 0.5f);
}
