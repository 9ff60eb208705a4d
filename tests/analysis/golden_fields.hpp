#pragma once

#include "core/base/word_hash.hpp"
#include "core/rules/clump_noise.hpp"
#include "core/rules/curve_table.hpp"
#include "core/rules/image_mask.hpp"
#include "core/rules/painted_mask.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace thicket::analysis {

/// Digests of the densities that a layer's rules sample: a curve, an image mask, a painted mask
/// after dabs in every brush mode, and clump noise on the plane and in space. `require(status)` must end the program if
/// `status` is an error.
template <typename Require>
std::vector<std::pair<std::string, std::uint64_t>> field_digests(Require require) {
	constexpr std::uint32_t steps = 4000;
	std::vector<glm::dvec2> positions;
	for (std::uint32_t i = 0; i < steps; ++i) {
		positions.emplace_back(i % 63 * 1.37 - 40.0, i / 63 * 1.61 - 50.0);
	}
	std::vector<float> densities(positions.size());
	const auto digest_of = [&](const DensityField &field) {
		require(field.sample(positions, densities));
		WordHash hash;
		hash.add_all(std::span<const float>(densities));
		return hash.value();
	};

	WordHash curve_hash;
	CurveTable curve;
	require(curve.set(-33.3, 71.7, std::vector<float>{0.1f, 0.9f, 0.3f, 0.3f, 0.77f}));
	for (std::uint32_t i = 0; i < steps; ++i) {
		curve_hash.add(curve.at(i * 0.03 - 40.0));
	}

	ImageMask image;
	std::vector<std::uint8_t> pixels;
	for (std::uint32_t i = 0; i < 11 * 7; ++i) {
		pixels.push_back(static_cast<std::uint8_t>(i * i * 37));
	}
	require(image.set({11, 7}, pixels, {{-31.7, -20.3}, {29.9, 33.1}}, MaskEdge::repeat));

	PaintedMask mask;
	Rect changed;
	require(mask.reset(0.7, 0.3));
	for (std::uint32_t i = 0; i < 60; ++i) {
		require(mask.paint({.mode = static_cast<Brush::Mode>(i % 3),
								   .center = {i * 7 % 60 - 30.0, i * 11 % 60 - 30.3},
								   .radius = 1.3 + i % 17,
								   .strength = i % 10 / 9.0,
								   .hardness = i % 7 / 6.0},
				changed));
	}

	WordHash clump_hash;
	for (const glm::dvec2 origin : {glm::dvec2(0.0), glm::dvec2(-1e9, 5e6)}) {
		ClumpNoise clumps;
		clumps.set({.size = 7.3, .coverage = 0.4, .softness = 0.8}, 17);
		for (const glm::dvec2 position : positions) {
			clump_hash.add(clumps.at(origin + position));
		}
	}
	WordHash space_hash;
	for (const double height : {0.0, -1e9, 5e6}) {
		ClumpNoise clumps;
		clumps.set({.size = 7.3, .coverage = 0.4, .softness = 0.8}, 17);
		for (const glm::dvec2 position : positions) {
			space_hash.add(clumps.at(glm::dvec3(position.x, height + 0.7 * position.x, position.y)));
		}
	}
	return {{"curve", curve_hash.value()}, {"image mask", digest_of(image)}, {"painted mask", digest_of(mask)},
			{"clumps", clump_hash.value()}, {"clumps in space", space_hash.value()}};
}

} // namespace thicket::analysis
