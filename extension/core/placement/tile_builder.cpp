#include "core/placement/tile_builder.hpp"

#include "core/placement/mesh_choice.hpp"
#include "core/placement/rank_order.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace thicket {

namespace {

/// Points between two looks at the cancel flag, and in one call of the terrain: far below a millisecond of work, and
/// the ground of a batch is still in the cache when the rules read it.
constexpr std::size_t batch = 2048;

/// Where the height of a tile's origin is taken from, in tile sizes from its centre. Several places, because one may be
/// a hole.
constexpr std::array<glm::dvec2, 5> probes{{{0.0, 0.0}, {-0.25, -0.25}, {0.25, -0.25}, {-0.25, 0.25}, {0.25, 0.25}}};

bool raised(const std::atomic<bool> *cancel) { return cancel != nullptr && cancel->load(std::memory_order_relaxed); }

constexpr Status cancelled{ErrorCode::cancelled, "tile", 0.0};

/// The mean of the heights that there are, in whole metres; 0 for none.
double origin_height(std::span<const Ground> ground) {
	double sum = 0.0;
	double count = 0.0;
	for (const Ground &each : ground) {
		if (std::isfinite(each.height)) {
			sum += each.height;
			count += 1.0;
		}
	}
	return count > 0.0 ? std::floor(sum / count + 0.5) : 0.0;
}

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

/// What stays between the steps, and the memory that stays between tiles.
struct TileBuilder::Workspace {
	TileSampler sampler;
	std::vector<SamplePoint> points;

	// Of the last successful `find_points`.
	bool found = false;
	PointSet set;
	Placement placement;
	PreparedRules rules;
	MeshChoice mesh_choice;
	Rect rect;
	std::size_t sampled = 0;
	std::vector<glm::dvec2> positions; ///< Of the points that passed the density, then of the probes.
	std::vector<std::uint64_t> ids;    ///< Of those points.
	std::vector<std::uint32_t> ranks;

	std::vector<Ground> ground; ///< For `build`, which asks the terrain itself.

	// Of `place`: for each instance its rank key, sorted, and its mesh.
	std::vector<std::uint64_t> order;
	std::vector<std::uint64_t> order_scratch;
	std::vector<std::uint8_t> mesh_of;
	std::array<std::size_t, max_meshes> mesh_sizes{};

