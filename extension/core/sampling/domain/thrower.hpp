#pragma once

#include "core/base/status.hpp"
#include "core/sampling/domain/domain_sampler.hpp"

#include <glm/vec2.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

template <typename Real>
using PointVisitor = std::function<void(std::span<const Real> x, std::span<const Real> y)>;

/// Fills one domain by one method. Each object is used for a single run.
template <typename Real>
class Thrower {
public:
	virtual ~Thrower() = default;

	/// Throws darts until the method ends or the call is cancelled. The accepted darts are appended
	/// to `r_points`, unless it is null, in the order of acceptance. `expected_points` scales the
	/// reported progress. Throws std::bad_alloc.
	virtual Status run(std::vector<glm::vec<2, Real>> *r_points, const Progress &progress, double expected_points) = 0;

	virtual DomainStats stats() const = 0;
	virtual void visit(const PointVisitor<Real> &visitor) const = 0;
};

/// Creates the thrower for the request's method, compiled for the processor's best instruction set.
/// All instruction sets return the same bits. `cell_width` is in base squares. Throws
/// std::bad_alloc.
template <typename Real>
std::unique_ptr<Thrower<Real>> make_thrower(const DomainRequest &request, std::uint32_t cell_width);

template <>
std::unique_ptr<Thrower<float>> make_thrower<float>(const DomainRequest &request, std::uint32_t cell_width);
template <>
std::unique_ptr<Thrower<double>> make_thrower<double>(const DomainRequest &request, std::uint32_t cell_width);

} // namespace thicket
