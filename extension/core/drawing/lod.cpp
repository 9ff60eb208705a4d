#include "core/drawing/lod.hpp"

#include "core/base/check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thicket {

namespace {

/// Returns the number of thinning steps that are complete at a distance, 0 to thin_steps.
double completed_steps(const LodSettings &settings, double distance) {
	if (distance >= settings.thin_end) {
		return thin_steps;
	}
	const double fraction = (distance - settings.thin_begin) / (settings.thin_end - settings.thin_begin);
	return std::max(std::floor(fraction * thin_steps), 0.0);
}

bool thins(const LodSettings &settings) { return settings.thin_density < 1.0; }

} // namespace

Status validate(const LodSettings &settings) {
	if (settings.lod_distances.size() > max_lods) {
		return Status::out_of_range("lod_distances", settings.lod_distances.size(), at_most(max_lods, "entries"));
	}
	double last = 0.0;
	for (const double distance : settings.lod_distances) {
		const Status status = first_failure(check_range("lod_distances", distance, 0.0, max_lod_distance),
				check_order("lod_distances", last, distance));
		if (!status.ok()) {
			return status;
		}
		last = distance;
	}
	return first_failure(check_range("thin_begin", settings.thin_begin, 0.0, max_lod_distance),
			check_range("thin_end", settings.thin_end, 0.0, max_lod_distance),
			check_order("thin_end", settings.thin_begin, settings.thin_end),
			check_range("thin_density", settings.thin_density, 0.0, 1.0),
			check_range("lod_fade", settings.fade, 0.0, max_lod_fade));
}

std::size_t lod_at(const LodSettings &settings, double distance, std::size_t current_lod) {
	std::size_t lod = 0;
	for (const double begin : settings.lod_distances) {
		if (distance < (lod < current_lod ? lod_hysteresis * begin : begin)) {
			break;
		}
		++lod;
	}
	return lod;
}

double thinned_density(const LodSettings &settings, double distance) {
	if (!thins(settings) || distance < settings.thin_begin) {
		return 1.0;
	}
	return 1.0 - (1.0 - settings.thin_density) * (completed_steps(settings, distance) / thin_steps);
}

double compensating_scale(const LodSettings &settings, double fraction) {
	constexpr double min_fraction = 1.0 / (max_scale_compensation * max_scale_compensation);
	return settings.scale_compensation ? 1.0 / std::sqrt(std::max(fraction, min_fraction)) : 1.0;
}

double limited_fraction(double fraction, std::uint64_t wanted_instances, std::uint64_t max_instances) {
	constexpr double target_usage = 0.9; // Fraction of the limit that is used after `fraction` has changed.
	constexpr double min_usage = 0.7;    // `fraction` is raised below this fraction of the limit.
	const auto wanted_count = static_cast<double>(wanted_instances);
	const auto limit = static_cast<double>(max_instances);
	const bool keeps_fraction =
			fraction * wanted_count <= limit && (fraction >= 1.0 || fraction * wanted_count >= min_usage * limit);
	return keeps_fraction ? fraction : std::min(1.0, target_usage * limit / std::max(wanted_count, 1.0));
}

double distance_margin(const LodSettings &settings, double distance) {
	double margin = std::numeric_limits<double>::infinity();
	const auto add_limit = [&margin, distance](double limit) {
		margin = std::min(margin, std::abs(distance - limit));
	};
	for (const double begin : settings.lod_distances) {
		add_limit(begin);
		add_limit(lod_hysteresis * begin);
	}
	if (thins(settings)) {
		add_limit(settings.thin_begin);
		add_limit(settings.thin_end);
		if (distance > settings.thin_begin && distance < settings.thin_end) {
			const double step_width = (settings.thin_end - settings.thin_begin) / thin_steps;
			const double steps = completed_steps(settings, distance);
			add_limit(settings.thin_begin + steps * step_width);
			add_limit(settings.thin_begin + (steps + 1.0) * step_width);
		}
	}
	return margin;
}

} // namespace thicket
