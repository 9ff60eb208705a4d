#include "core/drawing/lod_runs.hpp"

#include <algorithm>

namespace thicket {

LodRuns::LodRuns(const LodSettings &settings, std::span<const LodStep> steps) :
		settings_(settings), steps_(steps.begin(), steps.end()) {
	for (std::size_t lod = 0; lod < steps_.size(); ++lod) {
		if (steps_[lod].same_mesh) {
			runs_.back().last = lod;
		} else {
			runs_.push_back({lod, lod, steps_[lod].fades});
		}
		run_indices_.push_back(runs_.size() - 1);
	}
}

std::size_t LodRuns::run_of(std::size_t lod) const { return run_indices_[std::min(lod, run_indices_.size() - 1)]; }

bool LodRuns::fades() const { return settings_.fade > 0.0 && std::ranges::any_of(steps_, &LodStep::fades); }

std::array<FadeRange, RunFade::count> LodRuns::ranges(std::size_t run) const {
	const auto &[first, last, fades] = runs_[run];
	std::array<FadeRange, RunFade::count> result;
	for (const bool fades_in : {false, true}) {
		for (const LodEnd end : {LodEnd::stays, LodEnd::next, LodEnd::sight}) {
			const bool can_fade_in = !fades_in || first > 0;
			const bool can_end = end == LodEnd::stays || (end == LodEnd::next && last + 1 < steps_.size()) ||
					(end == LodEnd::sight && settings_.sight_end > 0.0);
			result[RunFade{fades_in, end}.index()] =
					can_fade_in && can_end ? fade_range(settings_, first, last, fades_in, end) : no_fade;
		}
	}
	return result;
}

LodRuns::DrawnRun LodRuns::drawn_run(const LodSpan &span, std::size_t index) const {
	const std::size_t run = run_indices_[span.first] + index;
	const LodEnd end = run < run_indices_[span.last] ? LodEnd::next : span.fades_out ? LodEnd::sight : LodEnd::stays;
	const RunFade fade{index > 0, end};
	const bool fades = runs_[run].fades && fade != RunFade();
	return {run, fades ? std::optional(fade) : std::nullopt};
}

LodRuns::DrawnRun LodRuns::single_run(const LodSpan &span, std::size_t lod) const {
	const std::size_t run = run_of(lod);
	const bool fades = runs_[run].fades && span.fades_out;
	return {run, fades ? std::optional(RunFade{false, LodEnd::sight}) : std::nullopt};
}

} // namespace thicket