	void keep_dense(const std::vector<SamplePoint> &sampled_points);
	void filter(std::span<const Ground> batch_ground, std::size_t first);
	void choose_meshes();
	Status write(std::span<const Ground> all_ground, TileInstances &r_tile, const std::atomic<bool> *cancel);
};

/// Splits the points that pass the density into one array for each part, and adds the probes.
void TileBuilder::Workspace::keep_dense(const std::vector<SamplePoint> &sampled_points) {
	sampled = sampled_points.size();
	positions.clear();
	ids.clear();
	ranks.clear();
	for (const SamplePoint &point : sampled_points) {
		if (rules.passes_density(point.rank)) {
			positions.push_back(point.position);
			ids.push_back(point.id);
			ranks.push_back(point.rank);
		}
	}
	for (const glm::dvec2 probe : probes) {
		positions.push_back(rect.center() + probe * rect.size());
	}
}

/// Adds those of the points from `first` on that pass the rules to the order.
void TileBuilder::Workspace::filter(std::span<const Ground> batch_ground, std::size_t first) {
	for (std::size_t i = 0; i < batch_ground.size(); ++i) {
		const std::size_t point = first + i;
		if (rules.passes_ground(batch_ground[i], ids[point], set.seed)) {
			order.push_back(rank_key(ranks[point], point));
		}
	}
}

void TileBuilder::Workspace::choose_meshes() {
	mesh_of.resize(order.size());
	mesh_sizes.fill(0);
	for (std::size_t i = 0; i < order.size(); ++i) {
		const std::size_t mesh = mesh_choice.mesh_for(set.seed, ids[point_of(order[i])]);
		mesh_of[i] = static_cast<std::uint8_t>(mesh);
		++mesh_sizes[mesh];
	}
}

/// Writes the transforms of the instances in order, each to the end of its mesh's arrays.
Status TileBuilder::Workspace::write(
		std::span<const Ground> all_ground, TileInstances &r_tile, const std::atomic<bool> *cancel) {
	const glm::dvec2 center = rect.center();
	const double height = origin_height(all_ground.subspan(ids.size()));
	r_tile.origin = {center.x, height, center.y};
	r_tile.counts = {sampled, ids.size(), order.size()};
	r_tile.meshes.resize(mesh_choice.size());
	std::array<std::size_t, max_meshes> ends{};
	for (std::size_t mesh = 0; mesh < r_tile.meshes.size(); ++mesh) {
		r_tile.meshes[mesh].resize(mesh_sizes[mesh]);
		open_bounds(r_tile.meshes[mesh]);
	}
	for (std::size_t i = 0; i < order.size(); ++i) {
		if (i % batch == 0 && raised(cancel)) {
			r_tile.meshes.clear();
			return cancelled;
		}
		const std::uint32_t point = point_of(order[i]);
		const Ground &ground_here = all_ground[point];
		const glm::vec3 position{
				static_cast<float>(positions[point].x - center.x),
				static_cast<float>(ground_here.height + placement.height_offset - height),
				static_cast<float>(positions[point].y - center.y),
		};
		MeshInstances &mesh = r_tile.meshes[mesh_of[i]];
		const std::size_t at = ends[mesh_of[i]]++;
		const std::span<float, transform_floats> transform(
				mesh.buffer.data() + at * transform_floats, transform_floats);
		const float scale = write_transform(placement, set.seed, ids[point], ground_here.normal, position, transform);
		mesh.ids[at] = ids[point];
		mesh.ranks[at] = ranks[point];
		mesh.min = glm::min(mesh.min, position);
		mesh.max = glm::max(mesh.max, position);
		mesh.max_scale = std::max(mesh.max_scale, scale);
	}
	std::for_each(r_tile.meshes.begin(), r_tile.meshes.end(), close_bounds);
	return {};
}

TileBuilder::TileBuilder() : workspace_(std::make_unique<Workspace>()) {}
TileBuilder::~TileBuilder() = default;
TileBuilder::TileBuilder(TileBuilder &&) noexcept = default;
TileBuilder &TileBuilder::operator=(TileBuilder &&) noexcept = default;

Status TileBuilder::build(const LayerSettings &layer, const Terrain &terrain, const Rect &rect, TileInstances &r_tile,
		const std::atomic<bool> *cancel) {
	if (const Status status = find_points(layer, rect, cancel); !status.ok()) {
		return status;
	}
	Workspace &work = *workspace_;
	work.ground.resize(work.positions.size());
	for (std::size_t first = 0; first < work.positions.size(); first += batch) {
		if (raised(cancel)) {
			return cancelled;
		}
		const std::size_t count = std::min(batch, work.positions.size() - first);
		const Status status = terrain.sample(
				std::span(work.positions).subspan(first, count), std::span(work.ground).subspan(first, count));
		if (!status.ok()) {
			return status;
		}
	}
	return place(work.ground, r_tile, cancel);
}

Status TileBuilder::find_points(const LayerSettings &layer, const Rect &rect, const std::atomic<bool> *cancel) {
	if (const Status status = validate(layer); !status.ok()) {
		return status;
	}
	Workspace &work = *workspace_;
	if (const Status status = work.sampler.sample(layer.set, rect, work.points, cancel); !status.ok()) {
		return status;
	}
	const Status prepared = work.rules.set(layer.rules);
	work.set = layer.set;
	work.placement = layer.placement;
	work.mesh_choice.set(layer.mesh_weights);
	work.rect = rect;
	work.keep_dense(work.points);
	work.found = prepared.ok();
	return prepared;
}

std::span<const glm::dvec2> TileBuilder::positions() const { return workspace_->positions; }

Status TileBuilder::place(std::span<const Ground> ground, TileInstances &r_tile, const std::atomic<bool> *cancel) {
	Workspace &work = *workspace_;
	if (!work.found) {
		return {ErrorCode::missing, "points", 0.0};
	}
	if (ground.size() != work.positions.size()) {
		return {ErrorCode::wrong_size, "ground", static_cast<double>(ground.size())};
	}
	work.order.clear();
	for (std::size_t first = 0; first < work.ids.size(); first += batch) {
		if (raised(cancel)) {
			return cancelled;
		}
		work.filter(ground.subspan(first, std::min(batch, work.ids.size() - first)), first);
	}
	sort_by_rank(work.order, work.ids, work.order_scratch);
	work.choose_meshes();
	return work.write(ground, r_tile, cancel);
}

const SampleStats &TileBuilder::sample_stats() const { return workspace_->sampler.stats(); }

} // namespace thicket
