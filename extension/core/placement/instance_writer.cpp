#include "core/placement/instance_writer.hpp"

#include "core/base/guard.hpp"
#include "core/base/progress.hpp"
#include "core/placement/rank_order.hpp"
#include "core/placement/transform_batch.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace thicket {

namespace {

/// Number of instances between two checks of the cancel flag. Writing them takes far less than a
/// millisecond.
constexpr std::size_t instances_per_check = 2048;

/// Number of classes for counting ranks, to find where each part begins.
constexpr std::size_t rank_classes = 1 << 12;
constexpr int rank_class_shift = 20;

/// Number of parts per thread. More parts balance the load better, but each part must scan all
/// ranks.
constexpr std::size_t parts_each = 2;

/// Adds a point that becomes an instance to a batch.
void add_point(const LayerSettings &layer, const PlacedPoints &points, std::uint32_t point, glm::dvec3 origin,
		TransformBatch &r_batch) {
	const Ground &ground = points.ground[point];
	const glm::dvec2 at = points.positions[point];
	const glm::dvec3 on_ground(at.x, ground.height, at.y);
	const glm::vec3 position(layer.planet.above(on_ground, layer.placement.height_offset) - origin);
	r_batch.set_heading(row_heading(layer, points.ids[point]));
	r_batch.add(points.ids[point], ground.normal, standing_position(layer.placement, ground.normal, position));
}

/// Writes instance `in_batch` of a batch, for the point in `key`, to index `at` of its mesh.
void write_instance(const LayerSettings &layer, const PlacedPoints &points, std::uint64_t key,
		const TransformBatch &batch, std::size_t in_batch, std::size_t at, MeshInstances &r_mesh,
		InstanceBounds &r_bounds) {
	const auto rank = static_cast<std::uint32_t>(key >> 32);
	const std::uint64_t id = batch.ids[in_batch];
	const float scale = batch.scale[in_batch];
	const std::span<float> floats = r_mesh.floats_of(at);
	batch.write(in_batch, floats.first<transform_floats>());
	r_mesh.ids[at] = id;
	r_mesh.ranks[at] = rank;
	r_mesh.normals[at] = batch.normal(in_batch);
	r_bounds.add({batch.position(in_batch), batch.position(in_batch), scale});
	if (!r_mesh.fractions.empty()) {
		r_mesh.fractions[at] = points.fractions_of(point_of(key));
	}
	if (r_mesh.stride > transform_floats) {
		write_instance_data(layer.instance_data, layer.set.seed, id, rank, scale, floats.subspan(transform_floats),
				points.fractions_of(point_of(key)));
	}
}

} // namespace

/// Assigns each part a range of ranks with about the same number of points.
void InstanceWriter::divide(const PlacedPoints &points, std::size_t part_count) {
	constexpr std::uint64_t end_of_ranks = std::uint64_t{1} << 32;
	parts_.resize(part_count);
	if (part_count == 1) {
		// The only part contains all ranks, so they need not be counted.
		parts_.front().first_rank = 0;
		parts_.front().end_rank = end_of_ranks;
		return;
	}
	std::vector<std::uint32_t> counts(rank_classes);
	for (const std::uint32_t rank : points.thinning_ranks) {
		++counts[rank >> rank_class_shift];
	}
	std::size_t points_before = 0;
	std::size_t rank_class = 0;
	std::uint64_t first_rank = 0;
	for (std::size_t part = 0; part < part_count; ++part) {
		while (part + 1 < part_count && rank_class < rank_classes &&
				points_before * part_count < (part + 1) * points.thinning_ranks.size()) {
			points_before += counts[rank_class++];
		}
		const std::uint64_t end = part + 1 < part_count ? std::uint64_t{rank_class} << rank_class_shift : end_of_ranks;
		parts_[part].first_rank = std::exchange(first_rank, end);
		parts_[part].end_rank = end;
	}
}

/// Collects the points of a part's ranks, sorts them by rank, and assigns each of them a mesh.
Status InstanceWriter::sort(
		const LayerSettings &layer, const PlacedPoints &points, Part &r_part, const std::atomic<bool> *cancel) const {
	r_part.order.clear();
	r_part.order.reserve(points.accepted.size() / parts_.size());
	for (std::size_t i = 0; i < points.accepted.size(); ++i) {
		if (points.thinning_ranks[i] >= r_part.first_rank && points.thinning_ranks[i] < r_part.end_rank) {
			r_part.order.push_back(rank_key(points.thinning_ranks[i], points.accepted[i]));
		}
	}
	sort_by_rank(r_part.order, points.ids, r_part.scratch);
	r_part.mesh_of.resize(r_part.order.size());
	r_part.bounds.assign(mesh_choice_.size(), InstanceBounds{});
	r_part.sizes.fill(0);
	if (!mesh_rules_.empty()) {
		return choose_by_rules(points, r_part, cancel);
	}
	for (std::size_t i = 0; i < r_part.order.size(); ++i) {
		const std::size_t mesh = mesh_choice_.mesh_for(layer.set.seed, points.ids[point_of(r_part.order[i])]);
		r_part.mesh_of[i] = static_cast<std::uint8_t>(mesh);
		++r_part.sizes[mesh];
	}
	return {};
}

