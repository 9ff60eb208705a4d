#include "core/drawing/lod_span.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thicket {

namespace {

// Fractions of the distance of a change at which the finer and the coarser mesh are added to the
// span (comes) and removed from it (goes). Each mesh is added a little before it is needed and
// removed a little after.
constexpr double finer_comes = 1.02;
constexpr double finer_goes = 1.05;
constexpr double coarser_comes = 0.98;
constexpr double coarser_goes = 0.95;

bool fades_after(const LodSettings &settings, std::span<const LodStep> steps, std::size_t lod) {
	return settings.fade > 0.0 && steps[lod].fades && steps[lod + 1].fades && !steps[lod + 1].same;
}

std::size_t changes_of(const LodSettings &settings, std::span<const LodStep> steps) {
	return std::min(settings.lod_distances.size(), steps.empty() ? 0 : steps.size() - 1);
}

std::size_t first_lod(
		const LodSettings &settings, std::span<const LodStep> steps, double near, const LodSpan &displayed) {
	std::size_t lod = 0;
	for (; lod < changes_of(settings, steps); ++lod) {
		const double begin = settings.lod_distances[lod];
		const bool is_drawn = lod >= displayed.first && lod <= displayed.last;
		const double sharp = lod < displayed.first ? lod_hysteresis : 1.0;
		const double faded = is_drawn ? finer_goes : finer_comes;
		if (near < begin * (fades_after(settings, steps, lod) ? faded : sharp)) {
			break;
		}
	}
	return lod;
}

} // namespace

LodSpan lod_span(const LodSettings &settings, std::span<const LodStep> steps, const DistanceRange &distance,
		const LodSpan &displayed) {
	LodSpan span;
	span.first = span.last = first_lod(settings, steps, distance.near, displayed);
	while (span.last < changes_of(settings, steps)) {
		const double begin = settings.lod_distances[span.last];
		const bool is_drawn = span.last >= displayed.first && span.last < displayed.last;
		const bool fades = fades_after(settings, steps, span.last);
		const double needed_from = begin * (1.0 - settings.fade) * (is_drawn ? coarser_goes : coarser_comes);
		if (fades ? distance.far <= needed_from : !steps[span.last + 1].same || distance.far < begin) {
			break;
		}
		++span.last;
	}
	span.ends = settings.fade > 0.0 && settings.sight_end > 0.0 && !steps.empty() &&
			steps[std::min(span.last, steps.size() - 1)].fades &&
			distance.sight >
					settings.sight_end * (1.0 - settings.fade) * (displayed.ends ? coarser_goes : coarser_comes);
	return span;
}

double span_margin(const LodSettings &settings, std::span<const LodStep> steps, const DistanceRange &distance) {
	double margin = std::numeric_limits<double>::infinity();
	const auto keep_from = [&margin](double at, double limit) {
		margin = std::min(margin, std::abs(at - limit));
	};
	for (std::size_t lod = 0; lod < changes_of(settings, steps); ++lod) {
		const double begin = settings.lod_distances[lod];
		if (fades_after(settings, steps, lod)) {
			keep_from(distance.near, begin * finer_comes);
			keep_from(distance.near, begin * finer_goes);
			keep_from(distance.far, begin * (1.0 - settings.fade) * coarser_comes);
			keep_from(distance.far, begin * (1.0 - settings.fade) * coarser_goes);
		} else {
			keep_from(distance.near, begin);
			keep_from(distance.near, begin * lod_hysteresis);
			keep_from(distance.far, begin);
		}
	}
	if (settings.fade > 0.0 && settings.sight_end > 0.0 && std::ranges::any_of(steps, &LodStep::fades)) {
		keep_from(distance.sight, settings.sight_end * (1.0 - settings.fade) * coarser_comes);
		keep_from(distance.sight, settings.sight_end * (1.0 - settings.fade) * coarser_goes);
	}
	return margin;
}

FadeRange fade_range(const LodSettings &settings, std::size_t first, std::size_t last, bool comes, LodEnd end) {
	FadeRange range = no_fade;
	if (comes && first > 0 && first <= settings.lod_distances.size()) {
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
