#pragma once

#include "core/base/tile_grid.hpp"
#include "core/base/unfilled.hpp"
#include "core/placement/ground_query.hpp"
#include "core/placement/instance_cache.hpp"
#include "core/placement/layer.hpp"
#include "core/placement/layer_graph.hpp"
#include "core/placement/point_grid.hpp"
#include "core/placement/surface_probes.hpp"
#include "core/rules/rules.hpp"
#include "core/sampling/tile_sampler.hpp"
#include "core/surface/surface_sampler.hpp"

#include <glm/vec2.hpp>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// The samplers that find the points of layers.
struct PointSource {
	TileSampler &plane;
	SurfaceSampler &surfaces;
	const Surface *surface = nullptr;     ///< The surface of the ground. If null, layers on surfaces have no points.
	const Obstacles *obstacles = nullptr; ///< For a layer that fills gaps, the instances of its neighbors.
	WindowUse use = WindowUse::separate;
};

/// Determines which points of one layer become instances in a window: call `sample`, query the
/// ground, then call `filter`. A tile has one filter for its own layer and one for each layer on
/// which it depends. A filter reuses its memory.
class LayerFilter {
public:
	/// Sets the layer, whose settings must be valid and must outlive the use of this object.
	/// `neighbors` are the filters of layer.neighbors, in the same order. `measured` are the filters of
	/// the layers of layer.world_sources, or null where no distance is needed. Both lists may be empty
	/// if the instances come from a cache. `chooses_meshes` is true if world_values will be called.
	void set(const LayerSettings &layer, std::span<const LayerFilter *const> neighbors,
			std::span<const LayerFilter *const> measured = {}, bool chooses_meshes = false);

	/// Finds the points in `window` that pass the rules that depend only on the position. Returns
	/// ErrorCode::cancelled if `cancel` is set.
	Status sample(const PointSource &source, const TileSpace &window, const std::atomic<bool> *cancel,
			CallerThreads *threads);

	/// Prepares a layer whose points depend on the instances of other layers: on its hosts, or on
	/// neighbors around which it fills. The layer has no points until `sample` is called. Call
	/// `sample` once the other layers are filtered, before `filter`.
	void wait_for_others(const TileSpace &window);

	/// Takes the instances of the layer in `window` from a cache, or all of its points, of which
	/// `sampled` were sampled. These calls replace `sample` and `filter`. Ranks are then unknown.
	void take_instances(std::span<const glm::dvec2> instances, const TileSpace &window);
	void take_points(std::span<const CachedPoint> points, std::size_t sampled, const TileSpace &window);

	/// Evaluates the rules at arbitrary positions in `window`. This call replaces `sample`. All
	/// positions become points, with their indices as ids and with rank 0. If the positions are on
	/// surfaces, `on_surface` contains the ground at each of them, and `grown` is the surface on which
	/// the layer grows. If `on_surface` is empty, the positions are on the top of the ground.
	Status take(std::span<const glm::dvec2> positions, const Rect &window, std::span<const Ground> on_surface = {},
			const Surface *host_surface = nullptr);

	/// Appends the positions at which `filter` needs the ground, and their queries. These are the
	/// positions of the points and, with an edge feather, edge_probes positions for each point.
	/// Positions are repeated for each texture whose weight an expression needs. Normals are queried if
	/// the layer has a slope rule. If `normals` is true, they are always queried at the points. The
	/// ground of points on surfaces and of their probes is already known, so only density rules are
	/// queried there. This object must outlive the queries.
	void add_queries(bool normals, std::vector<glm::dvec2> &r_positions, std::vector<GroundQuery> &r_queries) const;
	std::size_t position_count() const { return queries_ground() ? texture_first(textures_.size()) : 0; }

	/// Returns the ground at each point. `ground` is as for `filter`.
	std::span<const Ground> ground_of(std::span<const Ground> ground) const {
		return queries_ground() ? ground.first(positions_.size()) : std::span<const Ground>(known_ground_);
	}

