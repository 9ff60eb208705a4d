// Fills a domain by hierarchical dart throwing. thrower.cpp compiles this file once for each
// instruction set.
#if defined(THICKET_DART_THROWER_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef THICKET_DART_THROWER_INL
#undef THICKET_DART_THROWER_INL
#else
#define THICKET_DART_THROWER_INL
#endif

#include "core/base/split_mix.hpp"
#include "core/base/status.hpp"
#include "core/sampling/domain/active_squares.hpp"
#include "core/sampling/domain/domain_sampler.hpp"
#include "core/sampling/domain/frame.hpp"
#include "core/sampling/domain/group_map.hpp"
#include "core/sampling/domain/near-inl.hpp"
#include "core/sampling/domain/thrower.hpp"

#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

/// Hierarchical dart throwing (figure 2 of the paper, see DomainMethod) over one domain. All base
/// squares are active from the start. With the wavefront method, groups of base squares become
/// active around accepted darts.
///
/// Squares are chosen at random across the domain, so in a large domain each choice would wait for
/// memory. The thrower therefore draws the random bits of later choices in advance. It prefetches
/// the data that they will probably need: first the list entry, then the cells around the square.
/// Each choice is repeated when its turn comes, so prefetching never affects the result. A
/// prefetch must resolve the address of its page before later instructions can retire. Many
/// prefetches are therefore started together, so that their address lookups overlap.
///
/// `Cells` is the acceleration grid: PointCells or LineCells.
template <typename Real, class Cells>
class DartThrower final : public Thrower<Real> {
public:
	using Points = std::vector<glm::vec<2, Real>>;

	/// Prepares a run. `cell_width` is in base squares. Throws std::bad_alloc.
	DartThrower(const DomainRequest &request, std::uint32_t cell_width) :
			frame_(Frame<Real>::of(request)), wavefront_(request.method == DomainMethod::wavefront),
			key_(split_mix(request.seed + split_mix_gamma)), active_(frame_.base_squares()),
			cells_(frame_, cell_width) {
		for (int level = 0; level <= frame_.finest; ++level) {
			const auto width = static_cast<double>(width_of(static_cast<std::uint32_t>(level)));
			half_x_[static_cast<std::size_t>(level)] = half_span(width * frame_.unit.x);
			half_y_[static_cast<std::size_t>(level)] = half_span(width * frame_.unit.y);
			step_[static_cast<std::size_t>(level)] = std::ldexp(0x1p-32, frame_.finest - level);
		}
	}

	/// Throws darts until no square is active, or the call is cancelled. The accepted darts are
	/// appended to `r_points`, unless it is null.
	Status run(Points *r_points, const Progress &progress, double expected_points) override {
		if (!begin(progress, expected_points)) {
			return {ErrorCode::cancelled};
		}
		// The first choices touch fresh memory throughout the domain, whose pages the system must
		// create. They are a thousand times slower than later ones, so cancellation is checked more
		// often at first.
		std::uint64_t choices_per_check = 8;
		std::uint64_t choices_until_check = 1;
		while (!active_.empty()) {
			if (--choices_until_check == 0) {
				choices_per_check = std::min(choices_per_check + choices_per_check / 8, max_choices_per_check);
				choices_until_check = choices_per_check;
				if (!check_progress(progress, expected_points)) {
					return {ErrorCode::cancelled};
				}
			}
			step(r_points);
		}
		return {};
	}

	DomainStats stats() const override {
		DomainStats stats = counts_;
		stats.squares = active_.created_count();
		stats.list_checks = active_.list_checks();
		stats.levels = active_.levels_used();
		stats.squares_by_level = active_.created_by_level();
		stats.grid_bytes = cells_.bytes();
		stats.square_bytes = active_.bytes() + (groups_ ? groups_->bytes() : 0);
		return stats;
	}

	void visit(const PointVisitor<Real> &visitor) const override { cells_.visit(visitor); }

private:
	/// The number of choices that are prefetched together. List entries are prefetched two batches
	/// ahead, and cells one batch ahead.
	static constexpr std::uint64_t batch = 8;
	static constexpr std::size_t ring_size = 4 * batch; ///< Number of prefetched choices that are stored.
	static constexpr std::uint64_t max_choices_per_check = 4096;
	static constexpr std::uint64_t base_squares_per_check = 1u << 17;

