#include "core/base/check.hpp"
#include "core/base/status.hpp"
#include "core/streaming/tile_streamer.hpp"

#include <doctest/doctest.h>

#include <limits>

using namespace thicket;

TEST_CASE("statuses: a message names property, allowed range, value and fix") {
	const double max_double = std::numeric_limits<double>::max();
	CHECK(describe(check_range("density", 1.5, 0.0, 1.0)) == "density must be between 0 and 1, got 1.5");
	CHECK(describe(check_range("falloff", -1.0, 0.0, max_double)) == "falloff must be at least 0, got -1");
	CHECK(describe(check_range("count", 1e9, at_most(1 << 20, "entries"), "Remove some")) ==
			"count must be at most 1048576 (entries), got 1000000000. Remove some");
	CHECK(describe(check_range("angle", std::numeric_limits<double>::infinity(), -90.0, 90.0)) ==
			"angle must be finite, between -90 and 90, got inf");
	CHECK(describe(Status::wrong_size("pixels", 3, exactly(4))) == "pixels has the wrong size: it must be 4, got 3");
	CHECK(describe(Status::missing("terrain", "Set one")) == "terrain is missing. Set one");
	CHECK(describe(Status::too_many_points("rect", 6.5e9, 1e8, "Ask for less")) ==
			"rect requires too many points, got 6500000000; at most 100000000 are allowed in one call. Ask for less");
}

TEST_CASE("statuses: the range that is checked is the range that is printed") {
	CHECK(check_range("density", 1.0, 0.0, 1.0).ok());
	CHECK(check_range("density", 0.0, 0.0, 1.0).ok());
	const Status above = check_range("density", 1.0000001, 0.0, 1.0);
	CHECK(above.code == ErrorCode::out_of_range);
	CHECK(above.allowed.min == 0.0);
	CHECK(above.allowed.max == 1.0);
	const Status inverted = check_order("max_height", 5.0, 3.0);
	CHECK(inverted.allowed.min == 5.0);
	CHECK(check_order("max_height", 5.0, inverted.allowed.min).ok());
}

TEST_CASE("statuses: a view distance beyond the tiles names the limit and the fix") {
	const Status status = validate(StreamLayer{.tile_size = 16.0, .view_distance = 1500.0});
	CHECK(describe(status) ==
			"view_distance must be between 0 and 1024 (64 x tile_size), got 1500. Increase tile_size or lower "
			"view_distance");
}
