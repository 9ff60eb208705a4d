#pragma once

#include "core/base/rect.hpp"
#include "core/base/unfilled.hpp"
#include "core/placement/ground_query.hpp"
#include "core/placement/layer.hpp"
#include "core/placement/point_grid.hpp"
#include "core/rules/rules.hpp"
#include "core/sampling/tile_sampler.hpp"

#include <glm/vec2.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// Decides which points of one layer become instances in a window: call `sample`, then `filter` once the ground is known. A tile has one
/// filter for its own layer and one for each layer that its rules depend on. Reuses its memory.
class LayerFilter {
public:
	/// Sets the layer, whose settings must be valid. It must stay alive until the points are filtered. `neighbors` are
	/// the filters of layer.neighbors, in the same order.
	void set(const LayerSettings &layer, std::span<const LayerFilter *const> neighbors);

	/// Finds the points of the half-open `window` that pass the rules of position. Returns ErrorCode::cancelled when `cancel` is raised.
	Status sample(TileSampler &sampler, const Rect &window, const std::atomic<bool> *cancel, LentThreads *threads);

	/// Used instead of `sample`: takes positions from the caller, in `window`, that need not be points of the set. All
	/// positions are kept, with their index as id and the rank 0.
	Status take(std::span<const glm::dvec2> places, const Rect &window);

	/// The positions at which the ground must be known: the points' positions, then edge_probes for each point if the
	/// layer checks for its edge. Appends to both lists. Normals are queried only if the layer has a rule for the
	/// slope, or, at the points, if `normals` is true.
	void add_queries(bool normals, std::vector<glm::dvec2> &r_positions, std::vector<GroundQuery> &r_queries) const;
	std::size_t position_count() const { return positions_.size() + probe_open_.size(); }

	/// Decides which points are kept. `ground` has one entry for each position of add_queries. The neighbors must
	/// already be filtered.
	Status filter(std::span<const Ground> ground, const std::atomic<bool> *cancel);

	/// The product of all rules at a point or position, evaluated in the order of their cost. `ground` is as for
	/// `filter`. Once the product has fallen to the point's rank, no further rule is evaluated.
	double density_at(std::size_t point, std::span<const Ground> ground) const;

	/// Evaluates all rules at a point or position, whatever its rank, and adds their factors to `r_factors`. Throws std::bad_alloc.
	Status factors_at(std::size_t point, std::span<const Ground> ground, std::vector<RuleFactor> &r_factors) const;

	/// Indexes the kept points for layers that depend on them, for distances of at most `distance` meters.
	void index_standing(double distance);

	/// The squared distance to the nearest kept point, if it is below `distance` meters, else the square of `distance`. `distance` is at
	/// most that of index_standing. `position` must lie at least that far within the window.
	double nearest_squared(glm::dvec2 position, double distance) const {
		return grid_.nearest_squared(position, distance);
	}

	const LayerSettings &settings() const { return *layer_; }
	const Rect &window() const { return window_; }
	std::size_t sampled() const { return sampled_; }
	std::span<const glm::dvec2> positions() const { return positions_; }
	std::span<const std::uint64_t> ids() const { return ids_; }

	/// Indices of the kept points, ascending, and the thinning_rank of each.
	std::span<const std::uint32_t> standing() const { return standing_; }
	std::span<const std::uint32_t> thinning_ranks() const { return thinning_ranks_; }

private:
	Status ask_position();
	void keep_points(bool all);
	Status look_around();
	Status open_probes();
	bool probe_allows(std::size_t probe, const Ground &ground) const;
	template <class Record>
	double neighbor_density(std::size_t neighbor, glm::dvec2 position, const Record &record) const;
	template <class Record>
	double edge_density_at(std::size_t point, std::span<const Ground> probe_ground, const Record &record) const;
	template <class Record>
	double density_alone(std::size_t point, std::span<const Ground> ground, const Record &record) const;
	template <class Record>
	double product(std::size_t point, std::span<const Ground> ground, const Record &record) const;

	const LayerSettings *layer_ = nullptr;
	PreparedRules rules_;
	std::vector<const LayerFilter *> neighbors_;
	Rect window_;
	std::size_t sampled_ = 0;

	std::vector<SamplePoint> points_; ///< As sampled; kept for their memory.
	UnfilledVector<glm::dvec2> positions_;
	UnfilledVector<std::uint64_t> ids_;
	UnfilledVector<std::uint32_t> ranks_;
	UnfilledVector<double> densities_;     ///< The density of the rules of position.
	std::vector<glm::dvec2> probes_;       ///< edge_probes for each point, or empty.
	std::vector<std::uint8_t> probe_open_; ///< Whether the rules of position allow the probes.
	std::vector<std::uint32_t> near_shapes_;

	UnfilledVector<std::uint32_t> standing_;
	UnfilledVector<std::uint32_t> thinning_ranks_;
	PointGrid grid_;
	std::vector<glm::dvec2> standing_positions_;

	// Working memory of `sample`.
	UnfilledVector<glm::dvec2> sampled_positions_;
	UnfilledVector<double> sampled_densities_;
	std::vector<float> scratch_;
};

} // namespace thicket
