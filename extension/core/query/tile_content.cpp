#include "core/query/tile_content.hpp"

#include "core/base/instance_id.hpp"

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>

namespace thicket {

namespace {

/// The cells that some ids name.
struct CellBounds {
	glm::ivec2 low{std::numeric_limits<int>::max()};
	glm::ivec2 high{std::numeric_limits<int>::min()};

	void add(glm::ivec2 cell) {
		low = glm::min(low, cell);
		high = glm::max(high, cell);
	}
};

/// Writes `from` to `r_to`, of the same size, in the order of keys from 0 to `keys` - 1; equal ones stay in their
/// order.
template <class Key>
void count_sort(
		const std::vector<InstanceRef> &from, std::int64_t keys, const Key &key_of, std::vector<InstanceRef> &r_to) {
	std::vector<std::size_t> ends(static_cast<std::size_t>(keys) + 1, 0);
	for (const InstanceRef &ref : from) {
		++ends[static_cast<std::size_t>(key_of(ref)) + 1];
	}
	std::partial_sum(ends.begin(), ends.end(), ends.begin());
	for (const InstanceRef &ref : from) {
		r_to[ends[static_cast<std::size_t>(key_of(ref))]++] = ref;
	}
}

} // namespace

PlacedInstance placed_instance(
		std::uint64_t id, std::uint32_t layer, std::uint32_t mesh, glm::dvec3 origin, const float *transform) {
	PlacedInstance placed{.id = id, .layer = layer, .mesh = mesh, .position = position_of(origin, transform)};
	for (int row = 0; row < 3; ++row) {
		for (int column = 0; column < 3; ++column) {
			placed.basis[column][row] = transform[row * 4 + column];
		}
	}
	return placed;
}

PlacedInstance placed_instance(std::uint64_t id, std::uint32_t layer, const AddedInstance &added) {
	return {.id = id, .layer = layer, .mesh = added.mesh, .position = added.position, .basis = added.basis};
}

void sort_by_id(std::vector<InstanceRef> &r_refs) {
	if (r_refs.empty()) {
		return;
	}
	CellBounds bounds;
	for (const InstanceRef &ref : r_refs) {
		bounds.add(unpack(ref.id).cell);
	}
	const glm::i64vec2 size = glm::i64vec2(bounds.high) - glm::i64vec2(bounds.low) + std::int64_t{1};
	if (size.x + size.y > static_cast<std::int64_t>(r_refs.size())) {
		std::sort(r_refs.begin(), r_refs.end(), [](const InstanceRef &a, const InstanceRef &b) { return a.id < b.id; });
		return;
	}
	// Cells in a crowd: two passes that keep the order of what is equal to them, by y, then by x.
	std::vector<InstanceRef> by_y(r_refs.size());
	count_sort(r_refs, size.y, [&](const InstanceRef &ref) { return unpack(ref.id).cell.y - bounds.low.y; }, by_y);
	count_sort(by_y, size.x, [&](const InstanceRef &ref) { return unpack(ref.id).cell.x - bounds.low.x; }, r_refs);
}

} // namespace thicket
