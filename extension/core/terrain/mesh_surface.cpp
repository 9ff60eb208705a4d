#include "core/terrain/mesh_surface.hpp"

#include "core/base/guard.hpp"

#include <array>
#include <cstring>

namespace thicket {

namespace {

constexpr std::size_t corners_of_triangle = 3;

std::size_t bytes_of(MeshSurface::Positions positions) {
	return positions == MeshSurface::Positions::floats ? 3 * sizeof(float) : 2 * sizeof(float);
}

template <typename Number>
Number number_at(const std::uint8_t *bytes, std::size_t number) {
	Number result{};
	std::memcpy(&result, bytes + number * sizeof(Number), sizeof(Number));
	return result;
}

glm::vec3 position_at(const MeshSurface &surface, std::size_t vertex) {
	const std::uint8_t *bytes = surface.vertices.data() + vertex * bytes_of(surface.positions);
	switch (surface.positions) {
		case MeshSurface::Positions::floats:
			return {number_at<float>(bytes, 0), number_at<float>(bytes, 1), number_at<float>(bytes, 2)};
		case MeshSurface::Positions::flat: return {number_at<float>(bytes, 0), number_at<float>(bytes, 1), 0.0F};
		case MeshSurface::Positions::quantized: break;
	}
	const auto part = [bytes](std::size_t axis) {
		return static_cast<float>(static_cast<float>(number_at<std::uint16_t>(bytes, axis)) / 65535.0);
	};
	return glm::vec3(part(0), part(1), part(2)) * surface.box_size + surface.box_corner;
}

/// Calls `add` with the vertex of each triangle corner, until `add` returns false.
template <typename VertexOf, typename Add>
void each_corner(MeshSurface::Shape shape, std::size_t count, const VertexOf &vertex_of, const Add &add) {
	if (shape == MeshSurface::Shape::triangles) {
		for (std::size_t i = 0; i < count; ++i) {
			if (!add(vertex_of(i))) {
				return;
			}
		}
		return;
	}
	for (std::size_t i = 2; i < count; ++i) {
		if (!add(vertex_of(i - 2)) || !add(vertex_of(i - 1)) || !add(vertex_of(i))) {
			return;
		}
	}
}

} // namespace

std::size_t MeshSurface::corner_count() const {
	const std::size_t count = index_count > 0 ? index_count : vertex_count;
	switch (shape) {
		case Shape::none: return 0;
		case Shape::triangles: return count % corners_of_triangle == 0 ? count : 0;
		case Shape::strip: return count < corners_of_triangle ? 0 : (count - 2) * corners_of_triangle;
	}
	return 0;
}

Status append_faces(const MeshSurface &surface, std::vector<glm::vec3> &r_corners) {
	const std::size_t corners = surface.corner_count();
	if (corners == 0) {
		return {};
	}
	if (surface.vertices.size() / bytes_of(surface.positions) < surface.vertex_count) {
		return Status::wrong_size("vertices", surface.vertices.size(),
				at_least(surface.vertex_count * bytes_of(surface.positions), "bytes"));
	}
	const std::size_t index_bytes = surface.index_count > 0 ? surface.indices.size() / surface.index_count : 0;
	if (surface.index_count > 0 && index_bytes != sizeof(std::uint16_t) && index_bytes != sizeof(std::uint32_t)) {
		return Status::wrong_size("indices", surface.indices.size(),
				between(2 * surface.index_count, 4 * surface.index_count, "bytes, 2 or 4 each"));
	}
	return guarded("corners", static_cast<double>(corners), [&] {
		r_corners.reserve(r_corners.size() + corners);
		Status status;
		const auto add = [&](std::size_t vertex) {
			if (vertex >= surface.vertex_count) {
				status = Status::out_of_range("index of a vertex", vertex,
						at_most(static_cast<double>(surface.vertex_count) - 1.0), "Import the mesh again");
				return false;
			}
			r_corners.push_back(position_at(surface, vertex));
			return true;
		};
		const std::uint8_t *indices = surface.indices.data();
		if (index_bytes == 0) {
			each_corner(surface.shape, surface.vertex_count, [](std::size_t i) { return i; }, add);
		} else if (index_bytes == sizeof(std::uint16_t)) {
			const auto vertex_of = [indices](std::size_t i) -> std::size_t {
				return number_at<std::uint16_t>(indices, i);
			};
			each_corner(surface.shape, surface.index_count, vertex_of, add);
		} else {
			const auto vertex_of = [indices](std::size_t i) -> std::size_t {
				return number_at<std::uint32_t>(indices, i);
			};
			each_corner(surface.shape, surface.index_count, vertex_of, add);
		}
		return status;
	});
}

} // namespace thicket
