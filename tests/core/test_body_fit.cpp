#include "core/near/body_fit.hpp"

#include <doctest/doctest.h>

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

using namespace thicket;

namespace {

glm::mat3 random_rotation(std::mt19937_64 &random) {
	std::uniform_real_distribution<float> along(-1.0f, 1.0f);
	const glm::vec3 axis = glm::normalize(glm::vec3(along(random), along(random), along(random)) + 1e-3f);
	return glm::mat3(glm::rotate(glm::mat4(1.0f), 3.1f * along(random), axis));
}

glm::mat3 scaled(const glm::mat3 &rotation, glm::vec3 scale) {
	return {rotation[0] * scale.x, rotation[1] * scale.y, rotation[2] * scale.z};
}

void check_close(glm::vec3 a, glm::vec3 b, float tolerance) { CHECK(glm::length(a - b) <= tolerance); }

} // namespace

TEST_CASE("body fit: rotation and scale are separated, to 1 %") {
	std::mt19937_64 random(3);
	std::uniform_real_distribution<float> powers(-3.0f, 3.0f);
	for (int i = 0; i < 2000; ++i) {
		const glm::mat3 rotation = random_rotation(random);
		const glm::vec3 scale(std::exp(powers(random)), std::exp(powers(random)), std::exp(powers(random)));
		const bool mirrored = i % 3 == 0;
		BodyFit fit;
		REQUIRE(fit_body(scaled(rotation, {scale.x, scale.y, mirrored ? -scale.z : scale.z}), fit));
		CHECK(fit.mirrored == mirrored);
		CHECK(glm::determinant(fit.rotation) == doctest::Approx(1.0));
		for (int axis = 0; axis < 3; ++axis) {
			check_close(fit.rotation[axis], rotation[axis], 1e-5f);
			CHECK(std::abs(std::abs(fit.scale()[axis]) / scale[axis] - 1.0f) < 0.01f);
		}
		CHECK((fit.scale().z < 0.0f) == mirrored);
	}
	BodyFit fit;
	REQUIRE(fit_body(glm::mat3(1.0f), fit));
	CHECK(fit.scale() == glm::vec3(1.0f));
	CHECK(fit.rotation == glm::mat3(1.0f));
}

TEST_CASE("body fit: only nearly equal scales share a step") {
	BodyFit a;
	BodyFit b;
	CHECK(fit_body(glm::mat3(1.600f), a));
	CHECK(fit_body(glm::mat3(1.601f), b));
	CHECK(a.scale_steps == b.scale_steps);
	CHECK(fit_body(glm::mat3(1.65f), b));
	CHECK(a.scale_steps != b.scale_steps);
}

TEST_CASE("body fit: a scale gets the nearest step, on every machine") {
	const double step = std::log(body_scale_step);
	BodyFit fit;
	std::uint64_t bits = 0xcbf29ce484222325;
	for (float scale = 1.001e-4f; scale < 0.999e4f; scale *= 1.00137f) {
		REQUIRE(fit_body(glm::mat3(scale), fit));
		const double steps = std::log(static_cast<double>(scale)) / step;
		CHECK(std::abs(fit.scale_steps.x - steps) < 0.5 + 1e-6);
		CHECK(fit.scale_steps.x == fit.scale_steps.z);
		CHECK(fit.scale().x == doctest::Approx(std::pow(body_scale_step, fit.scale_steps.x)));
		for (const std::uint32_t word :
				{static_cast<std::uint32_t>(fit.scale_steps.x), std::bit_cast<std::uint32_t>(fit.scale().x)}) {
			bits = (bits ^ word) * 0x100000001b3;
		}
	}
	// All steps and the bits of their scales must be the same on every machine and with every
	// compiler.
	CHECK(bits == 11080113259861306263u);
}

