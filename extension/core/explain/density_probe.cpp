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
			const Rect &rect, const Surface *surface, const Surface *grown);
	void gather_positions();
	Status check_ground(std::span<const Ground> known) const;

	TileFilter filter;
	bool found = false;
	bool explains = false; ///< True if the queries must include normals.
	std::vector<glm::dvec2> positions;
	std::vector<GroundQuery> queries;
	std::vector<Ground> ground;
	/// The ground at the probed positions, followed by the ground around them.
	std::span<const Ground> own_ground;
};

Status DensityProbe::Workspace::find(const LayerSettings &layer, std::span<const glm::dvec2> positions,
		std::span<const Ground> on_surface, const Rect &rect, const Surface *surface, const Surface *grown) {
	LayerSettings rules = layer;
	// Layers on which colors depend take time to evaluate and do not affect the density.
	rules.instance_data = {};
	// The placement and the choice of meshes do not affect the density either, but explanations include
	// the meshes.
	rules.placement = {};
	if (!explains) {
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
	if (const Status status = filter.sample_around(positions, on_surface, space, surface, grown); !status.ok()) {
		return status;
	}
	gather_positions();
	found = true;
	return {};
}

void DensityProbe::Workspace::gather_positions() {
	positions.clear();
	queries.clear();
	filter.add_queries(positions, queries);
	for (GroundQuery &query : queries) {
		// Explanations include the slope, which needs the normal.
		query.needs.normals = query.needs.normals || explains;
	}
}

/// Returns an error unless `known` is the ground at the positions.
Status DensityProbe::Workspace::check_ground(std::span<const Ground> known) const {
	if (!found) {
		return {ErrorCode::missing, "positions", 0.0};
	}
	return thicket::check_ground(known, positions.size());
}

DensityProbe::DensityProbe(const SampleMargins &margins) : workspace_(std::make_unique<Workspace>(margins)) {}
DensityProbe::~DensityProbe() = default;
DensityProbe::DensityProbe(DensityProbe &&) noexcept = default;
DensityProbe &DensityProbe::operator=(DensityProbe &&) noexcept = default;

Status DensityProbe::find(const LayerSettings &layer, std::span<const glm::dvec2> positions, bool explains,
		const Surface *surface, std::span<const Ground> on_surface, const Surface *grown) {
	workspace_->found = false;
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
	workspace_->explains = explains;
	return guarded("positions", static_cast<double>(positions.size()),
			[&] { return workspace_->find(layer, positions, on_surface, rect, surface, grown); });
}

bool DensityProbe::is_complete() const { return workspace_->filter.is_complete(); }

Status DensityProbe::find_further(std::span<const Ground> ground) {
	if (const Status status = workspace_->check_ground(ground); !status.ok()) {
		return status;
	}
	return guarded("ground", static_cast<double>(ground.size()), [&] {
		const Status status = workspace_->filter.sample_further(ground);
		workspace_->gather_positions();
		workspace_->found = status.ok();
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
		Workspace &work = *workspace_;
		work.ground.assign(ground.begin(), ground.end());
		work.own_ground = work.filter.all_own_ground(work.ground);
		return work.filter.filter_neighbors(work.ground);
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
		const LayerFilter &own = workspace_->filter.own();
		r_values.assign(own.settings().world_sources.size(), 0.0f);
		own.world_values(index, workspace_->own_ground, r_values);
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
