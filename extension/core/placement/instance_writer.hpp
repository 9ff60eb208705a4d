#pragma once

#include "core/placement/layer.hpp"
#include "core/placement/mesh_choice.hpp"
#include "core/placement/tile_instances.hpp"
#include "core/terrain/terrain.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// The points of a tile, and which of them stand. `standing` holds indices of points, `thinning_ranks` an entry for each of
/// those; all others have an entry for each point.
struct StandingPoints {
	std::span<const glm::dvec2> positions; ///< World meters.
	std::span<const Ground> ground;
	std::span<const std::uint64_t> ids;
	std::span<const std::uint32_t> standing;
	std::span<const std::uint32_t> thinning_ranks;
	std::span<const float> color_shares{};     ///< Of points that stand; empty for colors that are random.
	std::span<const float> variation_shares{}; ///< The same for the variation.

	InstanceShares shares_of(std::uint32_t point) const {
		return {color_shares.empty() ? unknown_share : color_shares[point],
				variation_shares.empty() ? unknown_share : variation_shares[point]};
	}
};

/// The last step of a tile: gives every point that stands a mesh, a transform and a look, in the order in which a layer thins. Keeps
/// its memory.
class InstanceWriter {
public:
	/// Replaces the origin and the meshes of `r_tile`. Valid settings only. Empties them and ends with
	/// ErrorCode::cancelled when `cancel` is raised. Throws std::bad_alloc, and leaves the tile as it was then.
	Status write(const LayerSettings &layer, const StandingPoints &points, glm::dvec3 origin, TileInstances &r_tile,
			const std::atomic<bool> *cancel);

private:
	void choose_meshes(const LayerSettings &layer, const StandingPoints &points);
	void make_room(const InstanceData &data, std::vector<MeshInstances> &r_meshes) const;

	MeshChoice mesh_choice_;
	std::vector<std::uint64_t> order_; ///< For each instance its thinning rank and the index of its point, sorted.
	std::vector<std::uint64_t> order_scratch_;
	std::vector<std::uint8_t> mesh_of_; ///< For each instance in order.
	std::array<std::size_t, max_meshes> mesh_sizes_{};
};

} // namespace thicket
