// Tests the statistics that DomainSampler reports. The paper's figures depend on them.

#include "domain_cases.hpp"

using namespace thicket;
using namespace thicket::domain_cases;

namespace {

template <typename Real>
DomainStats stats_of(const DomainRequest &request) {
	DomainSampler<Real> sampler;
	std::vector<glm::vec<2, Real>> points;
	const Status status = sampler.sample(request, points);
	REQUIRE_MESSAGE(status.ok(), describe(status));
	CHECK(sampler.stats().points == points.size());
	return sampler.stats();
}

DomainRequest large(DomainMethod method, bool toroidal) { // Returns a request for about 15,000 points.
	return request_of({"", {150.0, 150.0}, 1.0, toroidal}, method, 21);
}

double per_point(const DomainStats &stats, std::uint64_t count) {
	return static_cast<double>(count) / static_cast<double>(stats.points);
}

} // namespace

TEST_CASE_TEMPLATE("domain: nine to ten squares are created for each accepted dart", Real, float, double) {
	for (const Method &method : maximal_methods) {
		CAPTURE(method.name);
		for (const bool torus : {false, true}) {
			CAPTURE(torus);
			const DomainStats stats = stats_of<Real>(large(method.method, torus));
			REQUIRE(stats.points >= 10'000);
			const double squares = per_point(stats, stats.squares);
			CAPTURE(squares);
			CHECK(squares >= 9.0);
			CHECK(squares <= 10.0);
		}
	}
}

TEST_CASE("domain: the number of squares falls exponentially with the level, as the paper states") {
	for (const Method &method : maximal_methods) {
		CAPTURE(method.name);
		const DomainStats stats = stats_of<double>(large(method.method, true));
		std::uint64_t total = 0;
		for (std::size_t level = 0; level < stats.squares_by_level.size(); ++level) {
			CAPTURE(level);
			const std::uint64_t created = stats.squares_by_level[level];
			total += created;
			// After the second level, each level has at most two thirds of the squares of the one before.
			if (level > 2 && created > 100) {
				CHECK(3 * created < 2 * stats.squares_by_level[level - 1]);
			}
		}
		CHECK(stats.squares_by_level.size() == stats.levels);
		CHECK(total == stats.squares);
	}
}

TEST_CASE_TEMPLATE("domain: counts of squares, choices and darts are consistent", Real, float, double) {
	for (const Method &method : maximal_methods) {
		CAPTURE(method.name);
		for (const Shape &shape : shapes) {
			CAPTURE(shape.name);
			const DomainStats stats = stats_of<Real>(request_of(shape, method.method, 22));
			// Every created square is selected exactly once, and no selection fails.
			CHECK(stats.selections == stats.squares);
			CHECK(stats.list_checks >= stats.selections);
			CHECK(stats.darts <= stats.selections);
			CHECK(stats.darts >= stats.points);
			CHECK(stats.discarded <= stats.darts - stats.points);
			CHECK(stats.levels >= 1);
			CHECK(stats.levels <= 33); // The paper observed no square beyond level 32.
			CHECK(stats.cell_size > 0.0);
		}
	}
}

TEST_CASE_TEMPLATE("domain: a choice of a square checks fewer than three lists on average", Real, float, double) {
	for (const Method &method : maximal_methods) {
		CAPTURE(method.name);
		const DomainStats stats = stats_of<Real>(large(method.method, true));
		CHECK(stats.list_checks < 3 * stats.selections);
	}
}

TEST_CASE_TEMPLATE("domain: naive dart throwing counts its darts", Real, float, double) {
	DomainRequest request = request_of({"", {20.0, 10.0}, 1.0, true}, DomainMethod::naive, 23);
	for (const double darts_each : {1.0, 7.5, 100.0}) {
		request.darts_each = darts_each;
		const DomainStats stats = stats_of<Real>(request);
		// 29 x 15 base squares: ceil(20 sqrt 2) x ceil(10 sqrt 2).
		CHECK(stats.darts == static_cast<std::uint64_t>(darts_each * 29 * 15));
		CHECK(stats.squares == 0);
		CHECK(stats.selections == 0);
		CHECK(stats.list_checks == 0);
		CHECK(stats.levels == 0);
		CHECK(stats.square_bytes == 0);
	}
}

TEST_CASE_TEMPLATE(
		"domain: the workspace is reported, and smallest for the wavefront, as the paper states", Real, float, double) {
	const auto bytes = [](DomainMethod method) {
		const DomainStats stats = stats_of<Real>(request_of({"", {200.0, 200.0}, 1.0, false}, method, 24));
		CHECK(stats.grid_bytes > 0);
		CHECK(stats.square_bytes > 0);
		CHECK(stats.workspace_bytes() == stats.grid_bytes + stats.square_bytes);
		return per_point(stats, stats.workspace_bytes());
	};
	const double standard = bytes(DomainMethod::hierarchical);
	const double accumulator = bytes(DomainMethod::accumulator);
	const double wavefront = bytes(DomainMethod::wavefront);
	// In bytes per point: at least a copy of the point, and at most about the 416 bytes that the
	// paper states for double precision.
	const double point = 2.0 * sizeof(Real);
	CHECK(wavefront > point);
	CHECK(wavefront < standard);
	CHECK(standard < accumulator);
	CHECK(accumulator < 450.0);
}

TEST_CASE_TEMPLATE("domain: the width of cells is the requested one, in whole base squares", Real, float, double) {
	for (const Method &method : maximal_methods) {
		CAPTURE(method.name);
		for (const double cell_size : {0.1, 0.7, 1.0, 5.0, 20.0}) {
			CAPTURE(cell_size);
			DomainRequest request = large(method.method, false);
			request.cell_size = cell_size;
			const DomainStats stats = stats_of<Real>(request);
			CHECK(stats.cell_size >= cell_size);
			CHECK(stats.cell_size < cell_size + std::sqrt(0.5) + 1e-9);
		}
	}
}

TEST_CASE_TEMPLATE("domain: a rejected call keeps the statistics of the previous call", Real, float, double) {
	DomainSampler<Real> sampler;
	std::vector<glm::vec<2, Real>> points;
	REQUIRE(sampler.sample(large(DomainMethod::wavefront, true), points).ok());
	const DomainStats before = sampler.stats();
	DomainRequest bad = large(DomainMethod::wavefront, true);
	bad.radius = -1.0;
	CHECK(!sampler.sample(bad, points).ok());
	CHECK(sampler.stats().points == before.points);
	CHECK(sampler.stats().squares == before.squares);
	CHECK(sampler.stats().grid_bytes == before.grid_bytes);
}
