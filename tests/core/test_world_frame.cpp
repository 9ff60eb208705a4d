// Tests the conversion between the engine's space and a node's world.

#include "core/base/world_frame.hpp"

#include <doctest/doctest.h>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include <cmath>
#include <initializer_list>

using namespace thicket;

namespace {

/// The axes of a node that is rotated and scaled unevenly, and its origin.
const glm::dmat3 node_axes{glm::dvec3(0.0, 0.0, -2.0), glm::dvec3(0.6, 1.6, 0.0), glm::dvec3(4.0, -1.5, 0.0)};
constexpr glm::dvec3 node_origin{1000.0, -20.0, 300.0};

} // namespace

TEST_CASE("world frame: local space has the node's rotation and origin, without its scale") {
	const WorldFrame frame = WorldFrame::of_local_space(node_axes, node_origin);
	CHECK(glm::length(frame.to_world(node_origin)) < 1e-9);
	const glm::dvec3 along_x = node_origin + 5.0 * glm::normalize(node_axes[0]);
	CHECK(glm::distance(frame.to_world(along_x), {5.0, 0.0, 0.0}) < 1e-9);
	const glm::dmat3 unit = frame.rotation * glm::transpose(frame.rotation);
	for (int column = 0; column < 3; ++column) {
		for (int row = 0; row < 3; ++row) {
			CHECK(std::abs(unit[column][row] - (column == row ? 1.0 : 0.0)) < 1e-12);
		}
	}
	CHECK(glm::determinant(frame.rotation) == doctest::Approx(1.0));
}

TEST_CASE("world frame: conversions to the world and back are inverse") {
	WorldFrame shifted;
	shifted.offset = {1e6, 0.0, -5.0};
	for (const WorldFrame &frame : {WorldFrame(), shifted, WorldFrame::of_local_space(node_axes, node_origin)}) {
		const glm::dvec3 position{12.0, -7.0, 33.0};
		CHECK(glm::distance(frame.to_engine(frame.to_world(position)), position) < 1e-9);
		const glm::mat3 basis(node_axes);
		const glm::mat3 back = frame.rotated_back(glm::mat3(frame.rotated(glm::dmat3(basis))));
		for (int column = 0; column < 3; ++column) {
			CHECK(glm::distance(back[column], basis[column]) < 1e-5F);
		}
	}
	CHECK(shifted.to_world({0.0, 0.0, 0.0}) == shifted.offset);
}
