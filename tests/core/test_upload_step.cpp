#include "core/drawing/upload_step.hpp"

#include <doctest/doctest.h>

#include <cstddef>

using namespace thicket;

namespace {

/// Returns the number of visuals that one step uploads if each has this many instances.
std::size_t visuals_in_step(std::size_t instances) {
	UploadStep step;
	std::size_t count = 0;
	for (; !step.is_full(); ++count) {
		step.add(instances);
	}
	return count;
}

} // namespace

TEST_CASE("upload step: a step uploads at least one visual, and otherwise limits both instances and visuals") {
	CHECK(visuals_in_step(1'000'000) == 1);
	CHECK(visuals_in_step(4096) == 1);
	CHECK(visuals_in_step(4095) == 2);
	CHECK(visuals_in_step(1500) == 3);
	CHECK(visuals_in_step(100) == 4);
	CHECK(visuals_in_step(0) == 4);
}
