// Tests how models are measured, and how layers are fitted to them.

#include "core/model/model_fit.hpp"

#include <doctest/doctest.h>
#include <glm/common.hpp>

#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

using namespace thicket;

namespace {

using Triangle = std::array<glm::dvec3, 3>;

ModelSize measured(const std::vector<Triangle> &triangles) {
	glm::dvec3 low(1e9);
	glm::dvec3 high(-1e9);
	for (const Triangle &triangle : triangles) {
		for (const glm::dvec3 &corner : triangle) {
			low = glm::min(low, corner);
			high = glm::max(high, corner);
		}
	}
	ModelMeasure measure(low, high);
	for (const Triangle &triangle : triangles) {
		measure.add(triangle);
	}
	return measure.size();
}

/// Appends a closed frustum with eight sides.
void add_frustum(
		std::vector<Triangle> &r_triangles, const glm::dvec3 &foot, double radius, double top_radius, double height) {
	const auto at = [&](int corner, bool top) {
		const double angle = 0.78539816339744831 * corner;
		const double wide = top ? top_radius : radius;
		return foot + glm::dvec3(wide * std::cos(angle), top ? height : 0.0, wide * std::sin(angle));
	};
	for (int corner = 0; corner < 8; ++corner) {
		r_triangles.push_back({at(corner, false), at(corner, true), at(corner + 1, false)});
		r_triangles.push_back({at(corner + 1, false), at(corner, true), at(corner + 1, true)});
		r_triangles.push_back({foot, at(corner, false), at(corner + 1, false)});
		r_triangles.push_back({foot + glm::dvec3(0, height, 0), at(corner + 1, true), at(corner, true)});
	}
}

/// Returns four upright cards that intersect on the y axis.
std::vector<Triangle> cards(double width, double height) {
	std::vector<Triangle> result;
	for (const glm::dvec3 side :
			{glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1), glm::dvec3(0.7, 0, 0.7), glm::dvec3(0.7, 0, -0.7)}) {
		const glm::dvec3 half_extent = side * (0.5 * width);
		const glm::dvec3 up(0, height, 0);
		result.push_back({-half_extent, half_extent, half_extent + up});
		result.push_back({-half_extent, half_extent + up, up - half_extent});
	}
	return result;
}

} // namespace

TEST_CASE("model size: a tree is as wide as its crown, wherever its pivot is") {
	for (const glm::dvec3 pivot : {glm::dvec3(0, 0, 0), glm::dvec3(1.3, 0, -0.4)}) {
		std::vector<Triangle> tree;
		add_frustum(tree, pivot, 0.2, 0.15, 4.0);
		add_frustum(tree, pivot + glm::dvec3(0, 2, 0), 1.2, 1.2, 6.0);
		const ModelSize size = measured(tree);
		CHECK(size.width == doctest::Approx(2.4));
		CHECK(size.footprint == doctest::Approx(2.4));
		CHECK(size.base == doctest::Approx(0.4).epsilon(0.05));
		CHECK(size.height == doctest::Approx(8.0));
		CHECK(kind_of(size) == ModelKind::tree);
	}
}

TEST_CASE("model size: a few far twigs do not keep neighbors away") {
	std::vector<Triangle> tree;
	add_frustum(tree, {0, 0, 0}, 1.0, 1.0, 10.0);
	tree.push_back({glm::dvec3(0, 5, 0), glm::dvec3(1.6, 5.1, 0), glm::dvec3(0, 5.1, 0)});
	tree.push_back({glm::dvec3(0, 5, 0), glm::dvec3(0, 5.1, 1.6), glm::dvec3(0, 5.1, 0)});
	const ModelSize size = measured(tree);
	CHECK(size.width == doctest::Approx(2.6));
	CHECK(size.footprint == doctest::Approx(2.0));
}

