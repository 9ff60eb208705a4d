// Tests that DomainSampler reports invalid input and a lack of memory, and that the results stay unchanged.

#include "allocation_count.hpp"
#include "domain_cases.hpp"
#include "refusal.hpp"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <string>

#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__)
#define THICKET_LIMITS_MEMORY
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#endif

using namespace thicket;
using namespace thicket::domain_cases;

namespace {

/// A sampler that has sampled and filled a valid domain. A rejected call must leave both results
/// unchanged.
template <typename Real>
struct Fixture {
	DomainRequest good = request_of({"", {20.0, 12.0}, 1.0, false}, DomainMethod::wavefront, 1);
	DomainSampler<Real> sampler;
	std::vector<glm::vec<2, Real>> points;
	std::vector<glm::vec<2, Real>> before;

	Fixture() {
		REQUIRE(sampler.sample(good, points).ok());
		REQUIRE(sampler.fill(good).ok());
		REQUIRE(points.size() > 100);
		before = points;
	}

	std::size_t visited() const {
		std::size_t count = 0;
		sampler.visit([&](std::span<const Real> x, std::span<const Real>) { count += x.size(); });
		return count;
	}

	void refuse(const DomainRequest &request, ErrorCode code, const std::string &property, double value) {
		CHECK(validate(request).code == code);
		refuse_to_run(request, code, property, value);
	}

	/// Checks that requests that are invalid only in this precision are rejected, as `refuse` does.
	void refuse_to_run(const DomainRequest &request, ErrorCode code, const std::string &property, double value) {
		check_refused(sampler.sample(request, points), code, property, value);
		CHECK(points == before);
		check_refused(sampler.fill(request), code, property, value);
		CHECK(visited() == before.size());
	}
};

template <typename Real>
void refuse_size(Fixture<Real> &fixture, glm::dvec2 size, ErrorCode code, double value) {
	CAPTURE(size.x);
	CAPTURE(size.y);
	for (const Method &method : methods) {
		DomainRequest request = fixture.good;
		request.method = method.method;
		request.size = size;
		fixture.refuse(request, code, "size", value);
	}
}

constexpr double inf = infinite_value;

} // namespace

TEST_CASE_TEMPLATE("domain errors: invalid values of radius are rejected", Real, float, double) {
	Fixture<Real> fixture;
	const auto refuse = [&](double radius, ErrorCode code) {
		DomainRequest request = fixture.good;
		request.radius = radius;
		fixture.refuse(request, code, "radius", radius);
	};
	for (const double radius : {0.0, -0.0, -1.0, -1e300}) {
		refuse(radius, ErrorCode::not_positive);
	}
	for (const double radius : {nan_value, inf, -inf}) {
		refuse(radius, ErrorCode::not_finite);
	}
	for (const double radius : {std::nextafter(1e-3, 0.0), std::numeric_limits<double>::denorm_min(),
				 std::nextafter(1e6, inf), std::numeric_limits<double>::max()}) {
		refuse(radius, ErrorCode::out_of_range);
	}
}

TEST_CASE_TEMPLATE("domain errors: invalid values of size are rejected", Real, float, double) {
	Fixture<Real> fixture;
	for (const double bad : {nan_value, inf, -inf}) {
		refuse_size(fixture, {bad, 10.0}, ErrorCode::not_finite, bad);
		refuse_size(fixture, {10.0, bad}, ErrorCode::not_finite, bad);
	}
	for (const double bad : {0.0, -0.0, -1.0, -1e300}) {
		refuse_size(fixture, {bad, 10.0}, ErrorCode::not_positive, bad);
		refuse_size(fixture, {10.0, bad}, ErrorCode::not_positive, bad);
	}
	CHECK(describe(validate({.size = {-2.5, 1.0}})) == "size must be positive, got -2.5");
}

TEST_CASE_TEMPLATE("domain errors: a torus on which a disk would overlap itself is rejected", Real, float, double) {
	Fixture<Real> fixture;
	fixture.good.toroidal = true;
	fixture.good.radius = 0.5;
	const double min_size = min_torus_radii * fixture.good.radius;
	const double narrow = std::nextafter(min_size, 0.0);
	refuse_size(fixture, {narrow, 10.0}, ErrorCode::out_of_range, narrow);
	refuse_size(fixture, {10.0, narrow}, ErrorCode::out_of_range, narrow);
	refuse_size(fixture, {1e-3, 1e-3}, ErrorCode::out_of_range, 1e-3);
	CHECK(validate({.size = {min_size, min_size}, .radius = 0.5, .toroidal = true}).ok());
	CHECK(validate({.size = {narrow, narrow}, .radius = 0.5, .toroidal = false}).ok());
}

TEST_CASE("domain errors: a domain that is too wide for single precision is rejected") {
	Fixture<float> fixture;
	DomainRequest request = fixture.good;
	request.radius = 0.5;
	const double wide = std::nextafter(max_single_radii * request.radius, inf);
	for (const glm::dvec2 size : {glm::dvec2(wide, 0.1), glm::dvec2(0.1, wide)}) {
		request.size = size;
		CHECK(validate(request).ok());
		fixture.refuse_to_run(request, ErrorCode::out_of_range, "size", wide);
	}
	// In double precision, the domain is valid.
	check_guarantees<double>(request, sampled<double>(request));
}

