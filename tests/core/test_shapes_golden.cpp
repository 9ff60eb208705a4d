#include "core/rules/shapes.hpp"
#include "core/terrain/heightfield.hpp"
#include "core/terrain/triangle_terrain.hpp"
#include "shape_cases.hpp"

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

using namespace thicket;
using namespace thicket::shape_cases;

namespace {

/// An FNV-1a hash of the bits of numbers.
class Digest {
public:
	void add(std::uint64_t bits) {
		for (int byte = 0; byte < 8; ++byte) {
			value_ = (value_ ^ (bits >> (8 * byte) & 0xff)) * 0x100000001b3u;
		}
	}
	void add(double number) { add(std::bit_cast<std::uint64_t>(number)); }
	void add(float number) { add(std::uint64_t{std::bit_cast<std::uint32_t>(number)}); }

	std::uint64_t value() const { return value_; }

private:
	std::uint64_t value_ = 0xcbf29ce484222325u;
};

/// Returns a random number in [-1, 1) that is the same with every standard library.
double symmetric(std::mt19937 &random) { return std::ldexp(static_cast<double>(random()), -31) - 1.0; }

glm::dvec3 vector(std::mt19937 &random) {
	const double x = symmetric(random);
	const double y = symmetric(random);
	return {x, y, symmetric(random)};
}

/// Returns the rotation of a random quaternion, computed without trigonometric functions.
glm::dmat3 turn(std::mt19937 &random) {
	const glm::dvec3 v = vector(random);
	const double w = symmetric(random);
	const double s = 2.0 / (v.x * v.x + v.y * v.y + v.z * v.z + w * w);
	return {{1.0 - s * (v.y * v.y + v.z * v.z), s * (v.x * v.y + v.z * w), s * (v.x * v.z - v.y * w)},
			{s * (v.x * v.y - v.z * w), 1.0 - s * (v.x * v.x + v.z * v.z), s * (v.y * v.z + v.x * w)},
			{s * (v.x * v.z + v.y * w), s * (v.y * v.z - v.x * w), 1.0 - s * (v.x * v.x + v.y * v.y)}};
}

void add(Digest &r_digest, const Ground &ground) {
	const bool is_hole = std::isnan(ground.height); // NaN has many bit patterns.
	r_digest.add(is_hole ? -1e9f : ground.height);
	r_digest.add(ground.normal.x);
	r_digest.add(ground.normal.y);
	r_digest.add(ground.normal.z);
	r_digest.add(ground.weight);
}

} // namespace

TEST_CASE("golden: shapes of all kinds are bit-identical with every compiler and on every machine") {
	std::mt19937 random(1);
	Digest digest;
	for (int i = 0; i < 200; ++i) {
		Shape shape;
		shape.kind = static_cast<ShapeKind>(i % 5);
		shape.ignore_height = i % 2 == 0;
		shape.falloff = 4.0;
		shape.center = 5.0 * vector(random);
		shape.axes = turn(random);
		shape.half_size = 12.0 + 7.0 * vector(random);
		for (int k = 0; k < 40; ++k) {
			const double x = 30.0 * symmetric(random);
			shape.outline.emplace_back(x, 30.0 * symmetric(random));
		}
		const ShapeSet set = set_of({shape});
		for (int k = 0; k < 50; ++k) {
			digest.add(density_of(set, 20.0 * vector(random)));
		}
	}
	CHECK(digest.value() == 14724566284880518624u);
}

TEST_CASE("golden: ground from triangles and from samples in meters is bit-identical everywhere") {
	std::mt19937 random(2);
	std::vector<glm::dvec3> corners;
	for (int i = 0; i < 900; ++i) {
		corners.push_back(glm::dvec3(50.0, 10.0, 30.0) * vector(random));
	}
	TriangleTerrain triangles;
	REQUIRE(triangles.set(corners).ok());
	std::vector<float> posts;
	for (int i = 0; i < 20 * 10; ++i) {
		const auto height = static_cast<float>(100.0 * symmetric(random));
		posts.push_back(i % 23 == 5 ? std::numeric_limits<float>::quiet_NaN() : height);
	}
	Heightfield field;
	REQUIRE(field.set_meters({{20, 10}, {{-50.0, -30.0}, {50.0, 30.0}}, 0.0, 1.0}, posts).ok());
	WeightMap weights;
	REQUIRE(weights.set({3, 2}, 2, std::vector<std::uint8_t>{3, 200, 17, 99, 255, 0, 41, 5, 0, 64, 128, 77}).ok());
	field.set_weights(weights);
	Digest digest;
	for (int i = 0; i < 4000; ++i) {
		const double x = 55.0 * symmetric(random);
		const glm::dvec2 position(x, 35.0 * symmetric(random));
		add(digest, triangles.at(position));
		Ground ground = field.at(position);
		const std::int32_t texture = i % 3;
		REQUIRE(field.weigh({&position, 1}, {&texture, 1}, {&ground, 1}).ok());
		add(digest, ground);
	}
	CHECK(digest.value() == 14594324683184786369u);
}
