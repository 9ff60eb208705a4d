#include "core/placement/tile_pieces.hpp"

#include "core/base/guard.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace thicket {

namespace {

/// The minimum width of a piece, in radii of the set and in margins of other layers. Narrow pieces
/// are sampled less efficiently, and the margin is sampled again for each piece.
constexpr double radii = 64.0;
constexpr double margins = 8.0;

double points_in(const Rect &rect, const LayerGraph &graph) {
	double max_cost = 0.0;
	for (const LayerGraph::Node &node : graph.nodes()) {
		const glm::dvec2 sides = rect.size() + 2.0 * node.margin;
		max_cost = std::max(max_cost, sides.x * sides.y * point_density(node.layer->set));
	}
	return max_cost;
}

/// Copies a piece's values to the index of its first point, and frees them.
template <class Values, class Target>
void put(Values &r_values, Target &r_target, std::size_t first) {
	std::ranges::copy(r_values, r_target.begin() + static_cast<std::ptrdiff_t>(first));
	r_values = {};
}

} // namespace

PieceGrid::PieceGrid(const TileSpace &space, const LayerGraph &graph) : space_(space) {
	// A rectangle that the sampler will reject is not divided, so that the sampler reports the
	// error.
	if (graph.nodes().empty() || !space.finite() || space.empty() || points_in(space, graph) > max_points_per_call) {
		return;
	}
	double margin = 0.0;
	for (const LayerGraph::Node &node : graph.nodes()) {
		margin = std::max(margin, node.margin);
	}
	const double side = std::max(radii * graph.nodes().back().layer->set.radius, margins * margin);
	columns_ = static_cast<std::size_t>(std::max(1.0, std::floor(space.size().x / side)));
	rows_ = static_cast<std::size_t>(std::max(1.0, std::floor(space.size().y / side)));
}

/// Returns bit-identical coordinates for all pieces that share this corner.
glm::dvec2 PieceGrid::corner(std::size_t column, std::size_t row) const {
	const auto along = [](double min, double max, std::size_t at, std::size_t count) {
		return at == count ? max : min + (max - min) * (static_cast<double>(at) / static_cast<double>(count));
	};
	return {along(space_.min.x, space_.max.x, column, columns_), along(space_.min.y, space_.max.y, row, rows_)};
}

TileSpace PieceGrid::piece(std::size_t index) const {
	const std::size_t column = index % columns_;
	const std::size_t row = index / columns_;
	return {{corner(column, row), corner(column + 1, row + 1)}, space_.bottom, space_.top};
}

Status TilePieces::Worker::find(
		const Terrain &terrain, const TileSpace &piece, const std::atomic<bool> *cancel, Found &r_found) {
	if (const Status status = filter.sample(piece, terrain.surface(), cancel); !status.ok()) {
		return status;
	}
	Status status = filter.complete(terrain, positions, queries, ground, cancel);
	if (status.ok()) {
		status = filter.filter(ground, cancel);
	}
	if (!status.ok()) {
		return status;
	}
	const LayerFilter &own = filter.own();
	PlacedPoints points{own.positions(), filter.own_ground(ground), own.ids(), own.accepted(), own.thinning_ranks()};
	status = fractions.find(filter, filter.all_own_ground(ground), points, cancel);
	const auto choose = [&](const auto &from, auto &r_to) {
		r_to.reserve(from.empty() ? 0 : points.accepted.size());
		for (std::size_t i = 0; i < points.accepted.size() && !from.empty(); ++i) {
			r_to.push_back(from[points.accepted[i]]);
		}
	};
	choose(points.positions, r_found.positions);
	choose(points.ground, r_found.ground);
	choose(points.ids, r_found.ids);
	choose(points.color_fractions, r_found.color_fractions);
	choose(points.variation_fractions, r_found.variation_fractions);
	choose(points.scale_fractions, r_found.scale_fractions);
	r_found.world_sources = points.world_sources;
	r_found.world_values.reserve(points.world_sources * points.accepted.size());
	for (std::size_t i = 0; points.world_sources > 0 && i < points.accepted.size(); ++i) {
		const std::span<const float> values = points.world_values_of(points.accepted[i]);
		r_found.world_values.insert(r_found.world_values.end(), values.begin(), values.end());
	}
	r_found.thinning_ranks.assign(points.thinning_ranks.begin(), points.thinning_ranks.end());
	r_found.counts = {own.sampled(), own.positions().size(), own.accepted().size()};
	r_found.stats = filter.sample_stats();
	return status;
}

