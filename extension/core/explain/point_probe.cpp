#include "core/explain/point_probe.hpp"

#include "core/base/guard.hpp"
#include "core/explain/density_probe.hpp"
#include "core/sampling/rank.hpp"

namespace thicket {

Status PointProbe::find(const LayerSettings &layer, std::span<const glm::dvec2> positions) {
	fills_ = fills(layer);
	positions_.clear();
	queries_.clear();
	if (layer.set.in_rows) {
		return find_in_rows(layer, positions);
	}
	if (!fills_) {
		return nearest_points(sampler_, layer.set, positions, points_);
	}
	const Rect area = enclosing_rect(positions);
	if (!area.finite()) {
		return {ErrorCode::not_finite, "positions", area.min.x};
	}
	return guarded("positions", static_cast<double>(positions.size()), [&] {
		set_ = layer.set;
		targets_.assign(positions.begin(), positions.end());
		LayerSettings points; // The layer without its own rules.
		points.set = layer.set;
		points.neighbors = layer.neighbors;
		points.spacing_fills = true;
		filter_.set(points);
		const Rect search_area = point_area(set_, area);
		if (const double count = filter_.points_around(search_area); count > max_probed_points) {
			return Status::too_many_points("rect", count, max_probed_points);
		}
		const Status status = filter_.sample(search_area, nullptr, nullptr);
		return status.ok() ? gather() : status;
	});
}

/// Finds the nearest points of rows.
Status PointProbe::find_in_rows(const LayerSettings &layer, std::span<const glm::dvec2> positions) {
	return guarded("positions", static_cast<double>(positions.size()), [&] {
		const Rect area = enclosing_rect(positions);
		if (!area.finite()) {
			return Status{ErrorCode::not_finite, "positions", area.min.x};
		}
		std::vector<SamplePoint> row_points;
		Status status;
		if (layer.rows != nullptr) {
			status = layer.rows->sample(layer.set, point_area(layer.set, area), row_points);
		}
		nearest_among(row_points, layer.set, positions, points_);
		return status;
	});
}

Status PointProbe::find_further(std::span<const Ground> ground) {
	if (const Status status = check_ground(ground, positions_.size()); !status.ok()) {
		return status;
	}
	return guarded("ground", static_cast<double>(ground.size()), [&] {
		const Status status = filter_.sample_further(ground);
		return status.ok() ? gather() : status;
	});
}

/// Collects the positions of the next step, or the points after the last one.
Status PointProbe::gather() {
	positions_.clear();
	queries_.clear();
	if (!filter_.is_complete()) {
		filter_.add_queries(positions_, queries_);
		return {};
	}
	const LayerFilter &layer_filter = filter_.own();
	std::vector<SamplePoint> candidates;
	for (std::size_t i = 0; i < layer_filter.positions().size(); ++i) {
		const std::uint32_t rank = layer_filter.ranks()[i];
		candidates.push_back(
				{layer_filter.positions()[i], layer_filter.ids()[i], rank, level_of_rank(set_.levels, rank)});
	}
	nearest_among(candidates, set_, targets_, points_);
	return {};
}

} // namespace thicket
