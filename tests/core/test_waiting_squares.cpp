// Some cells have many waiting squares. These tests cover every way in which squares are stored, on
// each instruction set.

#include "core/sampling/block_sampler.hpp"
#include "tests/bench/common/simd_targets.hpp"

#include <doctest/doctest.h>

#include <algorithm>

using namespace thicket;

TEST_CASE("waiting squares: some cells need a second slot, and some cells need more") {
	const CellRect block{{0, 0}, {400, 400}};
	for (const bench::SimdTarget &target : bench::simd_targets()) {
		CAPTURE(target.name);
		const bench::ForcedTarget forced(target);
		BlockSampler sampler;
		sampler.prepare({.seed = 7, .radius = 1.0}, [](std::uint32_t, std::uint32_t, TimeKey) { return 0u; });
		REQUIRE(sampler.resolve(block, nullptr) == ResolveResult::done);
		const LevelGrid &grid = sampler.finest();
		CHECK(std::ranges::count(grid.waiting, 0u) > 10'000);
		CHECK(std::ranges::any_of(grid.waiting, [](std::uint32_t slot) {
			return slot < WaitingSquares::has_more && (slot & WaitingSquares::has_second) != 0;
		}));
		CHECK(std::ranges::any_of(grid.waiting, [](std::uint32_t slot) { return slot >= WaitingSquares::has_more; }));
	}
}
