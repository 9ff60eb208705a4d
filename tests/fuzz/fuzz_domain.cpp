// Samples random domains with all methods. The sampler must either reject a request or return a set
// with all guaranteed properties.

#include "tests/analysis/domain_check.hpp"
#include "tests/fuzz/bytes.hpp"
#include "tests/fuzz/fuzz_main.hpp"

#include "core/sampling/domain/domain_sampler.hpp"
#include "core/sampling/point_set.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace {

using namespace thicket;
using fuzz::Bytes;
using fuzz::require;

DomainRequest read_request(Bytes &r_bytes) {
	DomainRequest request;
	request.seed = r_bytes.raw<std::uint64_t>();
	request.radius = r_bytes.chance(4) ? r_bytes.number(min_radius, max_radius) : r_bytes.number(0.05, 20.0);
	request.method = static_cast<DomainMethod>(r_bytes.below(4));
	request.toroidal = r_bytes.chance(2);
	const double scale = std::isfinite(request.radius) ? request.radius : 1.0;
	for (int axis = 0; axis < 2; ++axis) {
		// Occasionally, a side is very long, or short compared with a base square.
		const double widest = r_bytes.chance(8) ? 0.1 : r_bytes.chance(32) ? 2000.0 : 24.0;
		request.size[axis] = scale * r_bytes.number(request.toroidal ? 3.9 : 0.0, widest);
	}
	request.cell_size = r_bytes.chance(2) ? 0.0 : r_bytes.number(0.0, r_bytes.chance(8) ? max_cell_size : 9.0);
	request.darts_each = r_bytes.number(1.0, 20.0);
	return request;
}

/// Returns true if the domain has few points, so that the checks are fast. Larger domains are
/// valid, but slow.
bool is_small(const DomainRequest &request) {
	const glm::dvec2 radii = request.size / request.radius;
	return (radii.x + 1.0) * (radii.y + 1.0) < 5000.0 &&
			(request.method != DomainMethod::naive || request.darts_each < 50.0);
}

template <typename Real>
void check_points(const DomainRequest &request, const std::vector<glm::vec<2, Real>> &points) {
	const analysis::DomainShape shape = analysis::domain_shape<Real>(request.size, request.radius, request.toroidal);
	const bool maximal = request.method != DomainMethod::naive && shape.tolerance <= request.radius / 8.0;
	const analysis::DomainReport report =
			analysis::DomainCheck::run(std::span<const glm::vec<2, Real>>(points), shape, maximal);
	require(report.points > 0, "no domain is empty");
	require(report.outside == 0, "a point lies in its domain");
	require(report.too_close == 0, "points keep the minimum distance");
	require(report.uncovered == 0, "no gap is left");
}

/// Checks that a request produces the same set with a different cell size and a different variant
/// of the method. `fill` must produce as many points.
template <typename Real>
void check_twin(DomainRequest request, const std::vector<glm::vec<2, Real>> &points) {
	request.cell_size = request.cell_size == 0.0 ? 1.7 : 0.0;
	if (request.method == DomainMethod::hierarchical || request.method == DomainMethod::accumulator) {
		request.method =
				request.method == DomainMethod::hierarchical ? DomainMethod::accumulator : DomainMethod::hierarchical;
	}
	std::vector<glm::vec<2, Real>> twin;
	require(DomainSampler<Real>().sample(request, twin).ok() && twin == points, "cells and variants change no point");
	DomainSampler<Real> sampler;
	require(sampler.fill(request).ok(), "a domain that can be sampled can be filled");
	std::size_t visited = 0;
	sampler.visit([&](std::span<const Real> x, std::span<const Real>) { visited += x.size(); });
	require(visited == points.size(), "every point is visited");
}

template <typename Real>
void sample_one(const DomainRequest &request) {
	static DomainSampler<Real> sampler;
	const std::atomic<bool> cancel{true};
	std::vector<glm::vec<2, Real>> points(1, glm::vec<2, Real>(77));
	const std::vector<glm::vec<2, Real>> before = points;
	const Status status =
			sampler.sample(request, points, {.cancel = is_small(request) ? nullptr : &cancel, .report = {}});
	if (status.ok()) {
		require(validate(request).ok(), "a bad request is rejected");
		require(sampler.stats().points == points.size(), "points are counted");
		check_points<Real>(request, points);
		check_twin<Real>(request, points);
	} else {
		require(points == before, "a failed call has no effect");
		require(status.code == ErrorCode::cancelled || describe(status).find(status.property) == 0,
				"an error names the property");
		require(validate(request).ok() || validate(request).code == status.code, "a bad request is rejected as such");
	}
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
	Bytes bytes(data, size);
	const DomainRequest request = read_request(bytes);
	if (bytes.chance(2)) {
		sample_one<float>(request);
	} else {
		sample_one<double>(request);
	}
	return 0;
}
