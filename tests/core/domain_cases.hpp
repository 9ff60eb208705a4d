#pragma once

#include "core/sampling/domain/domain_sampler.hpp"
#include "tests/analysis/domain_check.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

namespace thicket::domain_cases {

struct Method {
	DomainMethod method;
	std::string name;
};

inline const std::array<Method, 4> methods = {{
		{DomainMethod::naive, "naive"},
		{DomainMethod::hierarchical, "hierarchical"},
		{DomainMethod::accumulator, "accumulator"},
		{DomainMethod::wavefront, "wavefront"},
}};

/// The methods whose sets are maximal.
inline const std::array<Method, 3> maximal_methods = {{methods[1], methods[2], methods[3]}};

struct Shape {
	std::string name;
	glm::dvec2 radii; ///< Size in radii.
	double radius;    ///< Minimum distance in meters.
	bool toroidal;
};

/// Base squares are sqrt(1/2) = 0.707 radii wide, and a group of the wavefront is three base squares wide. Along both
/// axes, the counts of base squares have every remainder modulo three.
inline const std::vector<Shape> shapes = {
		{"square", {30.0, 30.0}, 1.0, false},
		{"wide", {61.3, 7.9}, 0.5, false},
		{"tall", {6.4, 52.7}, 2.25, false},
		{"smaller than a base square", {0.5, 0.3}, 1.0, false},
		{"smaller than the radius", {0.9, 0.8}, 3.0, false},
		{"wider than the radius, flatter than a base square", {1.9, 0.2}, 1.0, false},
		{"ratio of no whole numbers", {17.31, 23.78}, 0.37, false},
		{"thin strip along x", {300.0, 0.05}, 1.0, false},
		{"thin strip along y", {0.6, 300.0}, 1.0, false},
		{"least radius", {25.3, 11.9}, 1e-3, false},
		{"largest radius", {13.7, 16.1}, 1e6, false},
		{"square torus", {30.0, 30.0}, 1.0, true},
		{"wide torus", {61.3, 7.9}, 0.5, true},
		{"tall torus", {6.4, 52.7}, 2.25, true},
		{"smallest torus", {4.0, 4.0}, 1.0, true},
		{"narrow torus along x", {120.0, 4.0}, 1.0, true},
		{"narrow torus along y", {4.3, 120.0}, 1.0, true},
		{"torus, ratio of no whole numbers", {17.31, 23.78}, 0.37, true},
		{"torus, least radius", {25.3, 11.9}, 1e-3, true},
		{"torus, largest radius", {13.7, 16.1}, 1e6, true},
};

inline DomainRequest request_of(const Shape &shape, DomainMethod method, std::uint64_t seed) {
	DomainRequest request;
	request.size = shape.radii * shape.radius;
	request.radius = shape.radius;
	request.seed = seed;
	request.method = method;
	request.toroidal = shape.toroidal;
	return request;
}

template <typename Real>
std::vector<glm::vec<2, Real>> sampled(const DomainRequest &request) {
	DomainSampler<Real> sampler;
	std::vector<glm::vec<2, Real>> points;
	const Status status = sampler.sample(request, points);
	REQUIRE_MESSAGE(status.ok(), describe(status));
	CHECK(sampler.stats().points == points.size());
	return points;
}

template <typename Real>
analysis::DomainReport report_on(const DomainRequest &request, const std::vector<glm::vec<2, Real>> &points) {
	return analysis::DomainCheck::run(std::span<const glm::vec<2, Real>>(points),
			analysis::domain_shape<Real>(request.size, request.radius, request.toroidal),
			request.method != DomainMethod::naive);
}

/// Checks that a set keeps guarantees 1 to 3 of DomainSampler, but not its coverage for the naive method.
template <typename Real>
void check_guarantees(const DomainRequest &request, const std::vector<glm::vec<2, Real>> &points) {
	const analysis::DomainReport report = report_on<Real>(request, points);
	CHECK(report.points > 0);
	CHECK(report.outside == 0);
	CHECK(report.too_close == 0);
	CAPTURE(report.uncovered_at.x);
	CAPTURE(report.uncovered_at.y);
	CHECK(report.uncovered == 0);
}

/// Sorts points by position, so that sets compare equal regardless of the order in which they were generated.
template <typename Real>
std::vector<glm::vec<2, Real>> sorted(std::vector<glm::vec<2, Real>> points) {
	std::sort(points.begin(), points.end(),
			[](const auto &a, const auto &b) { return a.y != b.y ? a.y < b.y : a.x < b.x; });
	return points;
}

} // namespace thicket::domain_cases