	using Unit = SquareUnit<Real>;
	using Draw = typename ActiveSquares<Real>::Draw;
	using Choice = typename ActiveSquares<Real>::Choice;

	Frame<Real> frame_;
	bool wavefront_;
	std::uint64_t key_;
	ActiveSquares<Real> active_;
	Cells cells_;
	std::optional<GroupMap> groups_;
	DomainStats counts_;
	/// Spans with a larger half may be up to two quanta too wide.
	Real narrow_half_ = static_cast<Real>(4.0 * frame_.quantum);
	/// half_span() for each level.
	std::array<Real, ActiveSquares<Real>::max_levels> half_x_{};
	std::array<Real, ActiveSquares<Real>::max_levels> half_y_{};
	/// For each level, 2^-32 of a square's width in SquareUnits.
	std::array<double, ActiveSquares<Real>::max_levels> step_{};
	std::array<Draw, ring_size> draws_{};
	std::array<Choice, ring_size> foreseen_{};

	/// Returns random bits. Each choice has three words.
	HWY_INLINE std::uint64_t bits(std::uint64_t choice, std::uint64_t word) const {
		return split_mix(key_ + (3 * choice + word) * split_mix_gamma);
	}
	Draw draw(std::uint64_t choice) const { return {bits(choice, 0), bits(choice, 1)}; }

	void push_base(glm::uvec2 square) {
		active_.push(0,
				{static_cast<Unit>(Unit{square.x} << frame_.finest),
						static_cast<Unit>(Unit{square.y} << frame_.finest)});
	}

	bool begin(const Progress &progress, double expected_points) {
		for (std::size_t choice = 0; choice < 2 * batch; ++choice) {
			draws_[choice] = draw(choice);
		}
		if (wavefront_) {
			groups_.emplace(frame_.squares, frame_.toroidal);
			groups_->activate({0, 0}, [this](glm::uvec2 square) { push_base(square); });
			return true;
		}
		for (std::uint32_t y = 0; y < frame_.squares.y; ++y) {
			for (std::uint32_t x = 0; x < frame_.squares.x; ++x) {
				if (active_.created_count() % base_squares_per_check == 0 &&
						!check_progress(progress, expected_points)) {
					return false;
				}
				push_base({x, y});
			}
		}
		return true;
	}

	/// Reports the progress. Returns false if the run is cancelled.
	bool check_progress(const Progress &progress, double expected_points) const {
		if (progress.report) {
			progress.report(std::min(1.0, static_cast<double>(counts_.points) / expected_points), counts_.points);
		}
		return !progress.cancelled();
	}

	glm::uvec2 base_of(const Square<Real> &square) const {
		return {static_cast<std::uint32_t>(square.x >> frame_.finest),
				static_cast<std::uint32_t>(square.y >> frame_.finest)};
	}

	/// Prefetches data for the next batches. This function is called before the first choice of
	/// each batch.
	void foresee() {
		const std::uint64_t next = counts_.selections + batch;
		const std::uint64_t later = next + batch;
		for (std::uint64_t choice = next; choice < later; ++choice) {
			if (const Square<Real> *square = active_.peek(foreseen_[choice % ring_size])) {
				cells_.prefetch(base_of(*square));
			}
		}
		for (std::uint64_t choice = later; choice < later + batch; ++choice) {
			draws_[choice % ring_size] = draw(choice);
			foreseen_[choice % ring_size] = active_.foresee(draws_[choice % ring_size]);
		}
		for (std::uint64_t choice = later; choice < later + batch; ++choice) {
			__builtin_prefetch(active_.peek(foreseen_[choice % ring_size]));
		}
	}

