#include "core/query/found_instances.hpp"

#include "core/base/instance_id.hpp"
#include "core/query/tile_content.hpp"

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace thicket {

namespace {

using Ref = FoundInstances::Ref;

/// The bounds of the cells of some points, given by IDs.
struct CellBounds {
	glm::ivec2 low{std::numeric_limits<int>::max()};
	glm::ivec2 high{std::numeric_limits<int>::min()};

	void add(glm::ivec2 cell) {
		low = glm::min(low, cell);
		high = glm::max(high, cell);
	}
};

/// Sorts stably by key: writes the entries of `from` to `r_to`, which has the same size, by a
/// counting sort. Keys are 0 to `keys` - 1.
template <class Key>
void count_sort(std::span<const Ref> from, std::int64_t keys, const Key &key_of, std::span<Ref> r_to) {
	std::vector<std::uint32_t> ends(static_cast<std::size_t>(keys) + 1, 0);
	for (const Ref &ref : from) {
		++ends[static_cast<std::size_t>(key_of(ref)) + 1];
	}
	std::partial_sum(ends.begin(), ends.end(), ends.begin());
	for (const Ref &ref : from) {
		r_to[ends[static_cast<std::size_t>(key_of(ref))]++] = ref;
	}
}

} // namespace

void FoundInstances::clear() {
	parts_.clear();
	refs_.clear();
	placed_.clear();
}

std::uint32_t FoundInstances::layer(std::size_t i) const {
	const Ref &ref = refs_[i];
	return ref.part == by_hand ? placed_[ref.index].layer : parts_[ref.part].layer;
}

std::uint32_t FoundInstances::mesh(std::size_t i) const {
	const Ref &ref = refs_[i];
	return ref.part == by_hand ? placed_[ref.index].mesh : parts_[ref.part].mesh;
}

glm::dvec3 FoundInstances::position(std::size_t i) const {
	const Ref &ref = refs_[i];
	if (ref.part == by_hand) {
		return placed_[ref.index].position;
	}
	const Part &part = parts_[ref.part];
	return position_of(part.origin, part.content->positions()[ref.index]);
}

PlacedInstance FoundInstances::operator[](std::size_t i) const {
	const Ref &ref = refs_[i];
	if (ref.part == by_hand) {
		return placed_[ref.index];
	}
	const Part &part = parts_[ref.part];
	return placed_instance(part.layer, part.mesh, part.origin, *part.content, ref.index);
}

void FoundInstances::read_all(std::vector<PlacedInstance> &r_found) const {
	r_found.clear();
	r_found.reserve(size());
	for (std::size_t i = 0; i < size(); ++i) {
		r_found.push_back((*this)[i]);
	}
}

std::uint32_t FoundInstances::add_part(
		std::shared_ptr<const CompactMesh> content, glm::dvec3 origin, std::uint32_t layer, std::uint32_t mesh) {
	parts_.push_back({std::move(content), origin, layer, mesh});
	return static_cast<std::uint32_t>(parts_.size() - 1);
}

void FoundInstances::add(const PlacedInstance &instance) {
	placed_.push_back(instance);
	refs_.push_back({instance.id, by_hand, static_cast<std::uint32_t>(placed_.size() - 1)});
}

void FoundInstances::sort_from(std::size_t first) {
	const std::span<Ref> refs = std::span(refs_).subspan(first);
	if (refs.empty()) {
		return;
	}
	CellBounds bounds;
	for (const Ref &ref : refs) {
		bounds.add(unpack(ref.id).cell);
	}
	const glm::i64vec2 size = glm::i64vec2(bounds.high) - glm::i64vec2(bounds.low) + std::int64_t{1};
	if (size.x + size.y > static_cast<std::int64_t>(refs.size())) {
		std::ranges::sort(refs, {}, &Ref::id);
		return;
	}
	// The cells are dense, so two stable counting sorts are fast: by y, then by x.
	std::vector<Ref> by_y(refs.size());
	count_sort(refs, size.y, [&](const Ref &ref) { return unpack(ref.id).cell.y - bounds.low.y; }, by_y);
	count_sort(by_y, size.x, [&](const Ref &ref) { return unpack(ref.id).cell.x - bounds.low.x; }, refs);
}

} // namespace thicket
