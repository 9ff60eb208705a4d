#include "core/terrain/mesh_surface.hpp"
#include "refusal.hpp"

#include <doctest/doctest.h>

#include <cstdint>
#include <cstring>
#include <vector>

using namespace thicket;

namespace {

using Bytes = std::vector<std::uint8_t>;
using Corners = std::vector<glm::vec3>;

template <typename Number>
Bytes bytes_of(const std::vector<Number> &numbers) {
	Bytes bytes(numbers.size() * sizeof(Number));
	std::memcpy(bytes.data(), numbers.data(), bytes.size());
	return bytes;
}

const Bytes four_vertices = bytes_of<float>({0, 1, 2, 10, 11, 12, 20, 21, 22, 30, 31, 32});
const glm::vec3 a(0, 1, 2);
const glm::vec3 b(10, 11, 12);
const glm::vec3 c(20, 21, 22);
const glm::vec3 d(30, 31, 32);

MeshSurface surface_of(MeshSurface::Shape shape, const Bytes &vertices, std::size_t count) {
	MeshSurface surface;
	surface.shape = shape;
	surface.vertices = vertices;
	surface.vertex_count = count;
	return surface;
}

MeshSurface indexed(MeshSurface::Shape shape, const Bytes &indices, std::size_t count) {
	MeshSurface surface = surface_of(shape, four_vertices, 4);
	surface.indices = indices;
	surface.index_count = count;
	return surface;
}

Corners faces_of(const MeshSurface &surface) {
	Corners corners;
	REQUIRE(append_faces(surface, corners).ok());
	CHECK(corners.size() == surface.corner_count());
	return corners;
}

} // namespace

TEST_CASE("mesh surface: triangles are read in the order of the vertices, or of 2-byte or 4-byte indices") {
	using enum MeshSurface::Shape;
	CHECK(faces_of(surface_of(triangles, four_vertices, 3)) == Corners{a, b, c});
	const Bytes two = bytes_of<std::uint16_t>({3, 0, 1, 2, 2, 0});
	CHECK(faces_of(indexed(triangles, two, 6)) == Corners{d, a, b, c, c, a});
	const Bytes four = bytes_of<std::uint32_t>({3, 0, 1, 2, 2, 0});
	CHECK(faces_of(indexed(triangles, four, 6)) == Corners{d, a, b, c, c, a});
}

TEST_CASE("mesh surface: each vertex of a strip after the first two completes a triangle") {
	using enum MeshSurface::Shape;
	CHECK(faces_of(surface_of(strip, four_vertices, 4)) == Corners{a, b, c, b, c, d});
	const Bytes indices = bytes_of<std::uint16_t>({3, 2, 1, 0});
	CHECK(faces_of(indexed(strip, indices, 4)) == Corners{d, c, b, c, b, a});
}

TEST_CASE("mesh surface: without whole triangles there are no faces") {
	using enum MeshSurface::Shape;
	CHECK(faces_of(surface_of(none, four_vertices, 3)).empty());
	CHECK(faces_of(surface_of(triangles, four_vertices, 4)).empty());
	CHECK(faces_of(surface_of(triangles, {}, 0)).empty());
	CHECK(faces_of(surface_of(strip, four_vertices, 2)).empty());
}

TEST_CASE("mesh surface: flat and quantized positions are read correctly") {
	using enum MeshSurface::Shape;
	const Bytes flat_bytes = bytes_of<float>({0, 1, 10, 11, 20, 21});
	MeshSurface flat = surface_of(triangles, flat_bytes, 3);
	flat.positions = MeshSurface::Positions::flat;
	CHECK(faces_of(flat) == Corners{{0, 1, 0}, {10, 11, 0}, {20, 21, 0}});

	// The fourth number of each vertex is an angle. The normals come after the positions.
	const Bytes quantized_bytes =
			bytes_of<std::uint16_t>({0, 0, 0, 7, 65535, 65535, 65535, 7, 13107, 26214, 39321, 7, 1, 2, 3, 4});
	MeshSurface quantized = surface_of(triangles, quantized_bytes, 3);
	quantized.positions = MeshSurface::Positions::quantized;
	quantized.box_corner = {-5, 100, 0};
	quantized.box_size = {10, 20, 30};
	const Corners faces = faces_of(quantized);
	CHECK(faces[0] == glm::vec3(-5, 100, 0));
	CHECK(faces[1] == glm::vec3(5, 120, 30));
	CHECK(faces[2].x == doctest::Approx(-3));
	CHECK(faces[2].y == doctest::Approx(108));
	CHECK(faces[2].z == doctest::Approx(18));
}

TEST_CASE("mesh surface: bytes that do not fit are rejected") {
	using enum MeshSurface::Shape;
	Corners corners;
	check_refused(
			append_faces(surface_of(triangles, four_vertices, 6), corners), ErrorCode::wrong_size, "vertices", 48.0);
	const Bytes indices = bytes_of<std::uint16_t>({0, 1, 4});
	check_refused(
			append_faces(indexed(triangles, indices, 3), corners), ErrorCode::out_of_range, "index of a vertex", 4.0);
	check_refused(append_faces(indexed(triangles, indices, 6), corners), ErrorCode::wrong_size, "indices", 6.0);
}
