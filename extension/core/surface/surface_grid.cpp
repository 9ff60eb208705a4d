#include "core/surface/surface_grid.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <bit>
#include <cmath>

namespace thicket {

namespace {

constexpr double cell_width = surface_cell_size;

/// Returns the cell, along one axis, of a position in whole units.
std::int32_t cell_at(double units) {
	return static_cast<std::int32_t>(static_cast<std::int64_t>(units) >> surface_bits);
}

} // namespace

CellBox CellBox::common(const CellBox &other) const { return {glm::max(min, other.min), glm::min(max, other.max)}; }

void SurfaceGrid::build(
		const CellBox &box, std::span<const SurfaceTriangle> triangles, std::span<const glm::ivec3> extra) {
	box_ = box;
	size_ = glm::max(box.size(), glm::ivec3(0));
	rows_ = size_.y + 2 * surface_reach;
	words_ = static_cast<std::size_t>((size_.x + 2 * surface_reach + 63) / 64 + 1);
	bits_.assign(words_ * static_cast<std::size_t>(rows_) * static_cast<std::size_t>(size_.z + 2 * surface_reach), 0);
	entries_.clear();
	for (std::uint32_t index = 0; index < triangles.size(); ++index) {
		enter(triangles[index], index);
	}
	for (const glm::ivec3 &cell : extra) {
		bits_[word_of(cell)] |= std::uint64_t{1} << ((cell.x + surface_reach) & 63);
	}
	number_cells();
}

void SurfaceGrid::enter(const SurfaceTriangle &triangle, std::uint32_t triangle_index) {
	glm::ivec3 first;
	glm::ivec3 last;
	for (int side = 0; side < 3; ++side) {
		first[side] = cell_at(greater(at(triangle.low, side), 0.0));
		last[side] = cell_at(lesser(at(triangle.high, side), size_[side] * cell_width));
		last[side] = lesser(last[side], size_[side] - 1);
		if (first[side] > last[side]) {
			return;
		}
	}
	// Columns along the axis nearest to the normal intersect the fewest cells near the plane.
	const glm::dvec3 steep = glm::abs(triangle.normal);
	int axis = steep.x > steep.y ? 0 : 1;
	axis = steep.z > at(steep, axis) ? 2 : axis;
	const auto [side_u, side_v] = axes_across(axis);
	const SurfaceOutline outline(triangle, axis);
	const double half = half_of_lines(cell_width);
	const double reach = outline.reach(half);
	// The heights are clamped to the box, because the plane's height may exceed the range of an
	// integer.
	const double lowest = first[axis] * cell_width;
	const double highest = (last[axis] + 1) * cell_width - 1.0;
	// The heights and the distances to the edges change linearly from column to column.
	SurfaceOutline::Columns row =
			outline.columns((first[side_u] + 0.5) * cell_width, (first[side_v] + 0.5) * cell_width, cell_width, half);
	glm::ivec3 cell(0);
	for (cell[side_v] = first[side_v]; cell[side_v] <= last[side_v]; ++cell[side_v], row.move_v()) {
		SurfaceOutline::Columns column = row;
		for (cell[side_u] = first[side_u]; cell[side_u] <= last[side_u]; ++cell[side_u], column.move_u()) {
			const double low = greater(column.height() - reach, lowest);
			const double high = lesser(column.height() + reach, highest);
			if (!column.meets() | (low > high)) {
				continue;
			}
			const std::int32_t end = cell_at(high);
			for (cell[axis] = cell_at(low); cell[axis] <= end; ++cell[axis]) {
				const std::size_t word = word_of(cell);
				const auto bit = static_cast<std::uint32_t>((cell.x + surface_reach) & 63);
				bits_[word] |= std::uint64_t{1} << bit;
				entries_.push_back({static_cast<std::uint32_t>(word * 64 + bit), triangle_index});
			}
		}
	}
}

void SurfaceGrid::number_cells() {
	ranks_.resize(bits_.size());
	cells_.clear();
	for (std::size_t word = 0; word < bits_.size(); ++word) {
		ranks_[word] = static_cast<std::uint32_t>(cells_.size());
		const auto row = static_cast<std::int32_t>(word / words_);
		for (std::uint64_t remaining_bits = bits_[word]; remaining_bits != 0; remaining_bits &= remaining_bits - 1) {
			const auto x = static_cast<std::int32_t>(word % words_ * 64) + std::countr_zero(remaining_bits);
			cells_.push_back(glm::ivec3(x, row % rows_, row / rows_) - surface_reach);
		}
	}
	// The triangles are sorted by a stable counting sort, so that each cell lists its triangles in
	// the caller's order.
	starts_.assign(cells_.size() + 1, 0);
	for (Entry &entry : entries_) {
		entry.cell = rank(entry.cell / 64, std::uint64_t{1} << (entry.cell & 63));
		++starts_[entry.cell + 1];
	}
	for (std::size_t index = 1; index < starts_.size(); ++index) {
		starts_[index] += starts_[index - 1];
	}
	triangles_.resize(entries_.size());
	for (const Entry &entry : entries_) {
		triangles_[starts_[entry.cell]++] = entry.triangle;
	}
	for (std::size_t index = starts_.size() - 1; index > 0; --index) {
		starts_[index] = starts_[index - 1];
	}
	starts_[0] = 0;
}

void SurfaceGrid::append_neighbors(std::uint32_t cell_index, std::vector<std::uint32_t> &r_cells) const {
	constexpr std::uint32_t side = 2 * surface_reach + 1;
	const glm::ivec3 &center = cells_[cell_index];
	// In a row, the bits of the three cells from x - 1 to x + 1 start at this bit.
	const int shift = center.x & 63;
	const auto column = static_cast<std::size_t>(center.x >> 6);
	std::size_t end = r_cells.size();
	r_cells.resize(end + side * side * side);
	for (std::int32_t z = -surface_reach; z <= surface_reach; ++z) {
		auto row = static_cast<std::size_t>(center.z + z + surface_reach) * static_cast<std::size_t>(rows_) +
				static_cast<std::size_t>(center.y);
		for (std::int32_t y = -surface_reach; y <= surface_reach; ++y, ++row) {
			const std::size_t word = row * words_ + column;
			// Two shifts append the bits of the second word. A single shift would be by 64 bits if
			// `shift` is 0, which is undefined.
			const std::uint64_t neighbor_bits = (bits_[word] >> shift | bits_[word + 1] << 1 << (63 - shift)) & 0b111u;
			// Cells in a row have consecutive numbers. All three numbers are written, because the
			// end of a loop over only the existing cells would be mispredicted. The next row
			// overwrites the rest.
			const int first_bit = shift + std::countr_zero(neighbor_bits | 0b100u);
			const std::uint32_t first =
					rank(word + static_cast<std::size_t>(first_bit >> 6), std::uint64_t{1} << (first_bit & 63));
			for (std::uint32_t i = 0; i < side; ++i) {
				r_cells[end + i] = first + i;
			}
			end += count_bits(neighbor_bits);
		}
	}
	r_cells.resize(end);
}

std::size_t SurfaceGrid::bytes() const {
	return bits_.capacity() * sizeof(std::uint64_t) + ranks_.capacity() * sizeof(std::uint32_t) +
			cells_.capacity() * sizeof(glm::ivec3) + entries_.capacity() * sizeof(Entry) +
			(starts_.capacity() + triangles_.capacity()) * sizeof(std::uint32_t);
}

} // namespace thicket