	/// Determines which points are kept. `ground` has one entry for each position from add_queries.
	/// The neighbors must already be filtered and indexed.
	Status filter(std::span<const Ground> ground, const std::atomic<bool> *cancel);

	/// Returns the product of all rules at a point, evaluated in ascending order of cost. `ground`
	/// is as for `filter`. The evaluation stops early once the product is too low for the point's
	/// rank.
	double density_at(std::size_t point, std::span<const Ground> ground) const;

	/// Evaluates all rules at a point, regardless of its rank, and appends their factors to
	/// `r_factors`. Call it only on the main thread if a density rule is not thread-safe. Throws
	/// std::bad_alloc.
	Status factors_at(std::size_t point, std::span<const Ground> ground, std::vector<RuleFactor> &r_factors) const;

	/// Writes the values of LayerSettings::world_sources at a point to `r_values`, one for each source.
	/// Only those that the rules of meshes use are written. `ground` is as for `filter`.
	void world_values(std::size_t point, std::span<const Ground> ground, std::span<float> r_values) const;
	std::size_t mesh_source_count() const { return mesh_sources_.size(); }

	/// Indexes the kept points for nearest_squared, with the distance that `node` requires.
	/// `ground` is the same as for `filter`. If `for_any_position` is true, the layers that fill
	/// gaps around this one may have points from `take`.
	void index_present(const LayerGraph::Node &node, std::span<const Ground> ground, bool for_any_position);

	/// Returns the squared distance from a position to the nearest kept point of `other`, or the
	/// square of `distance` (meters) if no point is nearer than that. `distance` must not exceed
	/// the distance for which `other` is indexed. The position must be in the window of `other`, at
	/// least `distance` from its edges.
	double nearest_squared(const LayerFilter &other, glm::dvec2 position, const Ground &ground, double distance) const;

	const LayerSettings &settings() const { return *layer_; }
	const Rect &window() const { return window_; }
	std::size_t sampled() const { return sampled_count_; }
	/// Returns the positions of all sampled points, also of those that no rule lets pass.
	std::span<const glm::dvec2> sampled_positions() const {
		return std::span(sampled_positions_).first(sampled_count_);
	}
	std::span<const glm::dvec2> positions() const { return positions_; }
	std::span<const std::uint64_t> ids() const { return ids_; }
	std::span<const std::uint32_t> ranks() const { return ranks_; }

	/// Return the indices of the kept points, ascending, and their thinning ranks.
	std::span<const std::uint32_t> accepted() const { return accepted_; }
	std::span<const std::uint32_t> thinning_ranks() const { return thinning_ranks_; }

private:
	/// A texture whose weights are queried at all points, and at all probes if the rules use it.
	struct TextureWeights {
		std::size_t source = 0; ///< Index in LayerSettings::world_sources.
		std::int32_t texture = 0;
		bool at_probes = false;
	};

	using WorldValues = std::array<float, max_world_inputs>;

	std::size_t texture_first(std::size_t index) const;
	void add_texture_queries(std::vector<glm::dvec2> &r_positions, std::vector<GroundQuery> &r_queries) const;
	float texture_weight(std::size_t source, std::size_t at, std::span<const Ground> ground) const;
	float world_value(std::size_t source, std::size_t at, glm::dvec2 position, const Ground &point_ground,
			std::span<const Ground> ground) const;
	std::span<const float> rule_values(std::size_t at, glm::dvec2 position, const Ground &point_ground,
			std::span<const Ground> ground, WorldValues &r_values) const;
	std::span<const Ground> probes_of(std::span<const Ground> ground) const {
		return queries_ground() ? ground.subspan(positions_.size(), probes_.size())
								: std::span<const Ground>(probe_ground_);
	}

