#include "core/drawing/lod_looks.hpp"

#include <algorithm>

namespace thicket {

LodLooks::LodLooks(const LodSettings &settings, std::span<const LodStep> steps) :
		settings_(settings), steps_(steps.begin(), steps.end()) {
	for (std::size_t lod = 0; lod < steps_.size(); ++lod) {
		if (steps_[lod].same) {
			looks_.back().last = lod;
		} else {
			looks_.push_back({lod, lod, steps_[lod].fades});
		}
		look_of_.push_back(looks_.size() - 1);
	}
}

std::size_t LodLooks::appearance_of(std::size_t lod) const { return look_of_[std::min(lod, look_of_.size() - 1)]; }

bool LodLooks::fades() const { return settings_.fade > 0.0 && std::ranges::any_of(steps_, &LodStep::fades); }

std::array<FadeRange, LookFade::count> LodLooks::ranges(std::size_t look) const {
	const auto &[first, last, fades] = looks_[look];
	std::array<FadeRange, LookFade::count> result;
	for (const bool comes : {false, true}) {
		for (const LodEnd end : {LodEnd::stays, LodEnd::next, LodEnd::sight}) {
			const bool may_come = !comes || first > 0;
			const bool may_go = end == LodEnd::stays || (end == LodEnd::next && last + 1 < steps_.size()) ||
					(end == LodEnd::sight && settings_.sight_end > 0.0);
			result[LookFade{comes, end}.index()] =
					may_come && may_go ? fade_range(settings_, first, last, comes, end) : no_fade;
		}
	}
	return result;
}

LodLooks::Drawn LodLooks::drawn(const LodSpan &span, std::size_t index) const {
	const std::size_t look = look_of_[span.first] + index;
	const LodEnd end = look < look_of_[span.last] ? LodEnd::next : span.ends ? LodEnd::sight : LodEnd::stays;
	const LookFade fade{index > 0, end};
	const bool fades = looks_[look].fades && fade != LookFade();
	return {look, fades ? std::optional(fade) : std::nullopt};
}

LodLooks::Drawn LodLooks::drawn_alone(const LodSpan &span, std::size_t lod) const {
	const std::size_t look = appearance_of(lod);
	const bool fades = looks_[look].fades && span.ends;
	return {look, fades ? std::optional(LookFade{false, LodEnd::sight}) : std::nullopt};
}

} // namespace thicket
