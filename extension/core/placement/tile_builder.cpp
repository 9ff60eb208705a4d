#include "core/placement/tile_builder.hpp"

#include "core/base/guard.hpp"
#include "core/placement/instance_writer.hpp"
#include "core/placement/source_values.hpp"
#include "core/placement/tile_filter.hpp"
#include "core/placement/tile_pieces.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace thicket {

namespace {

/// The positions at which the height of a tile's origin is measured, in tile sizes from its center. There are several, because one may be a
/// hole.
constexpr std::array<glm::dvec2, 5> origin_probes{
		{{0.0, 0.0}, {-0.25, -0.25}, {0.25, -0.25}, {-0.25, 0.25}, {0.25, 0.25}}};

/// The mean of the known heights, in whole meters; 0 if there are none.
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

/// Replaces `r_probes` by some of the positions. The first few of them are spread as widely as all.
void choose_probes(
		std::span<const glm::dvec2> positions, std::span<const Ground> ground, std::vector<GroundProbe> &r_probes) {
	constexpr std::uint32_t golden = 2654435769; // Multiples of the golden section, modulo 2^32.
	const std::size_t count = std::min(positions.size(), max_ground_probes);
	r_probes.clear();
	for (std::uint32_t i = 0; i < count; ++i) {
		const std::size_t at = positions.size() > count ? (std::uint64_t{golden * i} * positions.size()) >> 32U : i;
		r_probes.push_back({positions[at], ground[at].height});
	}
}

} // namespace

/// The data that is kept between the steps, and the memory that is kept between tiles.
struct TileBuilder::Workspace {
	Workspace(const SampleMargins &p_margins, std::shared_ptr<BlockCache> p_cache) :
			margins(p_margins), cache(std::move(p_cache)), filter(margins, cache) {}

	SampleMargins margins;
	std::shared_ptr<BlockCache> cache;
	TileFilter filter;
	SourceValues shares;
	InstanceWriter writer;

	// From the last successful `find_points`.
	bool found = false;
	Rect rect;
	std::vector<glm::dvec2> positions; ///< Positions of all layers, then of the origin's probes.
	std::vector<GroundQuery> queries;

	std::vector<GroundProbe> probes;
	std::vector<Ground> ground; ///< For `build`, which queries the terrain itself.
	SampleStats stats;          ///< From the last call that sampled.

	Status find_points(
			const LayerSettings &layer, const Rect &rect, const std::atomic<bool> *cancel, LentThreads *threads);
	Status place(std::span<const Ground> known, TileInstances &r_tile, const std::atomic<bool> *cancel);
	void gather_positions();
	void add_origin_probes();
	Status build_together(const LayerSettings &layer, const Terrain &terrain, const Rect &rect, const PieceGrid &grid,
			TileInstances &r_tile, const std::atomic<bool> *cancel, LentThreads &threads);
};

void TileBuilder::Workspace::add_origin_probes() {
	queries.push_back({positions.size(), origin_probes.size(), {.textures = {}, .normals = false}});
	for (const glm::dvec2 probe : origin_probes) {
		positions.push_back(rect.center() + probe * rect.size());
	}
}

void TileBuilder::Workspace::gather_positions() {
	positions.clear();
	queries.clear();
	filter.add_queries(positions, queries);
	add_origin_probes();
}

/// Runs all steps in one call, on all threads.
Status TileBuilder::Workspace::build_together(const LayerSettings &layer, const Terrain &terrain, const Rect &p_rect,
		const PieceGrid &grid, TileInstances &r_tile, const std::atomic<bool> *cancel, LentThreads &threads) {
	found = false;
	rect = p_rect;
	probes.clear();
	positions.clear();
	queries.clear();
	add_origin_probes();
	ground.assign(positions.size(), Ground{});
	TilePieces pieces(margins, cache);
	Status status = ask_ground(terrain, positions, queries, ground, cancel);
	if (status.ok()) {
		status = pieces.find(layer, terrain, grid, cancel, threads);
	}
	stats = pieces.sample_stats();
	if (!status.ok()) {
		return status;
	}
	const glm::dvec3 origin{rect.center().x, origin_height(ground), rect.center().y};
	InstanceWriter large_writer; // Its memory is freed together with the pieces.
	status = large_writer.write(layer, pieces.points(), origin, r_tile, cancel, &threads);
	if (status.ok()) {
		r_tile.counts = pieces.counts();
	}
	return status;
}

