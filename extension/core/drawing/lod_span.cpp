#include "core/drawing/lod_span.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thicket {

namespace {

// Fractions of the distance of a change at which the finer and the coarser mesh are added to the
// span and removed from it. Each mesh is added a little before it is needed and
// removed a little after.
constexpr double finer_added = 1.02;
constexpr double finer_removed = 1.05;
constexpr double coarser_added = 0.98;
constexpr double coarser_removed = 0.95;

bool fades_after(const LodSettings &settings, std::span<const LodStep> steps, std::size_t lod) {
	return settings.fade > 0.0 && steps[lod].fades && steps[lod + 1].fades && !steps[lod + 1].same_mesh;
}

std::size_t change_count(const LodSettings &settings, std::span<const LodStep> steps) {
	return std::min(settings.lod_distances.size(), steps.empty() ? 0 : steps.size() - 1);
}

std::size_t first_lod(const LodSettings &settings, std::span<const LodStep> steps, double near_distance,
		const LodSpan &displayed_span) {
	std::size_t lod = 0;
	for (; lod < change_count(settings, steps); ++lod) {
		const double begin = settings.lod_distances[lod];
		const bool is_drawn = lod >= displayed_span.first && lod <= displayed_span.last;
		const double abrupt_factor = lod < displayed_span.first ? lod_hysteresis : 1.0;
		const double fade_factor = is_drawn ? finer_removed : finer_added;
		if (near_distance < begin * (fades_after(settings, steps, lod) ? fade_factor : abrupt_factor)) {
			break;
		}
	}
	return lod;
}

} // namespace

LodSpan lod_span(const LodSettings &settings, std::span<const LodStep> steps, const DistanceRange &distance,
		const LodSpan &displayed_span) {
	LodSpan span;
	span.first = span.last = first_lod(settings, steps, distance.near, displayed_span);
	while (span.last < change_count(settings, steps)) {
		const double begin = settings.lod_distances[span.last];
		const bool is_drawn = span.last >= displayed_span.first && span.last < displayed_span.last;
		const bool fades = fades_after(settings, steps, span.last);
		const double needed_from = begin * (1.0 - settings.fade) * (is_drawn ? coarser_removed : coarser_added);
		if (fades ? distance.far <= needed_from : !steps[span.last + 1].same_mesh || distance.far < begin) {
			break;
		}
		++span.last;
	}
	span.fades_out = settings.fade > 0.0 && settings.sight_end > 0.0 && !steps.empty() &&
			steps[std::min(span.last, steps.size() - 1)].fades &&
			distance.sight > settings.sight_end * (1.0 - settings.fade) *
							(displayed_span.fades_out ? coarser_removed : coarser_added);
	return span;
}

double span_margin(const LodSettings &settings, std::span<const LodStep> steps, const DistanceRange &distance) {
	double margin = std::numeric_limits<double>::infinity();
	const auto add_limit = [&margin](double current, double limit) {
		margin = std::min(margin, std::abs(current - limit));
	};
	for (std::size_t lod = 0; lod < change_count(settings, steps); ++lod) {
		const double begin = settings.lod_distances[lod];
		if (fades_after(settings, steps, lod)) {
			add_limit(distance.near, begin * finer_added);
			add_limit(distance.near, begin * finer_removed);
			add_limit(distance.far, begin * (1.0 - settings.fade) * coarser_added);
			add_limit(distance.far, begin * (1.0 - settings.fade) * coarser_removed);
		} else {
			add_limit(distance.near, begin);
			add_limit(distance.near, begin * lod_hysteresis);
			add_limit(distance.far, begin);
		}
	}
	if (settings.fade > 0.0 && settings.sight_end > 0.0 && std::ranges::any_of(steps, &LodStep::fades)) {
		add_limit(distance.sight, settings.sight_end * (1.0 - settings.fade) * coarser_added);
		add_limit(distance.sight, settings.sight_end * (1.0 - settings.fade) * coarser_removed);
	}
	return margin;
}

FadeRange fade_range(const LodSettings &settings, std::size_t first, std::size_t last, bool fades_in, LodEnd end) {
	FadeRange range = no_fade;
	if (fades_in && first > 0 && first <= settings.lod_distances.size()) {
		range.x = static_cast<float>(settings.lod_distances[first - 1]);
	}
	if (end == LodEnd::sight) {
		range.y = static_cast<float>(-settings.sight_end);
	} else if (end == LodEnd::next && last < settings.lod_distances.size()) {
		range.y = static_cast<float>(settings.lod_distances[last]);
	}
	if (range != no_fade) {
		constexpr double farthest = 1e9;
		range.z = static_cast<float>(settings.fade);
		range.w = static_cast<float>(std::min(settings.sight().height_limit(1.0), farthest));
	}
	return range;
}

} // namespace thicket