	/// Returns true if the ground, or only its density, must be queried before `filter`.
	bool queries_ground() const { return !knows_ground_ || (on_surface_ && !layer_->rules.density_rules.empty()); }
	DensityRuleQuery density_query() const;
	void add_known_queries(std::vector<glm::dvec2> &r_positions, std::vector<GroundQuery> &r_queries) const;
	Status sample_rows(const std::atomic<bool> *cancel);
	Status sample_surface(const PointSource &source, const std::atomic<bool> *cancel);
	Status query_position();
	void keep_points(bool all);
	Status gather_surroundings(const Surface *host_surface, const std::atomic<bool> *cancel);
	Status find_probes(const Surface *host_surface, const std::atomic<bool> *cancel);
	Status find_probes_on(const Surface &host_surface, const std::atomic<bool> *cancel);
	Status evaluate_probes();
	bool probe_allows(std::size_t probe, const Ground &point_ground, std::span<const Ground> ground) const;
	template <class Record>
	double neighbor_density(
			std::size_t neighbor, std::size_t point, const Ground &point_ground, const Record &record) const;
	template <class Record>
	double edge_density_at(std::size_t point, std::span<const Ground> ground, const Record &record) const;
	template <class Record>
	double density_alone(
			std::size_t point, const Ground &point_ground, std::span<const Ground> ground, const Record &record) const;
	template <class Record>
	double product(std::size_t point, std::span<const Ground> ground, const Record &record) const;

	const LayerSettings *layer_ = nullptr;
	PreparedRules rules_;
	std::vector<const LayerFilter *> neighbors_;
	std::vector<const LayerFilter *> measured_; ///< The filters of the layers of world sources, or null.
	std::vector<std::size_t> rule_sources_;     ///< The sources of the world inputs of the rules' expression.
	std::vector<std::size_t> mesh_sources_;     ///< The sources that the rules of meshes use, if they are needed.
	std::vector<TextureWeights> textures_;
	TileSpace window_;
	std::size_t sampled_count_ = 0;
	bool on_surface_ = false; ///< True if the points are on surfaces.
	/// True if the ground at the points is known, because they are on surfaces or from a cache.
	bool knows_ground_ = false;
	bool is_filled_ = false; ///< True if the points were sampled with obstacles, and keep their distance from these.

	std::vector<SamplePoint> points_; ///< The sampled points; a member to reuse its memory.
	std::vector<SurfacePoint> surface_points_;
	UnfilledVector<Ground> known_ground_; ///< The ground of each point; empty unless knows_ground_ is true.
	UnfilledVector<glm::dvec2> positions_;
	UnfilledVector<std::uint64_t> ids_;
	UnfilledVector<std::uint32_t> ranks_;
	UnfilledVector<double> densities_;        ///< Product of the position rules for each point.
	std::vector<glm::dvec2> probes_;          ///< edge_probes positions for each point, or empty.
	std::vector<float> probe_heights_;        ///< World meters, as for sampled_heights_.
	std::vector<Ground> probe_ground_;        ///< The ground at each probe on surfaces.
	std::vector<std::uint8_t> probe_allowed_; ///< For each probe, 1 if the position rules allow it, otherwise 0.
	std::vector<std::uint32_t> near_shapes_;

	UnfilledVector<std::uint32_t> accepted_;
	UnfilledVector<std::uint32_t> thinning_ranks_;
	PointGrid<glm::dvec2> grid_;
	PointGrid<glm::dvec3> space_grid_;
	std::vector<glm::dvec2> present_positions_;
	std::vector<glm::dvec3> present_space_positions_;

	// Working memory of `sample`.
	UnfilledVector<glm::dvec2> sampled_positions_;
	std::vector<float> sampled_heights_; ///< World meters; empty unless the points are on surfaces.
	UnfilledVector<double> sampled_densities_;
	std::vector<float> scratch_;
	SurfaceProbes surface_probes_;
};

} // namespace thicket
