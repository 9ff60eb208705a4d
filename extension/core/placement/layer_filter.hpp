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

/// Finds out which points of one layer stand in a window: `sample`, then `filter` once the ground is known. A tile has one
/// for its own layer and one for each layer that its rules look at. Keeps its memory.
class LayerFilter {
public:
	/// Prepares for a layer of valid settings, which has to stay until the points are filtered. `neighbors` are the filters of
	/// layer.neighbors, in their order.
	void set(const LayerSettings &layer, std::span<const LayerFilter *const> neighbors);

	/// The points of the half-open `window` that the rules of position let pass. Ends with ErrorCode::cancelled when
	/// `cancel` is raised.
	Status sample(TileSampler &sampler, const Rect &window, const std::atomic<bool> *cancel, LentThreads *threads);

	/// In place of `sample`: places of the caller's, in `window`, that need not be points of the set. All of them stay, by their index as
	/// id, with the rank 0.
	Status take(std::span<const glm::dvec2> places, const Rect &window);

	/// Where the ground has to be known: the points' positions, then edge_probes for each point if the layer looks at its edge. Adds to
	/// both. Nobody looks at the normals of a layer without a rule for the slope, or at those of the points if `normals`.
	void add_queries(bool normals, std::vector<glm::dvec2> &r_positions, std::vector<GroundQuery> &r_queries) const;
	std::size_t position_count() const { return positions_.size() + probe_open_.size(); }

	/// Finds out which points stand; `ground` has one entry for each of these positions. The neighbors have been filtered before.
	Status filter(std::span<const Ground> ground, const std::atomic<bool> *cancel);

	/// The product of all rules at a point or place, in the order of what they cost; `ground` as above. Once it has fallen to the point's
	/// rank, no further rule is asked.
	double density_at(std::size_t point, std::span<const Ground> ground) const;

	/// The same with all factors, whatever the rank. Throws std::bad_alloc. Adds to `r_factors`.
	Status factors_at(std::size_t point, std::span<const Ground> ground, std::vector<RuleFactor> &r_factors) const;

	/// Prepares the points that stand for layers that look at them, from at most `distance` meters away.
	void index_standing(double distance);

	/// The square of the distance to the nearest point that stands, if it is below `distance` meters, at most those of
	/// index_standing; the square of `distance` otherwise. `position` lies as far within the window at least.
	double nearest_squared(glm::dvec2 position, double distance) const {
		return grid_.nearest_squared(position, distance);
	}

	const LayerSettings &settings() const { return *layer_; }
	const Rect &window() const { return window_; }
	std::size_t sampled() const { return sampled_; }
	std::span<const glm::dvec2> positions() const { return positions_; }
	std::span<const std::uint64_t> ids() const { return ids_; }

	/// Indices of the points that stand, ascending; and for each its thinning_rank.
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
	UnfilledVector<double> densities_;     ///< Of the rules of position.
	std::vector<glm::dvec2> probes_;       ///< edge_probes for each point, or none.
	std::vector<std::uint8_t> probe_open_; ///< Whether the rules of position allow them.
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
