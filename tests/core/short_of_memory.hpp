#pragma once

#include "allocation_count.hpp"
#include "core/base/status.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <string>

namespace thicket::test {

/// Repeats a job with an injected allocation failure: first its first allocation fails, then its
/// second, and so on, until the job succeeds. Each allocation fails once together with all later
/// ones, and once alone.
///
/// `prepare()` creates the job's data, and `run(prepared)` executes the job and returns a Status.
/// After each failure, `check_unchanged(prepared)` must verify that the data has not changed, and
/// the job must then succeed on the same data. `check_done(prepared)` must verify the result of
/// each success. A failure must have the code out_of_memory and the property `property`.
template <typename Prepare, typename Run, typename Unchanged, typename Done>
void fail_every_request(const std::string &property, const Prepare &prepare, const Run &run,
		const Unchanged &check_unchanged, const Done &check_done) {
	for (const auto fails : {AllocationLimit::Fails::all_later, AllocationLimit::Fails::one}) {
		std::size_t failures = 0;
		bool reached = true;
		for (std::size_t allowed = 0; reached; ++allowed) {
			CAPTURE(allowed);
			auto prepared = prepare();
			Status status;
			{
				const AllocationLimit limit(allowed, fails);
				status = run(prepared);
				reached = limit.reached();
			}
			if (!status.ok()) {
				++failures;
				REQUIRE(reached);
				REQUIRE(status.code == ErrorCode::out_of_memory);
				REQUIRE(status.property == property);
				check_unchanged(prepared);
				REQUIRE(run(prepared).ok());
			}
			check_done(prepared);
		}
		CHECK(failures > 0);
	}
}

} // namespace thicket::test