TEST_CASE("body fit: a sheared instance keeps its up axis") {
	std::mt19937_64 random(4);
	std::uniform_real_distribution<float> along(-0.5f, 0.5f);
	for (int i = 0; i < 500; ++i) {
		glm::mat3 basis = random_rotation(random);
		for (int column = 0; column < 3; ++column) {
			basis[column] += glm::vec3(along(random), along(random), along(random)) * 0.6f;
		}
		BodyFit fit;
		if (!fit_body(basis, fit)) {
			CHECK(std::abs(glm::determinant(basis)) < 1e-3f);
			continue;
		}
		check_close(fit.rotation[1], glm::normalize(basis[1]), 1e-5f);
		check_close(glm::transpose(fit.rotation) * fit.rotation[0], {1.0f, 0.0f, 0.0f}, 1e-5f);
		CHECK(glm::determinant(fit.rotation) == doctest::Approx(1.0));
	}
}

TEST_CASE("body fit: flat, tiny, huge and non-finite instances get no body") {
	BodyFit fit;
	const float infinity = std::numeric_limits<float>::infinity();
	const float nan = std::numeric_limits<float>::quiet_NaN();
	for (const float scale : {0.0f, 1e-5f, 1e5f, infinity, -infinity, nan}) {
		CAPTURE(scale);
		CHECK_FALSE(fit_body(glm::mat3(scale), fit));
		for (int axis = 0; axis < 3; ++axis) {
			glm::vec3 one(1.0f);
			one[axis] = scale;
			CHECK_FALSE(fit_body(scaled(glm::mat3(1.0f), one), fit));
		}
	}
	CHECK_FALSE(fit_body(glm::mat3({0, 2, 0}, {0, 1, 0}, {0, 0, 1}), fit)); // Two axes are collinear.
	CHECK_FALSE(fit_body(glm::mat3({1, 0, 0}, {0, 1, 0}, {3, 1, 0}), fit)); // All axes are coplanar.
	CHECK(fit_body(glm::mat3(1.1e-4f), fit));
	CHECK(fit_body(glm::mat3(0.9e4f), fit));
}

TEST_CASE("body fit: the outermost points of a box are its corners") {
	std::mt19937_64 random(5);
	std::uniform_real_distribution<float> inside(-0.999f, 0.999f);
	std::vector<glm::vec3> points;
	for (int i = 0; i < 1000; ++i) {
		points.push_back(glm::vec3(inside(random), 3.0f * inside(random), 0.5f * inside(random)));
	}
	for (int corner = 0; corner < 8; ++corner) {
		points[static_cast<std::size_t>(corner) * 100] = {
				(corner & 1) != 0 ? 1.0f : -1.0f, (corner & 2) != 0 ? 3.0f : -3.0f, (corner & 4) != 0 ? 0.5f : -0.5f};
	}
	std::vector<glm::vec3> outermost = points;
	keep_outermost(outermost, 64);
	CHECK(outermost.size() == 8);
	for (std::size_t corner = 0; corner < 8; ++corner) {
		CHECK(outermost[corner] == points[corner * 100]);
	}
}

TEST_CASE("body fit: the outermost points of a ball reach nearly its radius") {
	std::mt19937_64 random(6);
	std::normal_distribution<float> coordinate;
	std::vector<glm::vec3> points;
	for (int i = 0; i < 5000; ++i) {
		points.push_back(glm::normalize(glm::vec3(coordinate(random), coordinate(random), coordinate(random))));
	}
	std::vector<glm::vec3> outermost = points;
	keep_outermost(outermost, 64);
	CHECK(outermost.size() <= 64);
	CHECK(outermost.size() > 50);
	for (const glm::vec3 &towards : points) {
		float max_distance = 0.0f;
		for (const glm::vec3 &point : outermost) {
			max_distance = std::max(max_distance, glm::dot(point, towards));
		}
		CHECK(max_distance > 0.9f);
	}
	std::vector<glm::vec3> few_points(points.begin(), points.begin() + 64);
	const std::vector<glm::vec3> same = few_points;
	keep_outermost(few_points, 64);
	CHECK(few_points == same);
}