Status TileBuilder::Workspace::find_points(
		const LayerSettings &layer, const Rect &p_rect, const std::atomic<bool> *cancel, LentThreads *threads) {
	found = false;
	filter.set(layer);
	const Status status = filter.sample(p_rect, cancel, threads);
	stats = filter.sample_stats();
	if (!status.ok()) {
		return status;
	}
	rect = p_rect;
	gather_positions();
	found = true;
	return {};
}

Status TileBuilder::Workspace::place(
		std::span<const Ground> known, TileInstances &r_tile, const std::atomic<bool> *cancel) {
	probes.clear();
	if (const Status status = filter.filter(known, cancel); !status.ok()) {
		return status;
	}
	const LayerFilter &own = filter.own();
	const glm::dvec2 center = rect.center();
	const glm::dvec3 origin{center.x, origin_height(known.last(origin_probes.size())), center.y};
	StandingPoints points{own.positions(), known.subspan(filter.own_first(), own.positions().size()), own.ids(),
			own.standing(), own.thinning_ranks()};
	choose_probes(points.positions, points.ground, probes);
	Status status = shares.find(filter, points, cancel);
	if (status.ok()) {
		status = writer.write(own.settings(), points, origin, r_tile, cancel);
	}
	if (status.ok()) {
		r_tile.counts = {own.sampled(), own.positions().size(), own.standing().size()};
	}
	return status;
}

TileBuilder::TileBuilder(const SampleMargins &margins, std::shared_ptr<BlockCache> cache) :
		workspace_(std::make_unique<Workspace>(margins, std::move(cache))) {}
TileBuilder::~TileBuilder() = default;
TileBuilder::TileBuilder(TileBuilder &&) noexcept = default;
TileBuilder &TileBuilder::operator=(TileBuilder &&) noexcept = default;

Status TileBuilder::build(const LayerSettings &layer, const Terrain &terrain, const Rect &rect, TileInstances &r_tile,
		const std::atomic<bool> *cancel, LentThreads *threads) {
	if (const Status status = validate(layer); !status.ok()) {
		return status;
	}
	if (threads != nullptr && threads->count() > 0) {
		if (const PieceGrid grid(rect, LayerGraph(layer)); grid.count() > 1) {
			// Pieces on many threads find the same points.
			return guarded("tile", std::max(rect.size().x, rect.size().y),
					[&] { return workspace_->build_together(layer, terrain, rect, grid, r_tile, cancel, *threads); });
		}
	}
	if (const Status status = find_points(layer, rect, cancel, threads); !status.ok()) {
		return status;
	}
	const Status status = guarded("ground", static_cast<double>(workspace_->positions.size()), [&] {
		workspace_->ground.assign(workspace_->positions.size(), Ground{});
		return ask_ground(terrain, workspace_->positions, workspace_->queries, workspace_->ground, cancel);
	});
	return status.ok() ? place(workspace_->ground, r_tile, cancel) : status;
}

Status TileBuilder::find_points(
		const LayerSettings &layer, const Rect &rect, const std::atomic<bool> *cancel, LentThreads *threads) {
	if (const Status status = validate(layer); !status.ok()) {
		return status;
	}
	return guarded("tile", std::max(rect.size().x, rect.size().y),
			[&] { return workspace_->find_points(layer, rect, cancel, threads); });
}

std::span<const glm::dvec2> TileBuilder::positions() const { return workspace_->positions; }

std::span<const GroundQuery> TileBuilder::queries() const { return workspace_->queries; }

Status TileBuilder::place(std::span<const Ground> ground, TileInstances &r_tile, const std::atomic<bool> *cancel) {
	if (!workspace_->found) {
		return {ErrorCode::missing, "points", 0.0};
	}
	if (ground.size() != workspace_->positions.size()) {
		return Status::wrong_size("ground", ground.size(), exactly(workspace_->positions.size()));
	}
	return guarded("tile", std::max(workspace_->rect.size().x, workspace_->rect.size().y),
			[&] { return workspace_->place(ground, r_tile, cancel); });
}

std::span<const GroundProbe> TileBuilder::probes() const { return workspace_->probes; }

const SampleStats &TileBuilder::sample_stats() const { return workspace_->stats; }

} // namespace thicket
