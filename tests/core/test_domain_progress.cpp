// Tests the progress reports of DomainSampler calls, and their cancellation from a report and from
// another thread.

#include "domain_cases.hpp"
#include "processor_time.hpp"

#include <atomic>
#include <chrono>
#include <thread>

using namespace thicket;
using namespace thicket::domain_cases;

namespace {

/// Records progress reports and whether they are consistent.
struct Watch {
	std::uint64_t calls = 0;
	std::uint64_t before_first_point = 0; ///< Reports before the first point.
	double first = 2.0;
	double last = 0.0;
	double widest_step = 0.0;
	std::uint64_t points = 0;
	bool in_order = true; ///< Fractions are at most 1, and neither they nor the points ever decrease.

	void operator()(double fraction, std::uint64_t point_count) {
		++calls;
		before_first_point += point_count == 0 ? 1 : 0;
		first = std::min(first, fraction);
		in_order = in_order && fraction >= last && fraction <= 1.0 && point_count >= points;
		widest_step = std::max(widest_step, fraction - last);
		last = fraction;
		points = point_count;
	}
};

DomainRequest request_for(DomainMethod method, glm::dvec2 radii, bool toroidal = false) {
	DomainRequest request = request_of({"", radii, 1.0, toroidal}, method, 31);
	request.darts_each = 3.0;
	return request;
}

/// Returns a request for more than ten million points, which takes seconds with every method.
DomainRequest huge(DomainMethod method) { return request_for(method, {4000.0, 4000.0}); }

/// A sampler and the valid result of an earlier call. A canceled call must leave the result
/// unchanged.
template <typename Real>
struct Fixture {
	DomainRequest good = request_for(DomainMethod::hierarchical, {20.0, 12.0});
	DomainSampler<Real> sampler;
	std::vector<glm::vec<2, Real>> points;
	std::vector<glm::vec<2, Real>> before;

	Fixture() {
		REQUIRE(sampler.sample(good, points).ok());
		before = points;
	}

	void check_cancelled(const Status &status) {
		CHECK(status.code == ErrorCode::cancelled);
		CHECK(points == before);
		std::vector<glm::vec<2, Real>> repeated;
		REQUIRE(sampler.sample(good, repeated).ok());
		CHECK(repeated == before);
	}
};

} // namespace

TEST_CASE_TEMPLATE("domain progress: the fraction begins low, never falls, grows in small steps and ends at one", Real,
		float, double) {
	for (const Method &method : methods) {
		CAPTURE(method.name);
		for (const bool torus : {false, true}) {
			CAPTURE(torus);
			Watch watch;
			DomainSampler<Real> sampler;
			const Status status = sampler.fill(request_for(method.method, {300.0, 200.0}, torus),
					{.report = [&](double fraction, std::uint64_t points) { watch(fraction, points); }});
			REQUIRE(status.ok());
			CHECK(watch.in_order);
			CHECK(watch.first < 0.1);
			CHECK(watch.last > 0.95);
			CHECK(watch.widest_step < 0.1);
			CHECK(watch.points <= sampler.stats().points);
			CHECK(static_cast<double>(watch.points) > 0.9 * static_cast<double>(sampler.stats().points));
			CHECK(watch.calls > sampler.stats().points / 10'000);
		}
	}
}

TEST_CASE_TEMPLATE(
		"domain progress: a fraction, even where the area does not predict the number of points", Real, float, double) {
	for (const Method &method : methods) {
		CAPTURE(method.name);
		for (const Shape &shape : shapes) {
			CAPTURE(shape.name);
			Watch watch;
			const auto report = [&](double fraction, std::uint64_t points) {
				watch(fraction, points);
			};
			DomainSampler<Real> sampler;
			REQUIRE(sampler.fill(request_of(shape, method.method, 32), {.report = report}).ok());
			CHECK(watch.in_order);
			CHECK(watch.points <= sampler.stats().points);
		}
	}
}

TEST_CASE_TEMPLATE("domain progress: reports also arrive before the first point", Real, float, double) {
	for (const DomainMethod method : {DomainMethod::hierarchical, DomainMethod::accumulator}) {
		std::atomic<bool> cancel{false};
		Watch watch;
		const auto report = [&](double fraction, std::uint64_t points) {
			watch(fraction, points);
			cancel = points > 0;
		};
		DomainSampler<Real> sampler;
		CHECK(sampler.fill(huge(method), {.cancel = &cancel, .report = report}).code == ErrorCode::cancelled);
		CHECK(watch.before_first_point >= 3);
		CHECK(watch.points < 1'000'000);
	}
}

TEST_CASE_TEMPLATE(
		"domain cancel: a flag that is set before the call or by a report ends the call", Real, float, double) {
	Fixture<Real> fixture;
	for (const Method &method : methods) {
		CAPTURE(method.name);
		std::atomic<bool> cancel{true};
		fixture.check_cancelled(
				fixture.sampler.sample(huge(method.method), fixture.points, {.cancel = &cancel, .report = {}}));

		for (const double enough : {0.0, 0.3, 0.9}) {
			CAPTURE(enough);
			cancel = false;
			Watch watch;
			const auto report = [&](double fraction, std::uint64_t points) {
				watch(fraction, points);
				cancel = fraction >= enough;
			};
			const DomainRequest request = request_for(method.method, {200.0, 200.0});
			fixture.check_cancelled(
					fixture.sampler.sample(request, fixture.points, {.cancel = &cancel, .report = report}));
			// Sampling must stop before the end.
			CHECK(watch.last < enough + 0.1);
		}
	}
	// A flag that is never set has no effect.
	const std::atomic<bool> cancel_flag{false};
	REQUIRE(fixture.sampler.sample(fixture.good, fixture.points, {.cancel = &cancel_flag, .report = {}}).ok());
	CHECK(fixture.points == fixture.before);
}

TEST_CASE_TEMPLATE("domain cancel: a flag that another thread sets ends the call", Real, float, double) {
	Fixture<Real> fixture;
	for (const Method &method : methods) {
		CAPTURE(method.name);
		std::atomic<bool> cancel{false};
		Status status;
		std::thread worker([&] {
			status = fixture.sampler.sample(huge(method.method), fixture.points, {.cancel = &cancel, .report = {}});
		});
		std::this_thread::sleep_for(std::chrono::milliseconds(150));
		const double start = test::processor_seconds();
		cancel = true;
		worker.join();
		// The documented limit is 50 ms, but builds with sanitizers take longer.
		CHECK(test::processor_seconds() - start < 1.0);
		fixture.check_cancelled(status);
	}
}

TEST_CASE_TEMPLATE("domain cancel: a fill keeps all previous points or none", Real, float, double) {
	for (const Method &method : methods) {
		CAPTURE(method.name);
		DomainSampler<Real> sampler;
		REQUIRE(sampler.fill(request_for(method.method, {20.0, 12.0})).ok());
		const std::uint64_t before = sampler.stats().points;
		std::atomic<bool> cancel{false};
		const auto report = [&](double, std::uint64_t points) {
			cancel = points > 1000;
		};
		const DomainRequest request = request_for(method.method, {200.0, 200.0});
		CHECK(sampler.fill(request, {.cancel = &cancel, .report = report}).code == ErrorCode::cancelled);
		std::uint64_t point_count = 0;
		sampler.visit([&](std::span<const Real> x, std::span<const Real>) { point_count += x.size(); });
		CHECK((point_count == 0 || point_count == before));
	}
}
