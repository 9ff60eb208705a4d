#include "core/placement/instance_writer.hpp"

#include "core/placement/instance_basis.hpp"
#include "core/placement/rank_order.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <iterator>
#include <limits>

namespace thicket {

namespace {

/// Instances between two looks at the cancel flag: far below a millisecond of work.
constexpr std::size_t between_looks = 2048;

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

/// Writes the instance that `key` names to index `at` of its mesh; it is one of a batch.
void write_instance(const LayerSettings &layer, const StandingPoints &points, std::uint64_t key, glm::dvec3 origin,
		const BasisBatch &batch, std::size_t in_batch, std::size_t at, MeshInstances &r_mesh) {
	const std::uint32_t point = point_of(key);
	const auto rank = static_cast<std::uint32_t>(key >> 32);
	const std::uint64_t id = points.ids[point];
	const Ground &ground = points.ground[point];
	const glm::vec3 position{
			static_cast<float>(points.positions[point].x - origin.x),
			static_cast<float>(ground.height + layer.placement.height_offset - origin.y),
			static_cast<float>(points.positions[point].y - origin.z),
	};
	const std::span<float> floats = r_mesh.floats_of(at);
	const auto transform = floats.first<transform_floats>();
	const float scale = batch.scale[in_batch];
	write_position(layer.placement, ground.normal, position, transform);
	batch.write(in_batch, transform);
	const InstanceShares shares = points.shares_of(point);
	write_instance_data(layer.instance_data, layer.set.seed, id, rank, scale, floats.subspan(transform_floats), shares);
	r_mesh.ids[at] = id;
	r_mesh.ranks[at] = rank;
	r_mesh.normals[at] = ground.normal;
	if (!r_mesh.shares.empty()) {
		r_mesh.shares[at] = shares;
	}
	const glm::vec3 stands{transform[3], transform[7], transform[11]};
	r_mesh.min = glm::min(r_mesh.min, stands);
	r_mesh.max = glm::max(r_mesh.max, stands);
	r_mesh.max_scale = std::max(r_mesh.max_scale, scale);
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

/// Gives each mesh the size that it will have. All memory is taken before anything changes.
void InstanceWriter::make_room(const InstanceData &data, std::vector<MeshInstances> &r_meshes) const {
	const std::size_t known = std::min(mesh_choice_.size(), r_meshes.size());
	std::vector<MeshInstances> more(mesh_choice_.size() - known);
	r_meshes.reserve(mesh_choice_.size());
	for (std::size_t mesh = 0; mesh < mesh_choice_.size(); ++mesh) {
		(mesh < known ? r_meshes[mesh] : more[mesh - known]).reserve(mesh_sizes_[mesh], data);
	}
	r_meshes.resize(known);
	std::move(more.begin(), more.end(), std::back_inserter(r_meshes));
	for (std::size_t mesh = 0; mesh < r_meshes.size(); ++mesh) {
		r_meshes[mesh].resize(mesh_sizes_[mesh], data);
	}
}

Status InstanceWriter::write(const LayerSettings &layer, const StandingPoints &points, glm::dvec3 origin,
		TileInstances &r_tile, const std::atomic<bool> *cancel) {
	order_.resize(points.standing.size());
	for (std::size_t i = 0; i < order_.size(); ++i) {
		order_[i] = rank_key(points.thinning_ranks[i], points.standing[i]);
	}
	sort_by_rank(order_, points.ids, order_scratch_);
	choose_meshes(layer, points);
	make_room(layer.instance_data, r_tile.meshes);
	r_tile.origin = origin;
	std::array<std::size_t, max_meshes> ends{};
	std::for_each(r_tile.meshes.begin(), r_tile.meshes.end(), open_bounds);
	BasisBatch batch;
	for (std::size_t first = 0; first < order_.size(); first += BasisBatch::most) {
		if (first % between_looks == 0 && cancel != nullptr && cancel->load(std::memory_order_relaxed)) {
			r_tile.meshes.clear();
			return {ErrorCode::cancelled, "tile", 0.0};
		}
		const std::span<const std::uint64_t> keys =
				std::span(order_).subspan(first, std::min(BasisBatch::most, order_.size() - first));
		batch.count = 0;
		for (const std::uint64_t key : keys) {
			batch.add(points.ids[point_of(key)], points.ground[point_of(key)].normal);
		}
		batch.make(layer.placement, layer.set.seed);
		for (std::size_t i = 0; i < keys.size(); ++i) {
			const std::size_t mesh = mesh_of_[first + i];
			write_instance(layer, points, keys[i], r_tile.origin, batch, i, ends[mesh]++, r_tile.meshes[mesh]);
		}
	}
	std::for_each(r_tile.meshes.begin(), r_tile.meshes.end(), close_bounds);
	return {};
}

} // namespace thicket
