#pragma once

#include "allocation_count.hpp"
#include "core/base/status.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <string>

namespace thicket::test {

/// Runs a job again and again, with memory that ends at its first request, its second, and so on, until it passes: once with
/// all requests after that one failing, once with that one alone.
///
/// `prepare()` makes what a job works on, `run(prepared)` is the job and gives a Status, `check_unchanged(prepared)` is called
/// after a failure and says that all is as it was, and then the same job has to succeed; `check_done(prepared)` is called
/// after a success. A failure has to be out_of_memory and to name `asked_for`.
template <typename Prepare, typename Run, typename Unchanged, typename Done>
void fail_every_request(const std::string &asked_for, const Prepare &prepare, const Run &run,
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
				REQUIRE(status.property == asked_for);
				check_unchanged(prepared);
				REQUIRE(run(prepared).ok());
			}
			check_done(prepared);
		}
		CHECK(failures > 0);
	}
}

} // namespace thicket::test
