#pragma once

#include "core/drawing/lod_span.hpp"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace thicket {

/// How a look fades: over which end of its range.
struct LookFade {
	bool comes = false; ///< The look fades in and replaces the previous look.
	LodEnd end = LodEnd::stays;

	static constexpr std::size_t count = 6;
	constexpr std::size_t index() const { return (comes ? 3 : 0) + static_cast<std::size_t>(end); }

	friend bool operator==(const LookFade &, const LookFade &) = default;
};

/// The looks that replace each other as the distance grows. Consecutive LODs that are drawn alike share one look. This
/// class decides which looks are drawn for a span of LODs, and which of these looks fade.
class LodLooks {
public:
	LodLooks() = default;

	/// `steps` has one entry for each LOD, including the nearest; the first is never `same`.
	LodLooks(const LodSettings &settings, std::span<const LodStep> steps);

	std::span<const LodStep> steps() const { return steps_; }
	std::size_t count() const { return looks_.size(); }

	/// The look of an LOD; of the last LOD for a number beyond it.
	std::size_t look_of(std::size_t lod) const;

	/// True if any look ever fades.
	bool fades() const;

	/// The ranges in which a look may be drawn, by LookFade::index; no_fade for an index that never occurs.
	std::array<FadeRange, LookFade::count> ranges(std::size_t look) const;

	/// The number of looks that are drawn for a span, minus one.
	std::size_t beyond_first(const LodSpan &span) const { return look_of_[span.last] - look_of_[span.first]; }

	/// A look as a visual draws it.
	struct Drawn {
		std::size_t look = 0;
		std::optional<LookFade> fade; ///< None if it does not fade.
	};

	/// One of the looks of a span, 0 to beyond_first(span); 0 is the look of its first LOD.
	Drawn drawn(const LodSpan &span, std::size_t index) const;

	/// The look of one LOD of a span when it is drawn alone, in place of the whole span.
	Drawn drawn_alone(const LodSpan &span, std::size_t lod) const;

private:
	struct Look {
		std::size_t first = 0; ///< The look's LODs.
		std::size_t last = 0;
		bool fades = false; ///< The look's materials can fade.
	};

	LodSettings settings_;
	std::vector<LodStep> steps_;
	std::vector<std::size_t> look_of_; ///< The look of each LOD.
	std::vector<Look> looks_;
};

} // namespace thicket