/// Adds up the counts of all pieces, and allocates the memory for their points.
void TilePieces::reserve_pieces() {
	std::size_t total = 0;
	bool colors = false;
	bool variations = false;
	bool scales = false;
	counts_ = {};
	stats_ = {};
	world_sources_ = 0;
	for (Found &found : found_) {
		found.first = std::exchange(total, total + found.ids.size());
		counts_.sampled += found.counts.sampled;
		counts_.dense += found.counts.dense;
		counts_.placed += found.counts.placed;
		stats_.add(found.stats);
		colors = colors || !found.color_fractions.empty();
		variations = variations || !found.variation_fractions.empty();
		scales = scales || !found.scale_fractions.empty();
		world_sources_ = std::max(world_sources_, found.world_sources);
	}
	positions_.resize(total);
	ground_.resize(total);
	ids_.resize(total);
	thinning_ranks_.resize(total);
	accepted_.resize(total);
	color_fractions_.resize(colors ? total : 0);
	variation_fractions_.resize(variations ? total : 0);
	scale_fractions_.resize(scales ? total : 0);
	world_values_.resize(world_sources_ * total);
}

/// Moves the results of a piece to the common arrays.
void TilePieces::gather(Found &r_found) {
	const auto begin = accepted_.begin() + static_cast<std::ptrdiff_t>(r_found.first);
	std::iota(
			begin, begin + static_cast<std::ptrdiff_t>(r_found.ids.size()), static_cast<std::uint32_t>(r_found.first));
	put(r_found.positions, positions_, r_found.first);
	put(r_found.ground, ground_, r_found.first);
	put(r_found.ids, ids_, r_found.first);
	put(r_found.thinning_ranks, thinning_ranks_, r_found.first);
	put(r_found.color_fractions, color_fractions_, r_found.first);
	put(r_found.variation_fractions, variation_fractions_, r_found.first);
	put(r_found.scale_fractions, scale_fractions_, r_found.first);
	put(r_found.world_values, world_values_, world_sources_ * r_found.first);
}

Status TilePieces::find(const LayerSettings &layer, const Terrain &terrain, const PieceGrid &grid,
		const std::atomic<bool> *cancel, CallerThreads &threads) {
	const std::size_t count = grid.count();
	std::vector<Status> statuses(count);
	found_.clear();
	found_.resize(count);
	std::atomic<std::size_t> next = 0;
	std::atomic<bool> has_failed = false;
	threads.run([&](std::size_t) {
		std::unique_ptr<Worker> worker;
		for (std::size_t at = next++; at < count && !has_failed; at = next++) {
			statuses[at] = guarded("tile", static_cast<double>(count), [&] {
				if (worker == nullptr) {
					worker = std::make_unique<Worker>(margins_, cache_, instances_);
					const glm::dvec2 size = grid.piece(0).size();
					worker->filter.set(layer, &terrain, std::max(size.x, size.y));
				}
				return worker->find(terrain, grid.piece(at), cancel, found_[at]);
			});
			has_failed = has_failed || !statuses[at].ok();
		}
	});
	// Pieces are started in order, so the first failed piece is the one at which a single thread
	// would fail.
	const auto first = std::ranges::find_if(statuses, [](const Status &status) { return !status.ok(); });
	if (first != statuses.end()) {
		throw_if_out_of_memory(*first);
		return *first;
	}
	reserve_pieces();
	next = 0;
	threads.run([&](std::size_t) {
		for (std::size_t at = next++; at < count; at = next++) {
			gather(found_[at]);
		}
	});
	return {};
}

PlacedPoints TilePieces::points() const {
	return {positions_, ground_, ids_, accepted_, thinning_ranks_, color_fractions_, variation_fractions_,
			scale_fractions_, world_values_, world_sources_};
}

} // namespace thicket
