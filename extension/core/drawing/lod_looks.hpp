#pragma once

#include "core/drawing/lod_span.hpp"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace thicket {

/// How a look (see `LodLooks`) fades at the near and far ends of its range of distances.
struct LookFade {
	bool comes = false; ///< True if the look fades in at the near end and replaces the previous one.
	LodEnd end = LodEnd::stays;

	static constexpr std::size_t count = 6;
	constexpr std::size_t index() const { return (comes ? 3 : 0) + static_cast<std::size_t>(end); }

	friend bool operator==(const LookFade &, const LookFade &) = default;
};

/// A look is a run of consecutive LODs that are drawn identically. Looks replace each other with
/// distance. This class determines which looks are drawn for a span of LODs and how each of them
/// fades.
class LodLooks {
public:
	LodLooks() = default;

	/// `steps` has one entry for each LOD, including the finest. In the first entry, `same` must be
	/// false.
	LodLooks(const LodSettings &settings, std::span<const LodStep> steps);

	std::span<const LodStep> steps() const { return steps_; }
	std::size_t count() const { return looks_.size(); }

	/// Returns the index of the look of an LOD. LODs beyond the last have the last look.
	std::size_t appearance_of(std::size_t lod) const;

	/// Returns true if any look can fade.
	bool fades() const;

	/// Returns the fade range of a look for each LookFade, in the order of LookFade::index.
	/// Combinations that cannot occur have no_fade.
	std::array<FadeRange, LookFade::count> ranges(std::size_t look) const;

	/// Returns the number of looks that are drawn for a span, minus one.
	std::size_t beyond_first(const LodSpan &span) const { return look_of_[span.last] - look_of_[span.first]; }

	/// A look and its fade, as drawn by one visual.
	struct Drawn {
		std::size_t look = 0;
		std::optional<LookFade> fade; ///< Empty if the look does not fade.
	};

	/// Returns one of the looks that are drawn for a span. `index` is 0 for the look of the span's
	/// first LOD, up to beyond_first(span).
	Drawn drawn(const LodSpan &span, std::size_t index) const;

	/// Returns the look of an LOD that is drawn alone instead of the whole span.
	Drawn drawn_alone(const LodSpan &span, std::size_t lod) const;

private:
	struct Look {
		std::size_t first = 0; ///< First and last LOD of the look.
		std::size_t last = 0;
		bool fades = false; ///< True if the look's materials can fade.
	};

	LodSettings settings_;
	std::vector<LodStep> steps_;
	std::vector<std::size_t> look_of_; ///< Index of the look of each LOD.
	std::vector<Look> looks_;
};

} // namespace thicket
