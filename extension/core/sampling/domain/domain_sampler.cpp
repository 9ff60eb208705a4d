#include "core/sampling/domain/domain_sampler.hpp"

#include "core/base/guard.hpp"
#include "core/sampling/domain/thrower.hpp"

#include <cmath>
#include <memory>
#include <numbers>
#include <type_traits>
#include <utility>

namespace thicket {

namespace {

/// Returns the width of acceleration grid cells in base squares. The defaults measured fastest for
/// 10^5 to 10^7 points.
template <typename Real>
std::uint32_t cell_width(const DomainRequest &request) {
	constexpr std::uint32_t accumulator = std::is_same_v<Real, float> ? 5 : 3;
	constexpr std::uint32_t usual = 4;
	if (request.method == DomainMethod::naive || request.cell_size == 0.0) {
		return request.method == DomainMethod::accumulator ? accumulator : usual;
	}
	return static_cast<std::uint32_t>(std::ceil(request.cell_size * std::numbers::sqrt2));
}

} // namespace

template <typename Real>
struct DomainSampler<Real>::State {
	std::unique_ptr<Thrower<Real>> thrower; ///< Null before a successful `fill`.
	DomainStats stats;

	Status run(const DomainRequest &request, std::vector<glm::vec<2, Real>> *r_points, const Progress &progress) {
		const double expected = expected_points(request);
		if (r_points != nullptr) {
			r_points->reserve(static_cast<std::size_t>(1.02 * expected) + 64);
		}
		const std::uint32_t width = cell_width<Real>(request);
		thrower = make_thrower<Real>(request, width);
		const Status status = thrower->run(r_points, progress, expected);
		if (status.ok()) {
			stats = thrower->stats();
			stats.cell_size = width / std::numbers::sqrt2;
		}
		return status;
	}

	Status start(const DomainRequest &request, std::vector<glm::vec<2, Real>> *r_points, const Progress &progress) {
		if (const Status status = validate(request); !status.ok()) {
			return status;
		}
		const double widest = std::max(request.size.x, request.size.y);
		if (std::is_same_v<Real, float> && widest > max_single_radii * request.radius) {
			return {ErrorCode::out_of_range, "size", widest};
		}
		const Status status = guarded("size", widest, [&] { return run(request, r_points, progress); });
		if (!status.ok()) {
			thrower.reset();
		} else if (progress.report) {
			progress.report(1.0, stats.points);
		}
		return status;
	}
};

template <typename Real>
DomainSampler<Real>::DomainSampler() : state_(std::make_unique<State>()) {}

template <typename Real>
DomainSampler<Real>::~DomainSampler() = default;

template <typename Real>
DomainSampler<Real>::DomainSampler(DomainSampler &&) noexcept = default;

template <typename Real>
DomainSampler<Real> &DomainSampler<Real>::operator=(DomainSampler &&) noexcept = default;

template <typename Real>
Status DomainSampler<Real>::sample(
		const DomainRequest &request, std::vector<glm::vec<2, Real>> &r_points, const Progress &progress) {
	std::vector<glm::vec<2, Real>> points;
	const Status status = state_->start(request, &points, progress);
	if (status.ok()) {
		state_->thrower.reset();
		r_points = std::move(points);
	}
	return status;
}

template <typename Real>
Status DomainSampler<Real>::fill(const DomainRequest &request, const Progress &progress) {
	return state_->start(request, nullptr, progress);
}

template <typename Real>
void DomainSampler<Real>::visit(
		const std::function<void(std::span<const Real> x, std::span<const Real> y)> &visitor) const {
	if (state_->thrower) {
		state_->thrower->visit(visitor);
	}
}

template <typename Real>
const DomainStats &DomainSampler<Real>::stats() const {
	return state_->stats;
}

template class DomainSampler<float>;
template class DomainSampler<double>;

} // namespace thicket
