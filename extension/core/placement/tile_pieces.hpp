#pragma once

#include "core/base/caller_threads.hpp"
#include "core/base/status.hpp"
#include "core/base/tile_grid.hpp"
#include "core/base/unfilled.hpp"
#include "core/placement/instance_writer.hpp"
#include "core/placement/layer.hpp"
#include "core/placement/source_values.hpp"
#include "core/placement/tile_filter.hpp"
#include "core/terrain/terrain.hpp"

#include <glm/vec2.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace thicket {

/// Divides a large tile into a grid of half-open pieces, which share no points.
class PieceGrid {
public:
	/// Chooses the size of the pieces. There is only one if more would not be faster. The graph of
	/// the layer provides the margins of the layers on which it depends.
	PieceGrid(const TileSpace &space, const LayerGraph &graph);

	std::size_t count() const { return columns_ * rows_; }
	TileSpace piece(std::size_t index) const;

private:
	glm::dvec2 corner(std::size_t column, std::size_t row) const;

	TileSpace space_;
	std::size_t columns_ = 1;
	std::size_t rows_ = 1;
};

/// Finds the points of a large rectangle that become instances, on all available threads. The work
/// is divided into pieces, so that each thread's data fits in its caches. The points are the same
/// as for the whole rectangle, but in a different order.
class TilePieces {
public:
	/// Creates an empty object. The caches may be null.
	TilePieces(
			const SampleMargins &margins, std::shared_ptr<BlockCache> cache, std::shared_ptr<InstanceCache> instances) :
			margins_(margins), cache_(std::move(cache)), instances_(std::move(instances)) {}

	/// Finds the points. The settings must be valid. Returns the error of the first piece that
	/// failed. Throws std::bad_alloc.
	Status find(const LayerSettings &layer, const Terrain &terrain, const PieceGrid &grid,
			const std::atomic<bool> *cancel, CallerThreads &threads);

	/// Returns the points that were found. All of them become instances.
	PlacedPoints points() const;
	const TileCounts &counts() const { return counts_; }

	/// Returns the sampling statistics of the layer itself.
	const SampleStats &sample_stats() const { return stats_; }

private:
	struct Found {
		std::vector<glm::dvec2> positions;
		std::vector<Ground> ground;
		std::vector<std::uint64_t> ids;
		std::vector<std::uint32_t> thinning_ranks;
		std::vector<float> color_fractions;
		std::vector<float> variation_fractions;
		std::vector<float> scale_fractions;
		std::vector<float> world_values;
		std::size_t world_sources = 0;
		TileCounts counts;
		SampleStats stats;
		std::size_t first = 0; ///< Index of the piece's first point in the common arrays.
	};

	struct Worker {
		Worker(const SampleMargins &margins, const std::shared_ptr<BlockCache> &cache,
				const std::shared_ptr<InstanceCache> &instances) : filter(margins, cache, instances) {}

		TileFilter filter;
		SourceValues fractions;
		std::vector<glm::dvec2> positions;
		std::vector<GroundQuery> queries;
		std::vector<Ground> ground;

		Status find(const Terrain &terrain, const TileSpace &piece, const std::atomic<bool> *cancel, Found &r_found);
	};

	void reserve_pieces();
	void gather(Found &r_found);

	SampleMargins margins_;
	std::shared_ptr<BlockCache> cache_;
	std::shared_ptr<InstanceCache> instances_;
	std::vector<Found> found_;
	TileCounts counts_;
	SampleStats stats_;

	// The common arrays with the data of all pieces.
	UnfilledVector<glm::dvec2> positions_;
	UnfilledVector<Ground> ground_;
	UnfilledVector<std::uint64_t> ids_;
	UnfilledVector<std::uint32_t> thinning_ranks_;
	UnfilledVector<std::uint32_t> accepted_;
	UnfilledVector<float> color_fractions_;
	UnfilledVector<float> variation_fractions_;
	UnfilledVector<float> scale_fractions_;
	UnfilledVector<float> world_values_;
	std::size_t world_sources_ = 0;
};

} // namespace thicket