	void step(Points *r_points) {
		if (counts_.selections % batch == 0) {
			foresee();
		}
		const std::uint64_t number = counts_.selections++;
		const Choice choice = active_.choose(draws_[number % ring_size]);
		const Square<Real> square = active_.take(choice);
		const CenteredSquare<Real> centered = centered_square(square, choice.level);
		const glm::uvec2 base = base_of(square);
		const auto near = cells_.near(base, centered);
		if (any_covers(near, centered, frame_.limit)) {
			// A dart would be rejected, and all quarters of the square are covered.
			return;
		}
		++counts_.darts;
		const glm::vec<2, Real> dart = dart_in(square, choice.level, bits(number, 2));
		if (!any_within(near, dart.x, dart.y, frame_.limit)) {
			accept(dart, base, r_points);
		} else if (static_cast<int>(choice.level) < frame_.finest) {
			split(square, choice.level, near);
		} else {
			++counts_.discarded;
		}
	}

	/// Returns the width of the squares at a level, in SquareUnits.
	Unit width_of(std::uint32_t level) const {
		return static_cast<Unit>(Unit{1} << (static_cast<std::uint32_t>(frame_.finest) - level));
	}

	HWY_INLINE CenteredSquare<Real> centered_square(const Square<Real> &square, std::uint32_t level) const {
		const Unit width = width_of(level);
		CenteredSquare<Real> result;
		span(square.x, width, half_x_[level], 0, result.x, result.half_x);
		span(square.y, width, half_y_[level], 1, result.y, result.half_y);
		return result;
	}

	/// Finds a span that contains all positions on one axis to which darts in a square may round.
	/// The arithmetic is exact, so a disk that covers the spans of both axes rejects every such dart.
	HWY_INLINE void span(Unit corner, Unit width, Real half, int axis, Real &r_center, Real &r_half) const {
		const Real low = frame_.coordinate(static_cast<double>(corner) * frame_.unit[axis], axis);
		r_half = half;
		if (half <= narrow_half_) {
			// A wider span could hide that all darts round to the same position.
			const Unit end = corner + width;
			const Real high = frame_.coordinate(static_cast<double>(end) * frame_.unit[axis], axis);
			r_center = low + (high - low) / 2;
			r_half = std::max(r_center - low, high - r_center);
			return;
		}
		r_center = low + half;
	}

	/// Returns half the span of a square, rounded up to a multiple of the quantum.
	Real half_span(double meters) const {
		return static_cast<Real>(frame_.quantum * std::ceil(0.5 * (meters / frame_.quantum + 1.0)));
	}

	/// Returns a uniformly distributed position in the square.
	glm::vec<2, Real> dart_in(const Square<Real> &square, std::uint32_t level, std::uint64_t random) const {
		const double width = step_[level];
		const double x = static_cast<double>(square.x) + static_cast<double>(random >> 32) * width;
		const double y = static_cast<double>(square.y) + static_cast<double>(random & 0xffffffff) * width;
		return {frame_.coordinate(x * frame_.unit.x, 0), frame_.coordinate(y * frame_.unit.y, 1)};
	}

	void accept(glm::vec<2, Real> dart, glm::uvec2 base, Points *r_points) {
		++counts_.points;
		cells_.add(dart.x, dart.y, base);
		if (r_points != nullptr) {
			r_points->push_back({frame_.to_plain(dart.x), frame_.to_plain(dart.y)});
		}
		if (groups_) {
			groups_->activate_around(base, [this](glm::uvec2 square) { push_base(square); });
		}
	}

	template <class Surroundings>
	void split(const Square<Real> &square, std::uint32_t level, const Surroundings &near) {
		const std::uint32_t child_level = level + 1;
		const Unit width = width_of(child_level);
		const Square<Real> opposite{static_cast<Unit>(square.x + width), static_cast<Unit>(square.y + width)};
		const std::uint32_t covered = covered_quarters(
				near, centered_square(square, child_level), centered_square(opposite, child_level), frame_.limit);
		for (std::uint32_t child = 0; child < 4; ++child) {
			if ((covered >> child & 1) == 0) {
				active_.push(child_level,
						{(child & 1) != 0 ? opposite.x : square.x, (child >> 1) != 0 ? opposite.y : square.y});
			}
		}
	}
};

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
