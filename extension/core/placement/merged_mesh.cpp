#include "core/placement/merged_mesh.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

namespace thicket {

namespace {

/// An instance to merge, with the index of its mesh and its index in that mesh.
struct MergedInstance {
	std::uint32_t rank = 0;
	std::uint64_t id = 0;
	std::size_t mesh = 0;
	std::size_t index = 0;
};

} // namespace

CompactMesh merged(std::span<const TileMesh> meshes, const glm::dvec3 &origin) {
	std::vector<MergedInstance> order;
	std::size_t stride = transform_floats;
	for (std::size_t at = 0; at < meshes.size(); ++at) {
		const CompactMesh &mesh = *meshes[at].mesh;
		stride = mesh.size() > 0 ? mesh.stride() : stride;
		for (std::size_t i = 0; i < mesh.size(); ++i) {
			order.push_back({mesh.ranks()[i], mesh.id(i), at, i});
		}
	}
	std::ranges::sort(order, {}, [](const MergedInstance &each) { return std::tie(each.rank, each.id); });
	MeshInstances result;
	result.resize(order.size(), stride);
	for (std::size_t at = 0; at < order.size(); ++at) {
		const MergedInstance &from = order[at];
		const CompactMesh &mesh = *meshes[from.mesh].mesh;
		const std::span<float> floats = result.floats_of(at);
		mesh.read(from.index, floats);
		const glm::vec3 position(meshes[from.mesh].origin - origin + glm::dvec3(mesh.positions()[from.index]));
		write_position(position, floats.first<transform_floats>());
		result.ids[at] = from.id;
		result.ranks[at] = from.rank;
		result.min = at == 0 ? position : glm::min(result.min, position);
		result.max = at == 0 ? position : glm::max(result.max, position);
		result.max_scale = std::max(result.max_scale, mesh.max_scale());
	}
	return {result, nullptr, origin};
}

} // namespace thicket
