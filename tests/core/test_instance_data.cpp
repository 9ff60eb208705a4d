#include "core/placement/instance_data.hpp"
#include "core/placement/mesh_choice.hpp"
#include "core/rules/instance_random.hpp"
#include "placement_fixture.hpp"
#include "refusal.hpp"
#include "tile_fixture.hpp"

#include <doctest/doctest.h>

#include <glm/matrix.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

using namespace thicket;
using namespace thicket::test;

namespace {

/// Returns distinct colors. Half floats represent all components exactly.
std::shared_ptr<const ColorTable> palette(std::size_t count) {
	ColorTable colors;
	for (std::size_t i = 0; i < count; ++i) {
		colors.emplace_back(static_cast<float>(i), 0.25f, 0.5f, 1.0f);
	}
	return std::make_shared<const ColorTable>(std::move(colors));
}

LayerSettings colored_layer() {
	LayerSettings layer = rich_layer();
	layer.instance_data = {true, palette(5), true};
	return layer;
}

/// Returns the Kolmogorov-Smirnov distance to the uniform distribution.
double unevenness(std::vector<double> values) {
	std::ranges::sort(values);
	double worst = 0.0;
	for (std::size_t i = 0; i < values.size(); ++i) {
		worst = std::max(worst, std::abs(values[i] - static_cast<double>(i) / static_cast<double>(values.size())));
	}
	return worst;
}

} // namespace

TEST_CASE("placement: the tilt leans away from the instance's up axis, uniformly in angle and direction") {
	std::mt19937 random(5);
	Placement placement;
	placement.min_tilt_degrees = 10.0;
	placement.max_tilt_degrees = 40.0;
	for (const double align : {0.0, 1.0}) {
		placement.align_to_normal = align;
		constexpr int tries = 20000;
		double lowest = 90.0;
		double highest = 0.0;
		double sum = 0.0;
		glm::dvec3 lean(0.0);
		for (std::uint64_t id = 0; id < tries; ++id) {
			const glm::vec3 normal = random_normal(random);
			const glm::dvec3 own_up = glm::normalize(align == 0.0 ? glm::dvec3(up) : glm::dvec3(normal));
			const glm::dmat3 basis = transform_of(placement, id, normal).basis;
			const double angle = std::acos(glm::dot(basis[1], own_up)) * 180.0 / std::numbers::pi;
			lowest = std::min(lowest, angle);
			highest = std::max(highest, angle);
			sum += angle;
			const glm::dvec3 tangential = basis[1] - own_up * glm::dot(basis[1], own_up);
			lean += glm::normalize(tangential);
			CHECK(glm::determinant(basis) == doctest::Approx(1.0).epsilon(1e-5));
			CHECK(std::abs(glm::dot(basis[0], basis[1])) < 1e-6);
			CHECK(std::abs(glm::dot(basis[1], basis[2])) < 1e-6);
		}
		CHECK(lowest > 10.0 - 1e-3);
		CHECK(lowest < 10.1);
		CHECK(highest < 40.0 + 1e-3);
		CHECK(highest > 39.9);
		// Four standard errors of the mean of `tries` angles that are uniform over 30 degrees, and
		// of `tries` directions.
		CHECK(std::abs(sum / tries - 25.0) < 4.0 * 30.0 / std::sqrt(12.0 * tries));
		CHECK(glm::length(lean) / tries < 4.0 / std::sqrt(double{tries}));
	}
}

TEST_CASE("placement: a tilt of 90 degrees is horizontal, and stays a rotation on any ground") {
	std::mt19937 random(6);
	Placement placement;
	placement.min_tilt_degrees = placement.max_tilt_degrees = 90.0;
	for (std::uint64_t id = 0; id < 1000; ++id) {
		CHECK(std::abs(transform_of(placement, id).basis[1].y) < 1e-6);
	}
	placement.align_to_normal = 1.0;
	for (std::uint64_t id = 0; id < 1000; ++id) {
		const glm::vec3 normal = random_normal(random);
		const glm::dmat3 basis = transform_of(placement, id, normal).basis;
		CHECK(std::abs(glm::dot(basis[1], glm::dvec3(normal))) < 1e-6);
		CHECK(glm::determinant(basis) == doctest::Approx(1.0).epsilon(1e-5));
	}
}

TEST_CASE("placement: a tiny tilt equals no tilt") {
	std::mt19937 random(7);
	Placement placement;
	placement.align_to_normal = 0.6;
	Placement tiny = placement;
	tiny.max_tilt_degrees = 1e-300; // Selects the code path with a tilt.
	for (std::uint64_t id = 0; id < 1000; ++id) {
		const glm::vec3 normal = random_normal(random);
		const Transform without_normal = transform_of(placement, id, normal);
		const Transform with_normal = transform_of(tiny, id, normal);
		for (int column = 0; column < 3; ++column) {
			CHECK(glm::distance(without_normal.basis[column], with_normal.basis[column]) < 1e-6);
		}
	}
}