TEST_CASE("model size: a long bare trunk does not pull trees together") {
	std::vector<Triangle> palm;
	add_frustum(palm, {0, 0, 0}, 0.2, 0.2, 9.0);
	add_frustum(palm, {0, 9, 0}, 2.0, 2.0, 1.0);
	CHECK(measured(palm).footprint == doctest::Approx(0.6 * 4.0));
}

TEST_CASE("model size: size and enclosed volume determine the kind of a model") {
	std::vector<Triangle> boulder;
	add_frustum(boulder, {0, -0.3, 0}, 1.0, 0.6, 1.5);
	CHECK(kind_of(measured(boulder)) == ModelKind::rock);
	CHECK(measured(boulder).depth == doctest::Approx(0.3));
	CHECK(kind_of(measured(cards(1.5, 1.4))) == ModelKind::shrub);
	CHECK(kind_of(measured(cards(0.6, 0.4))) == ModelKind::grass);
	CHECK(kind_of(measured(cards(3.0, 8.0))) == ModelKind::tree);
}

TEST_CASE("model size: a name determines the kind of a model") {
	using Named = std::pair<const char *, std::optional<ModelKind>>;
	for (const Named &example : {Named("Pine_2b", ModelKind::tree), Named("BirchTree_Autumn_3", ModelKind::tree),
				 Named("DEAD TREES 04", ModelKind::tree), Named("Bush_1_A_Color1", ModelKind::shrub),
				 Named("flower-bushes", ModelKind::shrub), Named("CactusFlowers", ModelKind::grass),
				 Named("moss.001", ModelKind::grass), Named("Grasses", ModelKind::grass),
				 Named("grass-trees-tall", ModelKind::tree), Named("rocks", ModelKind::rock),
				 Named("tree_stump", ModelKind::rock), Named("WoodLog", ModelKind::rock),
				 Named("Fountain", std::nullopt), Named("street", std::nullopt), Named("catalogs", std::nullopt),
				 Named("b\xC3\xA4ume", std::nullopt), Named("42", std::nullopt), Named("", std::nullopt)}) {
		CHECK_MESSAGE(kind_named(example.first) == example.second, example.first);
	}
}

TEST_CASE("model size: copies differ, have space between them and reach into the ground") {
	std::vector<Triangle> boulder;
	add_frustum(boulder, {0, 0, 0}, 1.0, 0.6, 1.5);
	const ModelSize size = measured(boulder);
	for (const ModelKind kind : {ModelKind::tree, ModelKind::shrub, ModelKind::grass, ModelKind::rock}) {
		const ModelFit fit = fit_of(kind, size);
		CHECK(fit.min_scale < 1.0);
		CHECK(fit.max_scale > 1.0);
		CHECK(fit.max_tilt_degrees > 0.0);
		CHECK(fit.radius > 0.0);
		CHECK(fit.density > 0.0);
		CHECK(fit.density <= 1.0);
		CHECK(fit.height_offset < 0.0);
		CHECK(fit.height_offset > -0.5 * size.height);
	}
	// Rocks are sparse, so most of the ground is free of them.
	CHECK(fit_of(ModelKind::rock, size).radius > 1.5 * size.footprint);
	CHECK(fit_of(ModelKind::rock, size).clump_size > 0.0);
	// A model that already has roots below the ground is not sunk any deeper.
	ModelSize rooted = size;
	rooted.depth = 1.0;
	CHECK(fit_of(ModelKind::tree, rooted).height_offset == 0.0);
}

TEST_CASE("model size: flat and empty models have sizes") {
	const ModelSize nothing = ModelMeasure({0, 0, 0}, {0, 0, 0}).size();
	CHECK(nothing.width == 0.0);
	CHECK(nothing.fill == 0.0);
	const ModelSize leaf = measured({Triangle{glm::dvec3(0, 0, 0), glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1)}});
	CHECK(leaf.width == doctest::Approx(1.0));
	CHECK(leaf.footprint == doctest::Approx(1.0));
	CHECK(leaf.fill == 0.0);
}
