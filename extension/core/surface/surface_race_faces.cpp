#include "core/surface/surface_race.hpp"

#include <algorithm>
#include <array>
#include <limits>

// The faces of a SurfaceRace's cells: planes that approximate the surface, and the columns in which
// darts are still possible.

namespace thicket {

namespace {

/// A cell's surface is divided into faces that differ from a plane by at most this many cell widths.
constexpr float face_tolerance = 0.05f;

/// Maximum number of faces of a cell for each axis. The last one approximates all remaining triangles.
constexpr std::size_t max_faces = 4;

} // namespace

SurfaceSearch SurfaceRace::search_in(std::uint32_t cell_index) const {
	const std::span<const std::uint32_t> cell_triangles = grid_.triangles_in(cell_index);
	if (cell_triangles.empty()) {
		return {};
	}
	const SurfaceSearch &search = triangles_[cell_triangles.front()].search;
	if (std::ranges::all_of(cell_triangles, [&](std::uint32_t index) { return triangles_[index].search == search; })) {
		return search;
	}
	// The search must depend only on the surface in the cell, but the grid also lists a few
	// triangles that are not in it.
	const SurfaceCube cube{
			glm::dvec3(grid_.cell(cell_index) * surface_cell_size), static_cast<double>(surface_cell_size)};
	glm::dvec3 min_steepness(1.0);
	for (const std::uint32_t index : cell_triangles) {
		if (triangles_[index].enters(cube)) {
			min_steepness = glm::min(min_steepness, triangles_[index].steepness());
		}
	}
	return search_for(min_steepness);
}

void SurfaceRace::prepare(std::uint32_t cell_index) {
	Cell &cell = cells_[cell_index];
	cell.search = search_in(cell_index);
	cell.faces = static_cast<std::uint32_t>(faces_.size());
	for (int axis = cell.search.first_axis(); axis <= cell.search.last_axis(); ++axis) {
		add_faces(cell_index, axis);
	}
	cell.face_count = static_cast<std::uint32_t>(faces_.size()) - cell.faces;
	const std::span<SurfacePatch> faces = faces_of(cell);
	if (std::ranges::all_of(faces, [](const SurfacePatch &face) { return face.open().is_empty(); })) {
		finish(cell_index);
	}
}

void SurfaceRace::add_faces(std::uint32_t cell_index, int axis) {
	const glm::dvec3 low(grid_.cell(cell_index) * surface_cell_size);
	const std::size_t begin = faces_.size();
	for (const std::uint32_t index : grid_.triangles_in(cell_index)) {
		const SurfacePatch::Facet facet = SurfacePatch::facet_of(triangles_[index], axis, low);
		if (facet.kind == SurfacePatch::Facet::Kind::absent) {
			continue;
		}
		std::size_t face = begin;
		while (face < faces_.size() && !faces_[face].add(facet, face_tolerance)) {
			++face;
		}
		if (face == faces_.size()) {
			if (face - begin < max_faces) {
				faces_.emplace_back(axis);
			} else {
				--face;
			}
			faces_[face].add(facet, std::numeric_limits<float>::infinity());
		}
	}
	for (std::size_t face = begin; face < faces_.size(); ++face) {
		faces_[face].open_entered();
	}
}

void SurfaceRace::refine(std::uint32_t cell_index) {
	Cell &cell = cells_[cell_index];
	if (cell.is_refined) {
		return;
	}
	cell.is_refined = true;
	const glm::dvec3 low(grid_.cell(cell_index) * surface_cell_size);
	const std::span<SurfacePatch> faces = faces_of(cell);
	for (int axis = cell.search.first_axis(); axis <= cell.search.last_axis(); ++axis) {
		std::array<SurfaceColumns, max_faces> columns{};
		const auto is_along = [axis](const SurfacePatch &face) {
			return face.axis() == axis;
		};
		const std::size_t begin = static_cast<std::size_t>(std::ranges::find_if(faces, is_along) - faces.begin());
		const auto count = static_cast<std::size_t>(std::ranges::count_if(faces, is_along));
		for (const std::uint32_t index : grid_.triangles_in(cell_index)) {
			const SurfaceTriangle &triangle = triangles_[index];
			const SurfacePatch::Facet facet = SurfacePatch::facet_of(triangle, axis, low);
			if (facet.kind == SurfacePatch::Facet::Kind::absent) {
				continue;
			}
			SurfaceColumns entered_columns;
			SurfacePatch::add_columns_over(triangle, axis, low, entered_columns);
			std::size_t face = 0;
			while (face < count && !faces[begin + face].add(facet, face_tolerance)) {
				++face;
			}
			// A triangle that is close to no face is part of one of them, but it is not known of which.
			const std::size_t first = face < count ? face : 0;
			const std::size_t end = face < count ? face + 1 : count;
			for (std::size_t face_index = first; face_index < end; ++face_index) {
				columns[face_index].add(entered_columns);
			}
		}
		for (std::size_t face = 0; face < count; ++face) {
			faces[begin + face].keep(columns[face]);
		}
	}
}

bool SurfaceRace::may_have_gaps(std::uint32_t cell_index, int axis, std::uint32_t column) {
	const Cell &cell = cells_[cell_index];
	const glm::ivec3 low = grid_.cell(cell_index) * surface_cell_size;
	for (const SurfacePatch &face : faces_of(cell)) {
		if (face.axis() != axis || !face.open().contains(column)) {
			continue;
		}
		SurfacePatch::Part part = face.part_in(column);
		for (std::uint32_t entry = cell.first_near; entry != none && !part.open.is_empty();
				entry = near_points_[entry].next) {
			face.cover_part(in_cells(near_points_[entry].position - low), part);
		}
		if (!part.open.is_empty()) {
			return true;
		}
	}
	return false;
}

} // namespace thicket
