#include "core/placement/tile_builder.hpp"

#include "core/placement/instance_writer.hpp"

#include <algorithm>
#include <array>
#include <cmath>

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

} // namespace

/// What stays between the steps, and the memory that stays between tiles.
struct TileBuilder::Workspace {
	TileSampler sampler;
	std::vector<SamplePoint> points;

	// Of the last successful `find_points`.
	bool found = false;
	LayerSettings layer;
	PreparedRules rules;
	Rect rect;
	std::size_t sampled = 0;
	std::vector<glm::dvec2> positions; ///< Of the points that passed the density, then of the probes.
	std::vector<std::uint64_t> ids;    ///< Of those points.
	std::vector<std::uint32_t> ranks;

	std::vector<Ground> ground; ///< For `build`, which asks the terrain itself.

	// Of `place`.
	std::vector<std::uint32_t> standing;
	std::vector<std::uint32_t> thinning_ranks;
	InstanceWriter writer;

	void keep_dense(const std::vector<SamplePoint> &sampled_points);
	void filter(std::span<const Ground> batch_ground, std::size_t first);
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

/// Adds those of the points from `first` on that pass the rules to what stands.
void TileBuilder::Workspace::filter(std::span<const Ground> batch_ground, std::size_t first) {
	for (std::size_t i = 0; i < batch_ground.size(); ++i) {
		const std::size_t point = first + i;
		if (rules.passes_ground(batch_ground[i], ids[point], layer.set.seed)) {
			standing.push_back(static_cast<std::uint32_t>(point));
			thinning_ranks.push_back(ranks[point]);
		}
	}
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
	work.layer = layer;
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
	work.standing.clear();
	work.thinning_ranks.clear();
	for (std::size_t first = 0; first < work.ids.size(); first += batch) {
		if (raised(cancel)) {
			return cancelled;
		}
		work.filter(ground.subspan(first, std::min(batch, work.ids.size() - first)), first);
	}
	const glm::dvec2 center = work.rect.center();
	r_tile.origin = {center.x, origin_height(ground.subspan(work.ids.size())), center.y};
	r_tile.counts = {work.sampled, work.ids.size(), work.standing.size()};
	const StandingPoints points{work.positions, ground, work.ids, work.standing, work.thinning_ranks};
	return work.writer.write(work.layer, points, r_tile, cancel);
}

const SampleStats &TileBuilder::sample_stats() const { return workspace_->sampler.stats(); }

} // namespace thicket
