// Tests that heightmap patches in batches are bit-identical to single patches, on every instruction
// set.

#include "core/terrain/inner_patches.hpp"
#include "core/terrain/smooth_patch.hpp"
#include "tests/bench/common/simd_targets.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

using namespace thicket;

namespace {

constexpr int side = 40;

/// Returns the height and normal of a single patch, computed as in Heightfield.
std::array<float, 4> single_patch(
		const std::uint16_t *first, glm::dvec2 fraction, const InnerPatches::Heights &heights) {
	const SmoothPatch patch = smooth_patch<false>(inner_line, inner_line, fraction,
			[first](int i, int j) { return static_cast<double>(first[j * side + i]); });
	const double gradient_x = patch.gradient.x * heights.scale * heights.posts_per_meter.x;
	const double gradient_y = patch.gradient.y * heights.scale * heights.posts_per_meter.y;
	const double to_unit = 1.0 / std::sqrt(gradient_x * gradient_x + gradient_y * gradient_y + 1.0);
	return {static_cast<float>(heights.base + patch.height * heights.scale), static_cast<float>(-gradient_x * to_unit),
			static_cast<float>(to_unit), static_cast<float>(-gradient_y * to_unit)};
}

/// Returns random height samples with high and low plateaus, cliffs and rough ground.
std::vector<std::uint16_t> posts_of(std::mt19937 &random) {
	std::vector<std::uint16_t> posts(side * side);
	for (std::uint16_t &post : posts) {
		const auto word = static_cast<std::uint32_t>(random());
		post = static_cast<std::uint16_t>(word % 3 == 0 ? 65535 : word % 3 == 1 ? 100 : word >> 16);
	}
	return posts;
}

} // namespace

TEST_CASE("inner patches: batches are bit-identical to single patches, on every instruction set") {
	for (const bench::SimdTarget &target : bench::simd_targets()) {
		CAPTURE(target.name);
		const bench::ForcedTarget forced(target);
		std::mt19937 random(7);
		std::uniform_real_distribution<double> fraction(0.0, 1.0);
		for (int round = 0; round < 60; ++round) {
			const std::vector<std::uint16_t> posts = posts_of(random);
			const InnerPatches::Heights heights{fraction(random) * 1e3 - 500.0, fraction(random) * 0.1,
					{0.01 + fraction(random), 0.01 + 10.0 * fraction(random)}};
			InnerPatches patches;
			const std::size_t count = 1 + random() % InnerPatches::capacity;
			std::vector<std::array<float, 4>> expected;
			while (patches.count < count) {
				const auto column = static_cast<int>(1 + random() % (side - 3));
				const auto row = static_cast<int>(1 + random() % (side - 3));
				REQUIRE(is_inner_patch({side, side}, {column, row}));
				const std::uint16_t *first = posts.data() + row * side + column;
				const glm::dvec2 patch_fraction =
						random() % 8 == 0 ? glm::dvec2(0.0) : glm::dvec2(fraction(random), fraction(random));
				expected.push_back(single_patch(first, patch_fraction, heights));
				patches.add(first, side, patch_fraction, expected.size());
			}
			patches.compute(heights);
			for (std::size_t i = 0; i < count; ++i) {
				const std::array<float, 4> actual{
						patches.height[i], patches.normal_x[i], patches.normal_y[i], patches.normal_z[i]};
				REQUIRE(std::memcmp(expected[i].data(), actual.data(), sizeof actual) == 0);
				REQUIRE(patches.indices[i] == i + 1);
			}
		}
	}
}

TEST_CASE("inner patches: vectors compute the patches, and write beyond the last patch") {
	const std::vector<std::uint16_t> posts(16, 3);
	InnerPatches patches;
	patches.height.fill(-1.0f);
	patches.add(posts.data() + 5, 4, {0.5, 0.5}, 0);
	patches.compute({});
	CHECK(patches.height[0] == 3.0f);
	CHECK(patches.height[1] == 0.0f); // Scalar code would leave it unchanged.
}
