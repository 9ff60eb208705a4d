// Fills a domain by naive dart throwing. thrower.cpp compiles this file once for each instruction
// set.
#if defined(THICKET_NAIVE_DARTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_NAIVE_DARTS_INL
#undef THICKET_NAIVE_DARTS_INL
#else
#define THICKET_NAIVE_DARTS_INL
#endif

#include "core/base/split_mix.hpp"
#include "core/base/status.hpp"
#include "core/sampling/domain/domain_sampler.hpp"
#include "core/sampling/domain/frame.hpp"
#include "core/sampling/domain/point_cells-inl.hpp"
#include "core/sampling/domain/thrower.hpp"

#include <hwy/highway.h>

#include <cmath>
#include <cstdint>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

/// Naive dart throwing (section 1 of the paper, see DomainMethod). Darts are thrown anywhere in the
/// domain, one by one, and accepted if they keep the minimum distance. The method cannot detect
/// that the set is maximal, so it stops after a fixed number of darts.
template <typename Real>
class NaiveDarts final : public Thrower<Real> {
public:
	/// Prepares a run. Throws std::bad_alloc.
	NaiveDarts(const DomainRequest &request, std::uint32_t cell_width) :
			frame_(Frame<Real>::of(request)), key_(split_mix(request.seed + split_mix_gamma)),
			throws_(static_cast<std::uint64_t>(request.darts_each * static_cast<double>(frame_.base_squares()))),
			cells_(frame_, cell_width) {}

	/// Throws the darts. The accepted ones are appended to `r_points`, unless it is null.
	Status run(std::vector<glm::vec<2, Real>> *r_points, const Progress &progress, double) override {
		for (; counts_.darts < throws_; ++counts_.darts) {
			if (counts_.darts % throws_per_check == 0 && !check_progress(progress)) {
				return {ErrorCode::cancelled};
			}
			throw_dart(split_mix(key_ + counts_.darts * split_mix_gamma), r_points);
		}
		return {};
	}

	DomainStats stats() const override {
		DomainStats stats = counts_;
		stats.grid_bytes = cells_.bytes();
		return stats;
	}

	void visit(const PointVisitor<Real> &visitor) const override { cells_.visit(visitor); }

private:
	// Number of throws between two checks of the cancel flag. It is small, because the first throws
	// touch fresh memory and are slow.
	static constexpr std::uint64_t throws_per_check = 64;

	Frame<Real> frame_;
	std::uint64_t key_;
	std::uint64_t throws_;
	PointCells<Real, false> cells_;
	DomainStats counts_;

	/// Reports the progress. Returns false if the run is cancelled.
	bool check_progress(const Progress &progress) const {
		if (progress.report) {
			progress.report(static_cast<double>(counts_.darts) / static_cast<double>(throws_), counts_.points);
		}
		return !progress.cancelled();
	}

	void throw_dart(std::uint64_t random, std::vector<glm::vec<2, Real>> *r_points) {
		const glm::dvec2 part(
				static_cast<double>(random >> 32) * 0x1p-32, static_cast<double>(random & 0xffffffff) * 0x1p-32);
		const glm::dvec2 position = part * frame_.period;
		const glm::vec<2, Real> dart(frame_.coordinate(position.x, 0), frame_.coordinate(position.y, 1));
		const glm::uvec2 square = glm::min(glm::uvec2(position / frame_.base), frame_.squares - 1u);
		const Near<Real> near = cells_.near(square, {dart.x, dart.y, Real{0}, Real{0}});
		if (any_within(near, dart.x, dart.y, frame_.limit)) {
			return;
		}
		++counts_.points;
		cells_.add(dart.x, dart.y, square);
		if (r_points != nullptr) {
			r_points->push_back({frame_.to_plain(dart.x), frame_.to_plain(dart.y)});
		}
	}
};

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
