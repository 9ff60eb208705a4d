// Tests the guarantees of DomainSampler for domains that are nearly a line or a point, and for
// domains that are far too large.

#include "domain_cases.hpp"

#include <limits>
#include <string>

using namespace thicket;
using namespace thicket::domain_cases;

TEST_CASE_TEMPLATE("domain extremes: strips flatter than the precision, along each axis", Real, float, double) {
	for (const Method &method : methods) {
		CAPTURE(method.name);
		for (const double flat : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8, 1e-14, 1e-18}) {
			CAPTURE(flat);
			for (const glm::dvec2 radii : {glm::dvec2(300.0, flat), glm::dvec2(flat, 300.0)}) {
				const DomainRequest request = request_of({"", radii, 0.7, false}, method.method, 3);
				const std::vector<glm::vec<2, Real>> points = sampled<Real>(request);
				check_guarantees<Real>(request, points);
				// In one dimension, randomly parked cars of length 1 fill 0.7476 of a street (Renyi
				// 1958).
				const double density = static_cast<double>(points.size()) / 300.0;
				if (method.method != DomainMethod::naive) {
					CHECK(density > 0.70);
					CHECK(density < 0.80);
				}
			}
		}
	}
}

TEST_CASE_TEMPLATE("domain extremes: the smallest possible domains", Real, float, double) {
	constexpr double smallest = std::numeric_limits<double>::denorm_min();
	for (const Method &method : methods) {
		CAPTURE(method.name);
		for (const glm::dvec2 size : {glm::dvec2(smallest, smallest), glm::dvec2(1e-300, 1e-30),
					 glm::dvec2(1e-12, 30.0), glm::dvec2(30.0, smallest)}) {
			for (const double radius : {1e-3, 1.0, 1e6}) {
				DomainRequest request = request_of({"", {1.0, 1.0}, radius, false}, method.method, 2);
				request.size = glm::min(size, 30.0 * radius);
				check_guarantees<Real>(request, sampled<Real>(request));
			}
		}
	}
}

TEST_CASE("domain extremes: domains with too many points are rejected") {
	DomainSampler<double> sampler;
	const std::vector<glm::dvec2> before(3, glm::dvec2(7.0));
	std::vector<glm::dvec2> points = before;
	// A square, long strips with a small area, and sizes whose product overflows.
	for (const glm::dvec2 size : {glm::dvec2(40'000.0, 40'000.0), glm::dvec2(1e12, 1e-6), glm::dvec2(1e-6, 1e12),
				 glm::dvec2(1e300, 1e-300), glm::dvec2(1e200, 1e200), glm::dvec2(1e-300, 1e300)}) {
		CAPTURE(size.x);
		CAPTURE(size.y);
		for (const Method &method : methods) {
			DomainRequest request = request_of({"", {1.0, 1.0}, 1.0, false}, method.method, 1);
			request.size = size;
			const Status status = sampler.sample(request, points);
			CHECK(status.code == ErrorCode::too_many_points);
			CHECK(std::string(status.property) == "size");
			CHECK(status.value > max_domain_points);
			CHECK(points == before);
		}
	}
	CHECK(validate({.size = {37'000.0, 37'000.0}}).ok());
}
