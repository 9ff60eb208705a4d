#pragma once

#include "core/base/lent_threads.hpp"
#include "core/placement/layer.hpp"
#include "core/placement/mesh_choice.hpp"
#include "core/placement/tile_instances.hpp"
#include "core/terrain/terrain.hpp"

#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace thicket {

/// The points of a tile, and which of them become instances. `standing` contains indices of points, and
/// `thinning_ranks` has one entry for each of these indices. All other lists have one entry for each point.
struct StandingPoints {
	std::span<const glm::dvec2> positions; ///< World meters.
	std::span<const Ground> ground;
	std::span<const std::uint64_t> ids;
	std::span<const std::uint32_t> standing;
	std::span<const std::uint32_t> thinning_ranks;
	std::span<const float> color_shares{};     ///< For points that become instances; empty if colors are random.
	std::span<const float> variation_shares{}; ///< The same for the variation.

	InstanceShares shares_of(std::uint32_t point) const {
		return {color_shares.empty() ? unknown_share : color_shares[point],
				variation_shares.empty() ? unknown_share : variation_shares[point]};
	}
};

/// The bounds of the positions of one mesh's instances, and their largest scale.
struct InstanceBounds {
	glm::vec3 min{std::numeric_limits<float>::max()};
	glm::vec3 max{-std::numeric_limits<float>::max()};
	float max_scale = 0.0f;

	void add(const InstanceBounds &other) {
		min = glm::min(min, other.min);
		max = glm::max(max, other.max);
		max_scale = std::max(max_scale, other.max_scale);
	}
};

/// The last step of generating a tile: assigns every kept point a mesh, a transform and a look, in the order in which a
/// layer is thinned. Reuses its memory.
class InstanceWriter {
public:
	/// Replaces the origin and the meshes of `r_tile`. Settings must be valid. When `cancel` is raised, clears the
	/// meshes and returns ErrorCode::cancelled. If it throws std::bad_alloc, the tile is unchanged. `threads`, if
	/// given, share the work and do not change the result.
	Status write(const LayerSettings &layer, const StandingPoints &points, glm::dvec3 origin, TileInstances &r_tile,
			const std::atomic<bool> *cancel, LentThreads *threads = nullptr);

private:
	/// The instances within a range of ranks, stored one after the other. Any free thread takes the next part.
	struct Part {
		std::uint64_t first_rank = 0;
		std::uint64_t end_rank = 0;
		std::vector<std::uint64_t> order; ///< For each instance, its thinning rank and the index of its point; sorted.
		std::vector<std::uint64_t> scratch;
		std::vector<std::uint8_t> mesh_of; ///< For each instance, in order.
		std::array<std::size_t, max_meshes> sizes{};
		std::array<std::size_t, max_meshes> ends{}; ///< Where its instances continue in each mesh.
		std::vector<InstanceBounds> bounds;         ///< The bounds of its instances, for each mesh.
	};

	void divide(const StandingPoints &points, std::size_t parts);
	void sort(const LayerSettings &layer, const StandingPoints &points, Part &r_part) const;
	void make_room(const InstanceData &data, std::vector<MeshInstances> &r_meshes);
	Status write_part(const LayerSettings &layer, const StandingPoints &points, Part &r_part, TileInstances &r_tile,
			const std::atomic<bool> *cancel) const;

	MeshChoice mesh_choice_;
	std::vector<Part> parts_{1};
};

} // namespace thicket
