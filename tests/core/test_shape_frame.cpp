// Tests the conversion of scene nodes to shapes: splitting a basis into rotation and scale, and
// simplifying polylines.

#include "core/rules/polyline.hpp"
#include "core/rules/shape_frame.hpp"
#include "refusal.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

using namespace thicket;

namespace {

/// Returns a rotation around y, then around x.
glm::dmat3 turned(double yaw, double pitch) {
	const glm::dmat3 about_y{
			{std::cos(yaw), 0.0, -std::sin(yaw)}, {0.0, 1.0, 0.0}, {std::sin(yaw), 0.0, std::cos(yaw)}};
	const glm::dmat3 about_x{
			{1.0, 0.0, 0.0}, {0.0, std::cos(pitch), std::sin(pitch)}, {0.0, -std::sin(pitch), std::cos(pitch)}};
	return about_x * about_y;
}

glm::dmat3 scaled(glm::dmat3 basis, glm::dvec3 scale) {
	for (int axis = 0; axis < 3; ++axis) {
		basis[axis] *= scale[axis];
	}
	return basis;
}

double distance_to(const std::vector<glm::dvec2> &line, glm::dvec2 point) {
	double nearest = infinite_value;
	for (std::size_t i = 0; i + 1 < line.size(); ++i) {
		const glm::dvec2 segment = line[i + 1] - line[i];
		const double length = glm::dot(segment, segment);
		const double fraction = length > 0.0 ? std::clamp(glm::dot(point - line[i], segment) / length, 0.0, 1.0) : 0.0;
		nearest = std::min(nearest, glm::distance(point, line[i] + fraction * segment));
	}
	return nearest;
}

} // namespace

TEST_CASE("shape frame: scales and axes are separated, to double precision from single") {
	const glm::dvec3 scale{2.0, 0.25, 30.0};
	for (const glm::dvec3 sign : {glm::dvec3(1.0), glm::dvec3(1.0, 1.0, -1.0), glm::dvec3(-1.0, 1.0, -1.0)}) {
		const glm::dmat3 axes = scaled(turned(0.7, -2.1), sign);
		const glm::mat3 as_floats(scaled(axes, scale));
		ShapeFrame frame;
		REQUIRE(decompose(glm::dmat3(as_floats), frame).ok());
		for (int axis = 0; axis < 3; ++axis) {
			CHECK(std::abs(frame.scale[axis] - scale[axis]) < 1e-5 * scale[axis]);
			CHECK(glm::distance(frame.axes[axis], axes[axis]) < 1e-6);
			CHECK(std::abs(glm::dot(frame.axes[axis], frame.axes[axis]) - 1.0) < 1e-15);
			CHECK(std::abs(glm::dot(frame.axes[axis], frame.axes[(axis + 1) % 3])) < 1e-15);
		}
	}
}

TEST_CASE("shape frame: a transform other than a rotation with scales is rejected") {
	ShapeFrame frame;
	frame.scale = glm::dvec3(7.0);
	const auto refuse = [&frame](const glm::dmat3 &basis) {
		const Status status = decompose(basis, frame);
		CHECK(frame.scale.x == 7.0);
		return status;
	};
	check_refused(refuse(scaled(glm::dmat3(1.0), {1.0, 0.0, 1.0})), ErrorCode::not_positive, "scale", 0.0);
	check_refused(refuse(scaled(glm::dmat3(1.0), {1.0, nan_value, 1.0})), ErrorCode::not_finite, "scale", nan_value);
	check_refused(
			refuse(scaled(glm::dmat3(1.0), {infinite_value, 1.0, 1.0})), ErrorCode::not_finite, "scale", nan_value);
	glm::dmat3 sheared(1.0);
	sheared[2] = glm::normalize(glm::dvec3(0.6, 0.0, 0.8));
	const Status status = refuse(sheared);
	CHECK(status.code == ErrorCode::out_of_range);
	CHECK(std::abs(status.value - 0.6) < 1e-12);
	// A tiny shear, as rounding produces it, is corrected.
	sheared[2] = glm::normalize(glm::dvec3(1e-5, 0.0, 1.0));
	CHECK(decompose(sheared, frame).ok());
}

TEST_CASE("polyline: the result has fewer points, and no original point is farther away than the tolerance") {
	std::mt19937_64 random(5);
	std::uniform_real_distribution<double> turn(-0.2, 0.2);
	std::vector<glm::dvec2> line{{-40.0, 3.0}};
	double direction = 0.0;
	for (int i = 0; i < 2000; ++i) {
		direction += turn(random);
		line.push_back(line.back() + 0.2 * glm::dvec2(std::cos(direction), std::sin(direction)));
	}
	for (const double tolerance : {0.0, 0.01, 0.1, 2.0}) {
		const std::vector<glm::dvec2> less = simplified(line, tolerance);
		CHECK(less.front() == line.front());
		CHECK(less.back() == line.back());
		CHECK(less.size() <= line.size());
		CHECK((tolerance < 0.1 || less.size() < line.size() / 2));
		for (const glm::dvec2 point : line) {
			CHECK(distance_to(less, point) <= tolerance + 1e-9);
		}
	}
	// A change at the end of the line does not affect its beginning.
	std::vector<glm::dvec2> other = line;
	other.back() += glm::dvec2(5.0, 5.0);
	const std::vector<glm::dvec2> first = simplified(line, 0.05);
	const std::vector<glm::dvec2> second = simplified(other, 0.05);
	CHECK(std::equal(first.begin(), first.begin() + static_cast<std::ptrdiff_t>(first.size() / 2), second.begin()));
}

TEST_CASE("polyline: straight lines, single points, repeated points and points that are not finite are simplified") {
	std::vector<glm::dvec2> straight;
	for (int i = 0; i <= 100; ++i) {
		straight.emplace_back(0.25 * i, -0.5 * i);
	}
	CHECK(simplified(straight, 1e-9).size() == 2);
	CHECK(simplified({}, 1.0).empty());
	CHECK(simplified(std::vector<glm::dvec2>{{1.0, 2.0}}, 1.0).size() == 1);
	CHECK(simplified(std::vector<glm::dvec2>(5, {1.0, 2.0}), 0.0).size() == 2);
	// A line to the end and back.
	const std::vector<glm::dvec2> folded{{0.0, 0.0}, {5.0, 0.0}, {10.0, 0.0}, {5.0, 0.0}, {0.0, 0.0}};
	CHECK(simplified(folded, 0.1).size() == 3);
	const std::vector<glm::dvec2> broken{{0.0, 0.0}, {5.0, 1.0}, {nan_value, 0.0}, {9.0, 9.0}};
	CHECK(simplified(broken, 0.1).size() == 2);
}
