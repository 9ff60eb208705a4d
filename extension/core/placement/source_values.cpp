#include "core/placement/source_values.hpp"

#include "core/base/floating_point.hpp"
#include "core/base/progress.hpp"
#include "core/base/trigonometry.hpp"
#include "core/rules/instance_random.hpp"
#include "core/terrain/planet_ground.hpp"

#include <algorithm>
#include <cmath>

namespace thicket {

namespace {

/// Number of points between two checks of the cancel flag. Processing them takes about a
/// millisecond.
constexpr std::size_t values_per_check = 512;

} // namespace

/// Returns the heights of the kept points in world meters. They are valid until the next call.
std::span<const float> SourceValues::heights_of(const PlacedPoints &points, std::span<const std::uint32_t> accepted) {
	heights_.resize(accepted.size());
	std::transform(accepted.begin(), accepted.end(), heights_.begin(),
			[&](std::uint32_t point) { return points.ground[point].height; });
	return heights_;
}

/// Evaluates the source at the kept points from index `first` on, one for each entry of `r_values`.
Status SourceValues::measure(const InstanceSource &source, const Layer &layer, const PlacedPoints &points,
		std::size_t first, std::span<double> r_values) {
	const auto accepted = points.accepted.subspan(first, r_values.size());
	const auto each = [&](const auto &value_of) {
		std::transform(accepted.begin(), accepted.end(), r_values.begin(), value_of);
	};
	const Planet &planet = layer.own.settings().planet;
	const auto each_ground = [&](const auto &value_of) {
		if (planet.exists()) {
			each([&](std::uint32_t point) {
				return value_of(on_planet(planet, points.positions[point], points.ground[point]));
			});
		} else {
			each([&](std::uint32_t point) { return value_of(points.ground[point]); });
		}
	};
	switch (source.kind) {
		case SourceKind::random: break;
		case SourceKind::height: each_ground([](const Ground &ground) { return double{ground.height}; }); break;
		case SourceKind::slope: each_ground([](const Ground &ground) { return slope_degrees(ground.normal); }); break;
		case SourceKind::rank:
			std::transform(points.thinning_ranks.begin() + static_cast<std::ptrdiff_t>(first),
					points.thinning_ranks.begin() + static_cast<std::ptrdiff_t>(first + r_values.size()),
					r_values.begin(), unit_interval);
			break;
		case SourceKind::distance: {
			const LayerFilter &other = layer.all.layer_of(source.layer.get());
			each([&](std::uint32_t point) {
				return std::sqrt(
						layer.own.nearest_squared(other, points.positions[point], points.ground[point], source.max));
			});
			break;
		}
		case SourceKind::noise: {
			positions_.resize(accepted.size());
			noise_.resize(accepted.size());
			std::transform(accepted.begin(), accepted.end(), positions_.begin(),
					[&](std::uint32_t point) { return points.positions[point]; });
			PositionBatch batch{positions_};
			if (layer.own.settings().set.on_surface) {
				batch.heights = heights_of(points, accepted);
			}
			const Status status = source.noise->sample_at(batch, noise_);
			std::transform(noise_.begin(), noise_.end(), r_values.begin(), unit_density);
			return status;
		}
	}
	return {};
}

Status SourceValues::find(const InstanceSource &source, const Layer &layer, const PlacedPoints &points,
		const std::atomic<bool> *cancel, std::vector<float> &r_fractions) {
	r_fractions.resize(points.positions.size());
	for (std::size_t first = 0; first < points.accepted.size(); first += values_per_check) {
		if (is_cancelled(cancel)) {
			return {ErrorCode::cancelled, "tile", 0.0};
		}
		values_.resize(std::min(values_per_check, points.accepted.size() - first));
		if (const Status status = measure(source, layer, points, first, values_); !status.ok()) {
			return status;
		}
		for (std::size_t i = 0; i < values_.size(); ++i) {
			r_fractions[points.accepted[first + i]] = fraction_of(source, values_[i]);
		}
	}
	return {};
}

Status SourceValues::find(const TileFilter &filter, std::span<const Ground> ground, PlacedPoints &r_points,
		const std::atomic<bool> *cancel) {
	const Layer layer{filter, filter.own()};
	const InstanceData &data = layer.own.settings().instance_data;
	Status status = find_for_model(filter, layer.own, ground, r_points, cancel);
	if (status.ok() && data.color_is_known()) {
		status = find(data.color, layer, r_points, cancel, color_);
		r_points.color_fractions = color_;
	}
	if (status.ok() && data.variation_is_known()) {
		status = find(data.variation, layer, r_points, cancel, variation_);
		r_points.variation_fractions = variation_;
	}
	return status;
}

Status SourceValues::find_for_model(const TileFilter &filter, const LayerFilter &layer, std::span<const Ground> ground,
		PlacedPoints &r_points, const std::atomic<bool> *cancel) {
	const ScaleSource &scale = layer.settings().instance_data.scale;
	Status status;
	if (scale.known()) {
		status = find(scale, {filter, layer}, r_points, cancel, scale_);
		r_points.scale_fractions = scale_;
	}
	return status.ok() ? find_world_values(layer, ground, r_points, cancel) : status;
}

/// Finds the values that the rules of meshes need.
Status SourceValues::find_world_values(const LayerFilter &layer, std::span<const Ground> ground, PlacedPoints &r_points,
		const std::atomic<bool> *cancel) {
	const std::size_t sources = layer.mesh_source_count() > 0 ? layer.settings().world_sources.size() : 0;
	world_.resize(sources * r_points.positions.size());
	for (std::size_t i = 0; sources > 0 && i < r_points.accepted.size(); ++i) {
		if (i % values_per_check == 0 && is_cancelled(cancel)) {
			return {ErrorCode::cancelled, "tile", 0.0};
		}
		const std::uint32_t point = r_points.accepted[i];
		layer.world_values(point, ground, std::span(world_).subspan(sources * point, sources));
	}
	r_points.world_values = world_;
	r_points.world_sources = sources;
	return {};
}

} // namespace thicket