TEST_CASE("placement: the offset along the normal is perpendicular to the ground") {
	std::mt19937 random(8);
	Placement placement;
	placement.offset_along_normal = -2.5;
	const glm::vec3 position(10.0f, -3.0f, 7.0f);
	for (const double align : {0.0, 1.0}) {
		placement.align_to_normal = align;
		for (std::uint64_t id = 0; id < 1000; ++id) {
			const glm::vec3 normal = random_normal(random);
			const Transform transform = transform_of(placement, id, normal, position);
			const glm::dvec3 expected = glm::dvec3(position) - 2.5 * glm::dvec3(normal);
			CHECK(glm::distance(transform.position, expected) < 1e-5);
			// The length of the normal has no effect.
			CHECK(glm::distance(transform_of(placement, id, 3.0f * normal, position).position, expected) < 1e-5);
		}
	}
}

TEST_CASE("placement: the scale curve maps the random number, and nothing else changes") {
	Placement straight;
	straight.min_scale = 1.0;
	straight.max_scale = 3.0;
	Placement bent = straight;
	CurveTable line;
	REQUIRE(line.set(0.0, 1.0, std::vector<float>{0.0f, 1.0f}).ok());
	CurveTable falling;
	REQUIRE(falling.set(0.0, 1.0, std::vector<float>{1.0f, 0.0f, 0.0f}).ok());
	for (std::uint64_t id = 0; id < 1000; ++id) {
		const Transform before = transform_of(straight, id);
		const double random = (double{before.scale} - 1.0) / 2.0;
		bent.scale_curve = std::make_shared<const CurveTable>(line);
		CHECK(double{transform_of(bent, id).scale} == doctest::Approx(double{before.scale}).epsilon(1e-6));
		bent.scale_curve = std::make_shared<const CurveTable>(falling);
		const Transform after = transform_of(bent, id);
		CHECK(double{after.scale} == doctest::Approx(1.0 + 2.0 * std::max(1.0 - 2.0 * random, 0.0)).epsilon(1e-5));
		const double turn = glm::dot(glm::normalize(before.basis[0]), glm::normalize(after.basis[0]));
		CHECK(turn == doctest::Approx(1.0).epsilon(1e-6));
	}
}

TEST_CASE("instance data: numbers are rounded to the nearest half float, which converts back exactly") {
	std::mt19937 random(9);
	// All finite half floats that are not negative, in ascending order, computed from the
	// definition of the format.
	std::vector<double> halves;
	for (int exponent = 0; exponent < 31; ++exponent) {
		for (int mantissa = 0; mantissa < 1024; ++mantissa) {
			halves.push_back(exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024.0 + mantissa, exponent - 25));
		}
	}
	CHECK(halves.back() == double{max_color});
	for (std::size_t i = 0; i < halves.size(); ++i) {
		CHECK(double{rounded_to_half(static_cast<float>(halves[i]))} == halves[i]);
		CHECK(double{rounded_to_half(static_cast<float>(-halves[i]))} == -halves[i]);
		if (i > 0) {
			const double below = halves[i - 1];
			const double step = halves[i] - below;
			CHECK(double{rounded_to_half(static_cast<float>(below + 0.49 * step))} == below);
			CHECK(double{rounded_to_half(static_cast<float>(below + 0.51 * step))} == halves[i]);
			CHECK(double{rounded_to_half(static_cast<float>(below + 0.5 * step))} == (i % 2 == 0 ? halves[i] : below));
		}
	}
}

TEST_CASE("instance data: the floats per instance depend on the data in use") {
	CHECK(floats_per_instance({}) == 12);
	CHECK(floats_per_instance({.use_colors = true}) == 16);
	CHECK(floats_per_instance({.use_custom_data = true}) == 16);
	CHECK(floats_per_instance({.use_colors = true, .use_custom_data = true}) == 20);
}

TEST_CASE("instance data: transform, color and custom data are in the engine's order") {
	const std::shared_ptr<const ColorTable> colors = palette(3);
	std::array<float, 8> floats{};
	write_instance_data({true, colors, true}, seed, 77, 0x40000000, 1.5f, floats);
	CHECK(std::ranges::find(*colors, glm::vec4(floats[0], floats[1], floats[2], floats[3])) != colors->end());
	CHECK(floats[6] == 0.25f);
	CHECK(floats[7] == 1.5f);
	std::array<float, 4> custom{};
	write_instance_data({.use_custom_data = true}, seed, 77, 0x40000000, 1.5f, custom);
	CHECK(std::ranges::equal(custom, std::span(floats).last(4)));
	std::array<float, 4> white{};
	write_instance_data({.use_colors = true}, seed, 77, 0, 1.0f, white);
	CHECK(white == std::array{1.0f, 1.0f, 1.0f, 1.0f});
	write_instance_data({}, seed, 77, 0, 1.0f, {});
}

