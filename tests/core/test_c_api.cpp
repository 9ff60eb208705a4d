// Tests that the C library returns an error and throws no exception, whichever allocation fails.
// tests/core/test_c_api.py contains its other tests.

#include "allocation_count.hpp"
#include "core/c_api/thicket.h"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace {

using Sampler = std::unique_ptr<thicket_sampler, decltype(&thicket_sampler_free)>;

constexpr thicket_set some_set{.seed = 1, .radius = 1.0, .levels = 2, .layer = 0};
constexpr thicket_rect some_rect{0.0, 0.0, 40.0, 30.0};

/// Runs `work(sampler)` repeatedly: its first allocation fails, then its second, and so on, until
/// it succeeds.
template <typename Work>
void fail_every_request(bool sampled_before, const Work &work) {
	std::size_t failures = 0;
	for (std::size_t allowed = 0; allowed < 10000; ++allowed) {
		CAPTURE(allowed);
		const Sampler sampler(thicket_sampler_new(), thicket_sampler_free);
		REQUIRE(sampler);
		if (sampled_before) {
			REQUIRE(thicket_sample(sampler.get(), &some_set, &some_rect, nullptr, nullptr) == THICKET_OK);
		}
		const std::uint64_t before = thicket_count(sampler.get());
		thicket_code code = THICKET_OK;
		{
			const AllocationLimit limit(allowed, AllocationLimit::Fails::all_later);
			code = work(sampler.get());
		}
		if (code == THICKET_OK) {
			CHECK(failures > 0);
			return;
		}
		++failures;
		REQUIRE(code == THICKET_OUT_OF_MEMORY);
		const std::string message = thicket_message(sampler.get());
		REQUIRE(message == "there is not enough memory for an error message");
		CHECK(thicket_count(sampler.get()) == (sampled_before ? before : 0));
		REQUIRE(work(sampler.get()) == THICKET_OK);
	}
	FAIL("the call must succeed within the tested allocation limits");
}

} // namespace

TEST_CASE("the C library returns an error if memory runs out") {
	fail_every_request(false,
			[](thicket_sampler *sampler) { return thicket_sample(sampler, &some_set, &some_rect, nullptr, nullptr); });
	fail_every_request(false, [](thicket_sampler *sampler) {
		const thicket_domain domain{.size_x = 30.0,
				.size_y = 20.0,
				.radius = 1.0,
				.cell_size = 0.0,
				.darts_each = 0.0,
				.seed = 2,
				.method = THICKET_HIERARCHICAL,
				.toroidal = 0,
				.single_precision = 0};
		return thicket_sample_domain(sampler, &domain, nullptr, nullptr);
	});
	fail_every_request(true, [](thicket_sampler *sampler) {
		std::uint64_t positions = 0;
		return thicket_digest(sampler, &positions, nullptr);
	});
}

TEST_CASE("creating a sampler in C fails if memory runs out") {
	for (std::size_t allowed = 0; allowed < 100; ++allowed) {
		const AllocationLimit limit(allowed, AllocationLimit::Fails::all_later);
		const Sampler sampler(thicket_sampler_new(), thicket_sampler_free);
		if (sampler) {
			CHECK(allowed > 0);
			return;
		}
	}
	FAIL("creating a sampler must succeed within 100 allocations");
}

TEST_CASE("if memory runs out, the C library's error names the property") {
	const Sampler sampler(thicket_sampler_new(), thicket_sampler_free);
	REQUIRE(sampler);
	{
		// Only the first allocation fails, which is for the points.
		const AllocationLimit limit(0, AllocationLimit::Fails::one);
		REQUIRE(thicket_sample(sampler.get(), &some_set, &some_rect, nullptr, nullptr) == THICKET_OUT_OF_MEMORY);
	}
	const std::string message = thicket_message(sampler.get());
	CHECK(message.starts_with("rect needs more memory than is available, got "));
}
