#include "core/sampling/domain/thrower.hpp"

#define THICKET_SELDOM_RUN
#include "core/base/instruction_sets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/sampling/domain/thrower.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "core/sampling/domain/dart_thrower-inl.hpp"
#include "core/sampling/domain/line_cells-inl.hpp"
#include "core/sampling/domain/naive_darts-inl.hpp"
#include "core/sampling/domain/point_cells-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace thicket::HWY_NAMESPACE {

template <typename Real>
std::unique_ptr<Thrower<Real>> make(const DomainRequest &request, std::uint32_t cell_width) {
	switch (request.method) {
		case DomainMethod::naive: return std::make_unique<NaiveDarts<Real>>(request, cell_width);
		case DomainMethod::accumulator:
			// In single precision, a cell of PointCells spans only a few cache lines anyway.
			if constexpr (std::is_same_v<Real, double>) {
				if (cell_width <= LineCells::widest) {
					// LineCells returns the same points, but most lookups read only one cache line.
					return std::make_unique<DartThrower<Real, LineCells>>(request, cell_width);
				}
			}
			return std::make_unique<DartThrower<Real, PointCells<Real, true>>>(request, cell_width);
		default: return std::make_unique<DartThrower<Real, PointCells<Real, false>>>(request, cell_width);
	}
}

std::unique_ptr<Thrower<float>> make_single(const DomainRequest &request, std::uint32_t cell_width) {
	return make<float>(request, cell_width);
}

std::unique_ptr<Thrower<double>> make_double(const DomainRequest &request, std::uint32_t cell_width) {
	return make<double>(request, cell_width);
}

} // namespace thicket::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace thicket {

HWY_EXPORT(make_single);
HWY_EXPORT(make_double);

template <>
std::unique_ptr<Thrower<float>> make_thrower<float>(const DomainRequest &request, std::uint32_t cell_width) {
	return HWY_DYNAMIC_DISPATCH(make_single)(request, cell_width);
}

template <>
std::unique_ptr<Thrower<double>> make_thrower<double>(const DomainRequest &request, std::uint32_t cell_width) {
	return HWY_DYNAMIC_DISPATCH(make_double)(request, cell_width);
}

} // namespace thicket
#endif