TEST_CASE_TEMPLATE("domain errors: invalid values of cell_size are rejected", Real, float, double) {
	Fixture<Real> fixture;
	for (const Method &method : methods) {
		DomainRequest request = fixture.good;
		request.method = method.method;
		for (const double bad : {nan_value, inf, -inf}) {
			request.cell_size = bad;
			fixture.refuse(request, ErrorCode::not_finite, "cell_size", bad);
		}
		for (const double bad : {-1.0, -1e-300, std::nextafter(max_cell_size, inf), 1e300}) {
			request.cell_size = bad;
			fixture.refuse(request, ErrorCode::out_of_range, "cell_size", bad);
		}
	}
}

TEST_CASE_TEMPLATE("domain errors: invalid values of darts_each are rejected", Real, float, double) {
	Fixture<Real> fixture;
	DomainRequest request = fixture.good;
	request.method = DomainMethod::naive;
	for (const double bad : {nan_value, inf, -inf}) {
		request.darts_each = bad;
		fixture.refuse(request, ErrorCode::not_finite, "darts_each", bad);
	}
	for (const double bad : {std::nextafter(1.0, 0.0), 0.0, -5.0, std::nextafter(1e6, inf), 1e300}) {
		request.darts_each = bad;
		fixture.refuse(request, ErrorCode::out_of_range, "darts_each", bad);
	}
}

TEST_CASE_TEMPLATE(
		"domain errors: if any allocation fails, the call reports it and has no effect", Real, float, double) {
	Fixture<Real> fixture;
	for (const Method &method : methods) {
		CAPTURE(method.name);
		for (const bool fill : {false, true}) {
			CAPTURE(fill);
			DomainRequest request = fixture.good;
			request.method = method.method;
			request.toroidal = true; // On a torus, the sampler also stores periodic images.
			bool is_finished = false;
			std::size_t failures = 0;
			for (std::size_t allowed = 0; !is_finished; ++allowed) {
				DomainSampler<Real> sampler;
				Status status;
				{
					const AllocationLimit limit(allowed);
					status = fill ? sampler.fill(request) : sampler.sample(request, fixture.points);
				}
				is_finished = status.ok();
				if (!is_finished) {
					++failures;
					CHECK(status.code == ErrorCode::out_of_memory);
					CHECK(fixture.points == fixture.before);
					REQUIRE(sampler.fill(fixture.good).ok());
				}
			}
			CHECK(failures > 0);
			fixture.points = fixture.before;
		}
	}
}

#ifdef THICKET_LIMITS_MEMORY

namespace {

/// Returns the address space that this process uses, in bytes.
rlim_t address_space() {
	std::ifstream statm("/proc/self/statm");
	std::size_t pages = 0;
	statm >> pages;
	return static_cast<rlim_t>(pages) * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
}

constexpr int limits_do_not_hold = 2;

/// Limits this process to 64 MiB more than it uses now, and checks that a huge domain is rejected.
/// Returns the exit code for the child process. Some emulators accept a limit but do not enforce
/// it, which `limits_do_not_hold` reports.
template <typename Real>
int refuses_in_little_memory(DomainMethod method) {
	const rlim_t limit = address_space() + (rlim_t{64} << 20);
	const rlimit limits{limit, limit};
	DomainSampler<Real> sampler;
	std::vector<glm::vec<2, Real>> points(3, glm::vec<2, Real>(7));
	const std::vector<glm::vec<2, Real>> before = points;
	DomainRequest huge = request_of({"", {20'000.0, 20'000.0}, 1.0, false}, method, 3);
	if (setrlimit(RLIMIT_AS, &limits) != 0) {
		return EXIT_FAILURE;
	}
	if (void *volatile too_much = std::malloc(std::size_t{1} << 30)) {
		std::free(too_much);
		return limits_do_not_hold;
	}
	const bool is_rejected = sampler.sample(huge, points).code == ErrorCode::out_of_memory && points == before &&
			sampler.fill(huge).code == ErrorCode::out_of_memory;
	// The failed call has freed its memory, so a small domain fits.
	huge.size = {100.0, 100.0};
	const bool is_usable = sampler.sample(huge, points).ok() && points.size() > 5000;
	return is_rejected && is_usable ? EXIT_SUCCESS : EXIT_FAILURE;
}

} // namespace

TEST_CASE_TEMPLATE("domain errors: a domain that is larger than memory is rejected", Real, float, double) {
	for (const Method &method : methods) {
		CAPTURE(method.name);
		std::fflush(nullptr);
		const pid_t child = fork();
		REQUIRE(child >= 0);
		if (child == 0) {
			alarm(60);
			_exit(refuses_in_little_memory<Real>(method.method));
		}
		int status = 0;
		REQUIRE(waitpid(child, &status, 0) == child);
		REQUIRE(WIFEXITED(status));
		if (WEXITSTATUS(status) == limits_do_not_hold) {
			MESSAGE("not tested: memory cannot be limited here");
			return;
		}
		CHECK(WEXITSTATUS(status) == EXIT_SUCCESS);
	}
}

#endif
