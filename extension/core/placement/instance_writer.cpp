#include "core/placement/instance_writer.hpp"

#include "core/placement/rank_order.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <limits>

namespace thicket {

namespace {

/// Instances between two looks at the cancel flag: far below a millisecond of work.
constexpr std::size_t batch = 2048;

/// Empties a mesh's box, to be grown again.
void open_bounds(MeshInstances &mesh) {
	mesh.min = glm::vec3(std::numeric_limits<float>::max());
	mesh.max = -mesh.min;
	mesh.max_scale = 0.0f;
}

void close_bounds(MeshInstances &mesh) {
	if (mesh.size() == 0) {
		mesh.min = mesh.max = glm::vec3(0.0f);
	}
}

} // namespace

void InstanceWriter::choose_meshes(const LayerSettings &layer, const StandingPoints &points) {
	mesh_choice_.set(layer.mesh_weights);
	mesh_of_.resize(order_.size());
	mesh_sizes_.fill(0);
	for (std::size_t i = 0; i < order_.size(); ++i) {
		const std::size_t mesh = mesh_choice_.mesh_for(layer.set.seed, points.ids[point_of(order_[i])]);
		mesh_of_[i] = static_cast<std::uint8_t>(mesh);
		++mesh_sizes_[mesh];
	}
}

Status InstanceWriter::write(const LayerSettings &layer, const StandingPoints &points, TileInstances &r_tile,
		const std::atomic<bool> *cancel) {
	order_.resize(points.standing.size());
	for (std::size_t i = 0; i < order_.size(); ++i) {
		order_[i] = rank_key(points.thinning_ranks[i], points.standing[i]);
	}
	sort_by_rank(order_, points.ids, order_scratch_);
	choose_meshes(layer, points);
	r_tile.meshes.resize(mesh_choice_.size());
	std::array<std::size_t, max_meshes> ends{};
	for (std::size_t mesh = 0; mesh < r_tile.meshes.size(); ++mesh) {
		r_tile.meshes[mesh].resize(mesh_sizes_[mesh]);
		open_bounds(r_tile.meshes[mesh]);
	}
	const Placement &placement = layer.placement;
	for (std::size_t i = 0; i < order_.size(); ++i) {
		if (i % batch == 0 && cancel != nullptr && cancel->load(std::memory_order_relaxed)) {
			r_tile.meshes.clear();
			return {ErrorCode::cancelled, "tile", 0.0};
		}
		const std::uint32_t point = point_of(order_[i]);
		const Ground &ground = points.ground[point];
		const glm::vec3 position{
				static_cast<float>(points.positions[point].x - r_tile.origin.x),
				static_cast<float>(ground.height + placement.height_offset - r_tile.origin.y),
				static_cast<float>(points.positions[point].y - r_tile.origin.z),
		};
		MeshInstances &mesh = r_tile.meshes[mesh_of_[i]];
		const std::size_t at = ends[mesh_of_[i]]++;
		const std::span<float, transform_floats> transform(
				mesh.buffer.data() + at * transform_floats, transform_floats);
		const float scale =
				write_transform(placement, layer.set.seed, points.ids[point], ground.normal, position, transform);
		mesh.ids[at] = points.ids[point];
		mesh.ranks[at] = static_cast<std::uint32_t>(order_[i] >> 32);
		mesh.min = glm::min(mesh.min, position);
		mesh.max = glm::max(mesh.max, position);
		mesh.max_scale = std::max(mesh.max_scale, scale);
	}
	std::for_each(r_tile.meshes.begin(), r_tile.meshes.end(), close_bounds);
	return {};
}

} // namespace thicket