/// Assigns the meshes of a layer whose meshes have rules.
Status InstanceWriter::choose_by_rules(
		const PlacedPoints &points, Part &r_part, const std::atomic<bool> *cancel) const {
	for (std::size_t first = 0; first < r_part.order.size(); first += MeshRules::capacity) {
		if (is_cancelled(cancel)) {
			return {ErrorCode::cancelled, "tile", 0.0};
		}
		const std::size_t count = std::min(MeshRules::capacity, r_part.order.size() - first);
		const std::span<std::uint8_t> meshes = std::span(r_part.mesh_of).subspan(first, count);
		r_part.mesh_points.clear();
		for (const std::uint64_t key : std::span(r_part.order).subspan(first, count)) {
			const std::uint32_t point = point_of(key);
			r_part.mesh_points.push_back(
					{points.ids[point], points.positions[point], points.ground[point], points.world_values_of(point)});
		}
		const Status status = mesh_rules_.choose(r_part.mesh_points, meshes, r_part.mesh_scratch);
		if (!status.ok()) {
			return status;
		}
		for (const std::uint8_t mesh : meshes) {
			++r_part.sizes[mesh];
		}
	}
	return {};
}

/// Resizes each mesh to its final size, and determines where each part's instances begin in it. All
/// memory is allocated before anything changes.
void InstanceWriter::reserve_buffers(const InstanceData &data, std::vector<MeshInstances> &r_meshes) {
	std::array<std::size_t, max_meshes> sizes{};
	for (Part &part : parts_) {
		for (std::size_t mesh = 0; mesh < mesh_choice_.size(); ++mesh) {
			part.ends[mesh] = std::exchange(sizes[mesh], sizes[mesh] + part.sizes[mesh]);
		}
	}
	const std::size_t known = std::min(mesh_choice_.size(), r_meshes.size());
	std::vector<MeshInstances> more(mesh_choice_.size() - known);
	r_meshes.reserve(mesh_choice_.size());
	for (std::size_t mesh = 0; mesh < mesh_choice_.size(); ++mesh) {
		(mesh < known ? r_meshes[mesh] : more[mesh - known]).reserve(sizes[mesh], data);
	}
	r_meshes.resize(known);
	std::move(more.begin(), more.end(), std::back_inserter(r_meshes));
	for (std::size_t mesh = 0; mesh < r_meshes.size(); ++mesh) {
		r_meshes[mesh].resize(sizes[mesh], data);
	}
}

Status InstanceWriter::write_part(const LayerSettings &layer, const PlacedPoints &points, Part &r_part,
		TileInstances &r_tile, const std::atomic<bool> *cancel) const {
	TransformBatch batch;
	std::array<double, TransformBatch::capacity> scale_numbers;
	const ScaleSource &scale = layer.instance_data.scale;
	const UpField up(layer.planet, r_tile.origin);
	for (std::size_t first = 0; first < r_part.order.size(); first += TransformBatch::capacity) {
		if (first % instances_per_check == 0 && is_cancelled(cancel)) {
			return {ErrorCode::cancelled, "tile", 0.0};
		}
		const std::span<const std::uint64_t> keys =
				std::span(r_part.order).subspan(first, std::min(TransformBatch::capacity, r_part.order.size() - first));
		batch.count = 0;
		for (const std::uint64_t key : keys) {
			add_point(layer, points, point_of(key), r_tile.origin, batch);
		}
		if (scale.used()) {
			std::ranges::transform(keys, scale_numbers.begin(), [&](std::uint64_t key) {
				const std::uint32_t point = point_of(key);
				return scale_number(scale, layer.set.seed, points.ids[point], points.fractions_of(point).scale);
			});
		}
		batch.make(layer.placement, layer.set.seed, up, std::span(scale_numbers).first(scale.used() ? keys.size() : 0));
		for (std::size_t i = 0; i < keys.size(); ++i) {
			const std::size_t mesh = r_part.mesh_of[first + i];
			write_instance(
					layer, points, keys[i], batch, i, r_part.ends[mesh]++, r_tile.meshes[mesh], r_part.bounds[mesh]);
		}
	}
	return {};
}

Status InstanceWriter::write(const LayerSettings &layer, const PlacedPoints &points, glm::dvec3 origin,
		TileInstances &r_tile, const std::atomic<bool> *cancel, CallerThreads *threads) {
	mesh_choice_.set(layer.mesh_weights);
	mesh_rules_.set(layer);
	const std::size_t helpers = threads != nullptr ? threads->count() : 0;
	divide(points, helpers > 0 ? parts_each * (helpers + 1) : 1);
	const auto for_each_part = [&](const auto &work) -> Status {
		if (parts_.size() == 1) {
			// A single part needs no further threads.
			return work(parts_.front());
		}
		std::vector<Status> statuses(parts_.size());
		std::atomic<std::size_t> next = 0;
		threads->run([&](std::size_t) {
			for (std::size_t part = next++; part < parts_.size(); part = next++) {
				statuses[part] = guarded(
						"tile", static_cast<double>(points.accepted.size()), [&] { return work(parts_[part]); });
			}
		});
		const auto failed = std::ranges::find_if(statuses, [](const Status &status) { return !status.ok(); });
		return failed != statuses.end() ? *failed : Status{};
	};
	const Status sorted = for_each_part([&](Part &part) { return sort(layer, points, part, cancel); });
	throw_if_out_of_memory(sorted);
	if (!sorted.ok()) {
		return sorted;
	}
	reserve_buffers(layer.instance_data, r_tile.meshes);
	r_tile.origin = origin;
	const Status status = for_each_part([&](Part &part) { return write_part(layer, points, part, r_tile, cancel); });
	if (!status.ok()) {
		r_tile.meshes.clear();
		return status;
	}
	for (std::size_t mesh = 0; mesh < r_tile.meshes.size(); ++mesh) {
		InstanceBounds bounds;
		for (const Part &part : parts_) {
			bounds.add(part.bounds[mesh]);
		}
		MeshInstances &instances = r_tile.meshes[mesh];
		instances.min = instances.size() > 0 ? bounds.min : glm::vec3(0.0f);
		instances.max = instances.size() > 0 ? bounds.max : glm::vec3(0.0f);
		instances.max_scale = bounds.max_scale;
	}
	return {};
}

} // namespace thicket
