#pragma once

#include "core/drawing/lod_span.hpp"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace thicket {

/// How a run of LODs (see `LodRuns`) fades at the near and far ends of its range of distances.
struct RunFade {
	bool fades_in = false; ///< True if the run fades in at the near end and replaces the previous one.
	LodEnd end = LodEnd::stays;

	static constexpr std::size_t count = 6;
	constexpr std::size_t index() const { return (fades_in ? 3 : 0) + static_cast<std::size_t>(end); }

	friend bool operator==(const RunFade &, const RunFade &) = default;
};

/// A run of consecutive LODs that are drawn identically. Runs replace each other with
/// distance. This class determines which runs are drawn for a span of LODs and how each of them
/// fades.
class LodRuns {
public:
	LodRuns() = default;

	/// `steps` has one entry for each LOD, including the finest. In the first entry, `same` must be
	/// false.
	LodRuns(const LodSettings &settings, std::span<const LodStep> steps);

	std::span<const LodStep> steps() const { return steps_; }
	std::size_t count() const { return runs_.size(); }

	/// Returns the index of the run of an LOD. LODs beyond the last have the last run.
	std::size_t run_of(std::size_t lod) const;

	/// Returns true if any run can fade.
	bool fades() const;

	/// Returns the fade range of a run for each RunFade, in the order of RunFade::index.
	/// Combinations that cannot occur have no_fade.
	std::array<FadeRange, RunFade::count> ranges(std::size_t run) const;

	/// Returns the number of runs that are drawn for a span, minus one.
	std::size_t extra_run_count(const LodSpan &span) const {
		return run_indices_[span.last] - run_indices_[span.first];
	}

	/// A run and its fade, as drawn by one visual.
	struct DrawnRun {
		std::size_t run = 0;
		std::optional<RunFade> fade; ///< Empty if the run does not fade.
	};

	/// Returns one of the runs that are drawn for a span. `index` is 0 for the run of the span's
	/// first LOD, up to extra_run_count(span).
	DrawnRun drawn_run(const LodSpan &span, std::size_t index) const;

	/// Returns the run of an LOD that is drawn alone instead of the whole span.
	DrawnRun single_run(const LodSpan &span, std::size_t lod) const;

private:
	struct Run {
		std::size_t first = 0; ///< First and last LOD of the run.
		std::size_t last = 0;
		bool fades = false; ///< True if the run's materials can fade.
	};

	LodSettings settings_;
	std::vector<LodStep> steps_;
	std::vector<std::size_t> run_indices_; ///< Index of the run of each LOD.
	std::vector<Run> runs_;
};

} // namespace thicket
