#include "core/near/tile_overlay.hpp"

#include "core/base/basis_scale.hpp"
#include "core/base/guard.hpp"
#include "core/placement/instance_data.hpp"

#include <algorithm>
#include <utility>

namespace thicket {

namespace {

using Ids = std::vector<std::uint64_t>;

bool covers(const Overlay &overlay, bool any_removed, std::uint64_t id) {
	return (any_removed && overlay.state->removed(id)) || (overlay.hidden != nullptr && overlay.hidden->contains(id));
}

void write_added(const AddedInstance &added, std::uint64_t id, const LayerSettings &layer, glm::dvec3 origin,
		std::size_t at, MeshInstances &r_mesh) {
	const std::span<float> floats = r_mesh.floats_of(at);
	const glm::vec3 position(added.position - origin);
	for (int row = 0; row < 3; ++row) {
		for (int column = 0; column < 3; ++column) {
			floats[static_cast<std::size_t>(4 * row + column)] = added.basis[column][row];
		}
		floats[static_cast<std::size_t>(4 * row + 3)] = position[row];
	}
	write_instance_data(layer.instance_data, layer.set.seed, id, 0, largest_scale(added.basis),
			floats.subspan(transform_floats),
			fractions_by_hand(layer.instance_data, added.position, layer.set.on_surface, layer.planet));
	r_mesh.ids[at] = id;
	r_mesh.ranks[at] = 0;
	r_mesh.max_scale = std::max(r_mesh.max_scale, largest_scale(added.basis));
}

/// Returns a mesh with the added instances, followed by the instances of `mesh` at the indices
/// `retained`.
std::shared_ptr<const CompactMesh> rebuilt(const CompactMesh &mesh, const LayerSettings &layer, glm::dvec3 origin,
		const Overlay &overlay, const Ids &added_ids, std::span<const std::uint32_t> retained) {
	MeshInstances added;
	added.resize(added_ids.size(), floats_per_instance(layer.instance_data));
	for (std::size_t at = 0; at < added_ids.size(); ++at) {
		write_added(*overlay.state->added(added_ids[at]), added_ids[at], layer, origin, at, added);
	}
	return std::make_shared<const CompactMesh>(added, mesh, retained);
}

/// Returns the indices of the instances that are neither removed nor hidden.
std::vector<std::uint32_t> standing_of(const CompactMesh &mesh, const Overlay &overlay, bool any_removed) {
	std::vector<std::uint32_t> retained;
	retained.reserve(mesh.size());
	for (std::size_t i = 0; i < mesh.size(); ++i) {
		if (!covers(overlay, any_removed, mesh.id(i))) {
			retained.push_back(static_cast<std::uint32_t>(i));
		}
	}
	return retained;
}

/// Returns the IDs of the instances that were added in a tile and are not hidden, for each mesh.
std::vector<Ids> added_by_mesh(
		std::size_t meshes, const LayerSettings &layer, const TileSpace &space, const Overlay &overlay) {
	std::vector<Ids> result(meshes);
	if (overlay.state == nullptr || overlay.state->added_count() == 0 || meshes == 0) {
		return result;
	}
	Ids ids;
	throw_if_out_of_memory(overlay.state->added_in(layer.set.layer, space, ids));
	for (const std::uint64_t id : ids) {
		const AddedInstance &added = *overlay.state->added(id);
		if (space.contains_height(added.position.y) && !covers(overlay, false, id)) {
			result[added.mesh < meshes ? added.mesh : 0].push_back(id);
		}
	}
	return result;
}

/// Appends the instances to draw for each mesh; see overlaid(). Throws std::bad_alloc.
void add_overlaid(const std::shared_ptr<const CompactTile> &tile, const LayerSettings &layer, const TileSpace &space,
		const Overlay &overlay, OverlaidMeshes &r_meshes) {
	const bool any_removed = overlay.state != nullptr && overlay.state->any_removed(layer.set.layer);
	const bool any_hidden = overlay.hidden != nullptr && !overlay.hidden->empty();
	const std::vector<Ids> added = added_by_mesh(tile->meshes.size(), layer, space, overlay);
	for (std::size_t at = 0; at < tile->meshes.size(); ++at) {
		const CompactMesh &mesh = tile->meshes[at];
		const bool any_covered = any_removed || any_hidden;
		if (!any_covered && added[at].empty()) {
			// The mesh has no changes, so it is shared with the tile.
			r_meshes.emplace_back(tile, &mesh);
			continue;
		}
		const std::vector<std::uint32_t> retained = standing_of(mesh, overlay, any_removed);
		if (retained.size() == mesh.size() && added[at].empty()) {
			// All instances are kept, so the mesh is shared with the tile.
			r_meshes.emplace_back(tile, &mesh);
		} else {
			r_meshes.push_back(rebuilt(mesh, layer, tile->origin, overlay, added[at], retained));
		}
	}
}

} // namespace

Status overlaid(const std::shared_ptr<const CompactTile> &tile, const LayerSettings &layer, const TileSpace &space,
		const Overlay &overlay, OverlaidMeshes &r_meshes) {
	OverlaidMeshes meshes;
	const Status status = guarded("tile", std::max(space.size().x, space.size().y),
			[&] { add_overlaid(tile, layer, space, overlay, meshes); });
	if (status.ok()) {
		r_meshes = std::move(meshes);
	}
	return status;
}

} // namespace thicket
