#include "core/placement/detail.hpp"

#include "core/base/check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thicket {

namespace {

/// A finer mesh comes back at this share of the distance at which it went.
constexpr double hysteresis = 0.95;

/// How many of the steps from thin_begin to thin_end lie at or before a distance.
double steps_done(const Detail &detail, double distance) {
	if (distance >= detail.thin_end) {
		return thin_steps;
	}
	const double share = (distance - detail.thin_begin) / (detail.thin_end - detail.thin_begin);
	return std::max(std::floor(share * thin_steps), 0.0);
}

bool thins(const Detail &detail) { return detail.thin_density < 1.0; }

} // namespace

Status validate(const Detail &detail) {
	if (detail.lod_distances.size() > max_lods) {
		return {ErrorCode::out_of_range, "lod_distances", static_cast<double>(detail.lod_distances.size())};
	}
	double last = 0.0;
	for (const double distance : detail.lod_distances) {
		const Status status = first_failure(check_range("lod_distances", distance, 0.0, max_detail_distance),
				check_order("lod_distances", last, distance));
		if (!status.ok()) {
			return status;
		}
		last = distance;
	}
	return first_failure(check_range("thin_begin", detail.thin_begin, 0.0, max_detail_distance),
			check_range("thin_end", detail.thin_end, 0.0, max_detail_distance),
			check_order("thin_end", detail.thin_begin, detail.thin_end),
			check_range("thin_density", detail.thin_density, 0.0, 1.0));
}

std::size_t lod_at(const Detail &detail, double distance, std::size_t shown) {
	std::size_t lod = 0;
	for (const double begin : detail.lod_distances) {
		if (distance < (lod < shown ? hysteresis * begin : begin)) {
			break;
		}
		++lod;
	}
	return lod;
}

double thinned_density(const Detail &detail, double distance) {
	if (!thins(detail) || distance < detail.thin_begin) {
		return 1.0;
	}
	return 1.0 - (1.0 - detail.thin_density) * (steps_done(detail, distance) / thin_steps);
}

double compensating_scale(const Detail &detail, double share) {
	constexpr double least_share = 1.0 / (max_scale_compensation * max_scale_compensation);
	return detail.scale_compensation ? 1.0 / std::sqrt(std::max(share, least_share)) : 1.0;
}

double limited_share(double share, std::uint64_t wanted, std::uint64_t most) {
	constexpr double filled = 0.9;     // What a new share aims at,
	constexpr double too_little = 0.7; // and below which it is given up.
	const auto all = static_cast<double>(wanted);
	const auto limit = static_cast<double>(most);
	const bool keep = share * all <= limit && (share >= 1.0 || share * all >= too_little * limit);
	return keep ? share : std::min(1.0, filled * limit / std::max(all, 1.0));
}

double distance_margin(const Detail &detail, double distance) {
	double margin = std::numeric_limits<double>::infinity();
	const auto keep_from = [&margin, distance](double limit) {
		margin = std::min(margin, std::abs(distance - limit));
	};
	for (const double begin : detail.lod_distances) {
		keep_from(begin);
		keep_from(hysteresis * begin);
	}
	if (thins(detail)) {
		keep_from(detail.thin_begin);
		keep_from(detail.thin_end);
		if (distance > detail.thin_begin && distance < detail.thin_end) {
			const double step = (detail.thin_end - detail.thin_begin) / thin_steps;
			const double done = steps_done(detail, distance);
			keep_from(detail.thin_begin + done * step);
			keep_from(detail.thin_begin + (done + 1.0) * step);
		}
	}
	return margin;
}

} // namespace thicket