TEST_CASE("instance data: variation, wind phase and color are uniform, and independent of each other and the mesh") {
	constexpr std::size_t tries = 20000;
	const InstanceData data{true, palette(1000), true};
	MeshChoice meshes;
	meshes.set(std::vector<float>{1.0f, 1.0f});
	std::array<std::vector<double>, 4> values; // The first three are uniform in [0, 1), the last is 0 or 1.
	for (std::uint64_t id = 0; id < tries; ++id) {
		std::array<float, 8> floats{};
		write_instance_data(data, seed, id, 0, 1.0f, floats);
		values[0].push_back(double{floats[0]} / 1000.0);
		values[1].push_back(double{floats[4]});
		values[2].push_back(double{floats[5]});
		values[3].push_back(meshes.mesh_for(seed, id) == 0 ? 0.0 : 1.0);
	}
	for (std::size_t i = 0; i < 3; ++i) {
		CHECK(unevenness(values[i]) < 2.2 / std::sqrt(double{tries}) + 1e-3);
	}
	for (std::size_t a = 0; a < values.size(); ++a) {
		for (std::size_t b = 0; b < a; ++b) {
			double product = 0.0;
			for (std::size_t i = 0; i < tries; ++i) {
				product += (values[a][i] - 0.5) * (values[b][i] - 0.5);
			}
			// The variances are 1/12 and 1/12, or 1/4 and 1/12.
			CHECK(std::abs(product) < 4.0 * std::sqrt(tries / (a == 3 ? 48.0 : 144.0)));
		}
	}
}

TEST_CASE("instance data: the error for an invalid table contains its name and value") {
	const auto refuse = [](ColorTable table, ErrorCode code, double value) {
		const InstanceData data{true, std::make_shared<const ColorTable>(std::move(table)), false};
		check_refused(validate(data), code, "colors", value);
	};
	refuse({}, ErrorCode::out_of_range, 0.0);
	refuse(ColorTable(max_colors + 1, glm::vec4(1.0f)), ErrorCode::out_of_range, max_colors + 1.0);
	refuse({glm::vec4(0.5f), {0.5f, std::nanf(""), 0.5f, 1.0f}}, ErrorCode::not_finite, nan_value);
	refuse({{0.5f, 0.5f, 0.5f, -1.0f}}, ErrorCode::out_of_range, -1.0);
	refuse({{7e4f, 0.5f, 0.5f, 1.0f}}, ErrorCode::out_of_range, 7e4);
	CHECK(validate(InstanceData{}).ok());
	CHECK(validate(InstanceData{true, palette(max_colors), true}).ok());
}

TEST_CASE("instance data: colors and custom data change no transform of a tile, and keep its order") {
	const Heightfield terrain = hills();
	const TileInstances plain = built(rich_layer(), terrain, tile_of_hills);
	const TileInstances rich = built(colored_layer(), terrain, tile_of_hills);
	REQUIRE(plain.meshes.size() == rich.meshes.size());
	for (std::size_t mesh = 0; mesh < plain.meshes.size(); ++mesh) {
		const MeshInstances &a = plain.meshes[mesh];
		const MeshInstances &b = rich.meshes[mesh];
		CHECK(a.ids == b.ids);
		CHECK(a.ranks == b.ranks);
		CHECK(a.min == b.min);
		CHECK(a.stride == 12);
		CHECK(b.stride == 20);
		REQUIRE(b.buffer.size() == b.size() * 20);
		CHECK(a.size() > 50);
		for (std::size_t i = 0; i < a.size(); ++i) {
			const auto from = a.buffer.begin() + static_cast<std::ptrdiff_t>(i * 12);
			const auto floats = std::span(b.buffer).subspan(i * 20, 20);
			CHECK(std::equal(from, from + 12, floats.begin()));
			CHECK(double{floats[18]} == doctest::Approx(b.ranks[i] * 0x1p-32).epsilon(1e-3));
			const double scale = std::hypot(floats[0], floats[4], floats[8]);
			CHECK(double{floats[19]} == doctest::Approx(scale).epsilon(1e-3));
		}
	}
}

TEST_CASE("instance data: leaning, colored instances are bit-identical on every machine") {
	Placement placement;
	placement.min_scale = 0.6;
	placement.align_to_normal = 0.4;
	placement.min_tilt_degrees = 2.0;
	placement.max_tilt_degrees = 25.0;
	placement.offset_along_normal = -0.2;
	const InstanceData data{true, palette(7), true};
	constexpr std::size_t stride = 20;
	std::vector<float> buffer(1000 * stride);
	for (std::uint64_t id = 0; id < 1000; ++id) {
		const std::span<float> floats = std::span(buffer).subspan(id * stride, stride);
		const glm::vec3 normal(static_cast<float>(id % 17) * 0.0625f, 1.0f, static_cast<float>(id % 5) * -0.25f);
		const float scale = write_transform(
				placement, seed, id, normal, glm::vec3(1.5f, 20.0f, -3.25f), floats.first<transform_floats>());
		write_instance_data(
				data, seed, id, static_cast<std::uint32_t>(id * 4294967u), scale, floats.subspan(transform_floats));
	}
	CHECK(digest(buffer) == 17214978555663897693u);
}
