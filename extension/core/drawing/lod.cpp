#include "core/drawing/lod.hpp"

#include "core/base/check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thicket {

namespace {

/// Returns the number of thinning steps that are complete at a distance, 0 to thin_steps.
double steps_done(const LodSettings &settings, double distance) {
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
	return 1.0 - (1.0 - settings.thin_density) * (steps_done(settings, distance) / thin_steps);
}

double compensating_scale(const LodSettings &settings, double fraction) {
	constexpr double min_fraction = 1.0 / (max_scale_compensation * max_scale_compensation);
	return settings.scale_compensation ? 1.0 / std::sqrt(std::max(fraction, min_fraction)) : 1.0;
}

double limited_fraction(double fraction, std::uint64_t wanted, std::uint64_t max_instances) {
	constexpr double filled = 0.9;     // Fraction of the limit that is used after `fraction` has changed.
	constexpr double too_little = 0.7; // `fraction` is raised below this fraction of the limit.
	const auto all = static_cast<double>(wanted);
	const auto limit = static_cast<double>(max_instances);
	const bool keep = fraction * all <= limit && (fraction >= 1.0 || fraction * all >= too_little * limit);
	return keep ? fraction : std::min(1.0, filled * limit / std::max(all, 1.0));
}

double distance_margin(const LodSettings &settings, double distance) {
	double margin = std::numeric_limits<double>::infinity();
	const auto keep_from = [&margin, distance](double limit) {
		margin = std::min(margin, std::abs(distance - limit));
	};
	for (const double begin : settings.lod_distances) {
		keep_from(begin);
		keep_from(lod_hysteresis * begin);
	}
	if (thins(settings)) {
		keep_from(settings.thin_begin);
		keep_from(settings.thin_end);
		if (distance > settings.thin_begin && distance < settings.thin_end) {
			const double step = (settings.thin_end - settings.thin_begin) / thin_steps;
			const double done = steps_done(settings, distance);
			keep_from(settings.thin_begin + done * step);
			keep_from(settings.thin_begin + (done + 1.0) * step);
		}
	}
	return margin;
}

} // namespace thicket
