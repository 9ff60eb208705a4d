#include "core/explain/density_probe.hpp"

#include "core/base/guard.hpp"
#include "core/base/tile_grid.hpp"
#include "core/placement/tile_filter.hpp"
#include "core/sampling/nearest_points.hpp"

#include <algorithm>

namespace thicket {

struct DensityProbe::Workspace {
	explicit Workspace(const SampleMargins &margins) : filter(margins) {}

	Status find(const LayerSettings &layer, std::span<const glm::dvec2> positions, std::span<const Ground> on_surface,
			const Rect &rect, const Surface *surface, const Surface *host_surface);
	void gather_positions();
	Status check_ground(std::span<const Ground> given_ground) const;

	TileFilter filter;
	bool is_prepared = false;
	bool for_explanation = false; ///< True if explanations need normals and the choice of meshes.
	std::vector<glm::dvec2> positions;
	std::vector<GroundQuery> queries;
	std::vector<Ground> ground;
	/// The ground at the probed positions, followed by the ground around them.
	std::span<const Ground> own_ground;
};

Status DensityProbe::Workspace::find(const LayerSettings &layer, std::span<const glm::dvec2> positions,
		std::span<const Ground> on_surface, const Rect &rect, const Surface *surface, const Surface *host_surface) {
	LayerSettings rules = layer;
	// Layers on which colors depend take time to evaluate and do not affect the density.
	rules.instance_data = {};
	// The placement and the choice of meshes do not affect the density either, but explanations include
	// the meshes.
	rules.placement = {};
	if (!for_explanation) {
		rules.mesh_rules.clear();
	}
	filter.set(rules);
	if (const double points = filter.points_around(rect); points > max_probed_points) {
		return Status::too_many_points("rect", points, max_probed_points);
	}
	TileSpace space(rect);
	if (!on_surface.empty()) {
		// Other layers on surfaces only need to be sampled near these heights. A column of unlimited
		// height could extend through a planet.
		const auto [lowest, highest] = std::ranges::minmax_element(on_surface, {}, &Ground::height);
		constexpr double rounding = 0.01; // Meters; heights are floats.
		space = {rect, lowest->height - rounding, highest->height + rounding};
	}
	if (const Status status = filter.sample_around(positions, on_surface, space, surface, host_surface); !status.ok()) {
		return status;
	}
	gather_positions();
	is_prepared = true;
	return {};
}

void DensityProbe::Workspace::gather_positions() {
	positions.clear();
	queries.clear();
	filter.add_queries(positions, queries);
	for (GroundQuery &query : queries) {
		// Explanations include the slope, which needs the normal.
		query.needs.normals = query.needs.normals || for_explanation;
	}
}

/// Returns an error unless `find` has succeeded and `given_ground` has an entry for each position.
Status DensityProbe::Workspace::check_ground(std::span<const Ground> given_ground) const {
	if (!is_prepared) {
		return {ErrorCode::missing, "positions", 0.0};
	}
	return thicket::check_ground(given_ground, positions.size());
}

DensityProbe::DensityProbe(const SampleMargins &margins) : workspace_(std::make_unique<Workspace>(margins)) {}
DensityProbe::~DensityProbe() = default;
DensityProbe::DensityProbe(DensityProbe &&) noexcept = default;
DensityProbe &DensityProbe::operator=(DensityProbe &&) noexcept = default;

Status DensityProbe::find(const LayerSettings &layer, std::span<const glm::dvec2> positions, bool for_explanation,
		const Surface *surface, std::span<const Ground> on_surface, const Surface *host_surface) {
	workspace_->is_prepared = false;
	if (const Status status = validate(layer); !status.ok()) {
		return status;
	}
	if (positions.empty()) {
		return {ErrorCode::missing, "positions", 0.0};
	}
	const Rect rect = enclosing_rect(positions);
	if (!rect.finite()) {
		return {ErrorCode::not_finite, "positions", rect.min.x};
	}
	workspace_->for_explanation = for_explanation;
	return guarded("positions", static_cast<double>(positions.size()),
			[&] { return workspace_->find(layer, positions, on_surface, rect, surface, host_surface); });
}

bool DensityProbe::is_complete() const { return workspace_->filter.is_complete(); }

Status DensityProbe::find_further(std::span<const Ground> ground) {
	if (const Status status = workspace_->check_ground(ground); !status.ok()) {
		return status;
	}
	return guarded("ground", static_cast<double>(ground.size()), [&] {
		const Status status = workspace_->filter.sample_further(ground);
		workspace_->gather_positions();
		workspace_->is_prepared = status.ok();
		return status;
	});
}

std::span<const glm::dvec2> DensityProbe::positions() const { return workspace_->positions; }

std::span<const GroundQuery> DensityProbe::queries() const { return workspace_->queries; }

Status DensityProbe::evaluate(std::span<const Ground> ground) {
	Status status = workspace_->check_ground(ground);
	if (status.ok() && !is_complete()) {
		status = {ErrorCode::missing, "positions", 0.0};
	}
	if (!status.ok()) {
		return status;
	}
	return guarded("ground", static_cast<double>(ground.size()), [&] {
		Workspace &workspace = *workspace_;
		workspace.ground.assign(ground.begin(), ground.end());
		workspace.own_ground = workspace.filter.all_own_ground(workspace.ground);
		return workspace.filter.filter_neighbors(workspace.ground);
	});
}

const Ground &DensityProbe::ground_at(std::size_t index) const {
	return workspace_->filter.own().ground_of(workspace_->own_ground)[index];
}

double DensityProbe::density_at(std::size_t index) const {
	return workspace_->filter.own().density_at(index, workspace_->own_ground);
}

Status DensityProbe::world_values_at(std::size_t index, std::vector<float> &r_values) const {
	return guarded("world values", 0.0, [&] {
		const LayerFilter &layer_filter = workspace_->filter.own();
		r_values.assign(layer_filter.settings().world_sources.size(), 0.0f);
		layer_filter.world_values(index, workspace_->own_ground, r_values);
		return Status();
	});
}

Status DensityProbe::factors_at(std::size_t index, std::vector<RuleFactor> &r_factors) const {
	return guarded_answer("factors", 0.0, r_factors, [&] {
		r_factors.clear();
		return workspace_->filter.own().factors_at(index, workspace_->own_ground, r_factors);
	});
}

} // namespace thicket
