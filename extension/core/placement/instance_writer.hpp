#pragma once

#include "core/base/caller_threads.hpp"
#include "core/placement/layer.hpp"
#include "core/placement/mesh_choice.hpp"
#include "core/placement/mesh_rules.hpp"
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

/// The points of a tile. `accepted` contains the indices of the points that become instances, and
/// `thinning_ranks` has one entry for each of these. All other lists have one entry for each point.
struct PlacedPoints {
	std::span<const glm::dvec2> positions; ///< Positions of the points in world meters.
	std::span<const Ground> ground;
	std::span<const std::uint64_t> ids;
	std::span<const std::uint32_t> accepted;
	std::span<const std::uint32_t> thinning_ranks;
	/// Fractions for the colors. They are valid for points that become instances. Empty if colors are
	/// random.
	std::span<const float> color_fractions{};
	std::span<const float> variation_fractions{}; ///< Fractions for the variations, under the same conditions.
	std::span<const float> scale_fractions{};     ///< Fractions for the scales, under the same conditions.
	/// The values of LayerSettings::world_sources for the choice of meshes: `world_sources` numbers for
	/// each point, under the same conditions. Empty if no mesh needs any.
	std::span<const float> world_values{};
	std::size_t world_sources = 0;

	std::span<const float> world_values_of(std::uint32_t point) const {
		return world_values.subspan(world_sources * point, world_sources);
	}

	SourceFractions fractions_of(std::uint32_t point) const {
		const auto at = [point](std::span<const float> fractions) {
			return fractions.empty() ? unknown_fraction : fractions[point];
		};
		return {at(color_fractions), at(variation_fractions), at(scale_fractions)};
	}
};

/// The bounds of the positions of a mesh's instances, and their largest scale.
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

/// Performs the last step of generating a tile: writes the mesh, transform and appearance of each
/// instance, in the order of thinning ranks. A writer reuses its memory.
class InstanceWriter {
public:
	/// Replaces the origin and the meshes of `r_tile`. The settings must be valid. If `cancel` is
	/// set, returns ErrorCode::cancelled, and the meshes are cleared or unchanged. If a field of mesh rules fails, returns
	/// its error. If memory runs out, throws std::bad_alloc. Both leave the tile unchanged. If
	/// `threads` is not null, they share the work. They do not affect the result.
	Status write(const LayerSettings &layer, const PlacedPoints &points, glm::dvec3 origin, TileInstances &r_tile,
			const std::atomic<bool> *cancel, CallerThreads *threads = nullptr);

private:
	/// The instances in a range of ranks. The parts are in order, and each thread takes the next
	/// unprocessed one.
	struct Part {
		std::uint64_t first_rank = 0;
		std::uint64_t end_rank = 0;
		std::vector<std::uint64_t> order; ///< The rank_key of each instance, sorted.
		std::vector<std::uint64_t> scratch;
		std::vector<std::uint8_t> mesh_of; ///< Mesh of each instance, in the same order.
		std::array<std::size_t, max_meshes> sizes{};
		/// For each mesh, the index of the part's next instance.
		std::array<std::size_t, max_meshes> ends{};
		std::vector<InstanceBounds> bounds; ///< Bounds of the part's instances, by mesh.
		// Working memory for meshes with rules.
		std::vector<MeshPoint> mesh_points;
		MeshRules::Scratch mesh_scratch;
	};

	void divide(const PlacedPoints &points, std::size_t part_count);
	Status sort(const LayerSettings &layer, const PlacedPoints &points, Part &r_part,
			const std::atomic<bool> *cancel) const;
	Status choose_by_rules(const PlacedPoints &points, Part &r_part, const std::atomic<bool> *cancel) const;
	void reserve_buffers(const InstanceData &data, std::vector<MeshInstances> &r_meshes);
	Status write_part(const LayerSettings &layer, const PlacedPoints &points, Part &r_part, TileInstances &r_tile,
			const std::atomic<bool> *cancel) const;

	MeshChoice mesh_choice_;
	MeshRules mesh_rules_;
	std::vector<Part> parts_{1};
};

} // namespace thicket
