#include "core/placement/tile_instances.hpp"

#include "core/base/word_hash.hpp"

#include <algorithm>
#include <cmath>

namespace thicket {

void MeshInstances::reserve(std::size_t count, const InstanceData &data) {
	buffer.reserve(count * floats_per_instance(data));
	ids.reserve(count);
	ranks.reserve(count);
	normals.reserve(count);
	if (data.has_fractions()) {
		fractions.reserve(count);
	}
}

void MeshInstances::resize(std::size_t count, const InstanceData &data) {
	buffer.resize(count * floats_per_instance(data)); // The new floats are not initialized.
	resize(count, floats_per_instance(data));
	normals.resize(count);
	if (data.has_fractions()) {
		fractions.resize(count);
	}
}

void MeshInstances::resize(std::size_t count, std::size_t floats) {
	stride = floats;
	buffer.resize(count * floats, 0.0f);
	ids.resize(count);
	ranks.resize(count);
	normals.clear();
	fractions.clear();
}

std::size_t visible_prefix(std::span<const std::uint32_t> ranks, double density) {
	if (!(density > 0.0)) {
		return 0;
	}
	const double end = std::ceil(density * 0x1p32);
	const auto below = [end](std::uint32_t rank) {
		return rank < end;
	};
	return static_cast<std::size_t>(std::partition_point(ranks.begin(), ranks.end(), below) - ranks.begin());
}

std::uint64_t digest(std::span<const float> buffer) {
	WordHash hash;
	hash.add_all(buffer);
	return hash.value();
}

std::uint64_t digest(const TileInstances &tile) {
	WordHash hash;
	hash.add(tile.origin.x);
	hash.add(tile.origin.y);
	hash.add(tile.origin.z);
	for (const MeshInstances &mesh : tile.meshes) {
		hash.add(std::uint64_t{mesh.size()});
		hash.add_all(std::span<const std::uint64_t>(mesh.ids));
		hash.add_all(std::span<const std::uint32_t>(mesh.ranks));
		hash.add_all(std::span<const float>(mesh.buffer));
	}
	return hash.value();
}

} // namespace thicket
