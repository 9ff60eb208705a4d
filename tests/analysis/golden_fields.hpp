#pragma once

#include "core/base/planet.hpp"
#include "core/base/word_hash.hpp"
#include "core/rules/biome_map.hpp"
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

/// Digests of masks and biomes on a planet, toward its poles, its equator, the seam of images, the edges
/// between the faces of painted masks, and everything between.
template <typename Require>
std::vector<std::pair<std::string, std::uint64_t>> planet_field_digests(const ImageMask &image, Require require) {
	const Planet planet{{40.0, -30.0, 20.0}, 300.0};
	std::vector<glm::dvec3> directions;
	for (int i = 0; i < 17 * 17 * 17; ++i) {
		if (const glm::dvec3 direction(i % 17 - 8, i / 17 % 17 - 8, i / 289 - 8); direction != glm::dvec3(0.0)) {
			directions.push_back(direction);
			directions.push_back(direction + glm::dvec3(0.13, 0.21, -0.34));
		}
	}
	PaintedMask mask;
	require(mask.reset(1.7, 0.3));
	for (std::uint32_t i = 0; i < 150; ++i) {
		bool is_changed = false;
		require(mask.paint_on(planet.radius, directions[i * 61],
				{.mode = static_cast<Brush::Mode>(i % 3),
						.radius = 4.3 + i % 47,
						.strength = i % 10 / 9.0,
						.hardness = i % 7 / 6.0},
				is_changed));
	}
	std::vector<std::uint8_t> pixels;
	for (std::uint32_t i = 0; i < 24 * 12; ++i) {
		pixels.push_back(static_cast<std::uint8_t>(i * i * 37 % 5));
	}
	BiomeMap biomes;
	require(biomes.set({24, 12}, pixels, {{0.0, 0.0}, {1.0, 1.0}}, BiomeEdge::nothing,
			{.width = 9.0, .noise = 14.0, .noise_size = 33.0, .seed = 3}));

	WordHash image_hash;
	WordHash mask_hash;
	WordHash biome_hash;
	for (const glm::dvec3 &direction : directions) {
		image_hash.add(image.toward(direction));
		const glm::dvec3 at = planet.center + planet.radius * Planet::up(direction);
		const glm::dvec2 position(at.x, at.z);
		const auto height = static_cast<float>(at.y);
		float density = 0.0F;
		require(mask.sample_on(planet, {{&position, 1}, {&height, 1}}, {&density, 1}));
		mask_hash.add(density);
		BiomeTaps taps{};
		biomes.taps_toward(planet.radius, direction, taps);
		for (const std::uint8_t biome : taps) {
			biome_hash.add(std::uint64_t{biome});
		}
	}
	return {{"image mask on a planet", image_hash.value()}, {"painted mask on a planet", mask_hash.value()},
			{"biomes on a planet", biome_hash.value()}};
}

/// Digests of the densities that a layer's rules sample: a curve, an image mask, a painted mask
/// after dabs in every brush mode, clump noise on the plane and in space, and masks and biomes on a
/// planet. `require(status)` must end the program if `status` is an error.
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
	Rect changed_rect;
	require(mask.reset(0.7, 0.3));
	for (std::uint32_t i = 0; i < 60; ++i) {
		require(mask.paint({.mode = static_cast<Brush::Mode>(i % 3),
								   .center = {i * 7 % 60 - 30.0, i * 11 % 60 - 30.3},
								   .radius = 1.3 + i % 17,
								   .strength = i % 10 / 9.0,
								   .hardness = i % 7 / 6.0},
				changed_rect));
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
	std::vector<std::pair<std::string, std::uint64_t>> digests{{"curve", curve_hash.value()},
			{"image mask", digest_of(image)}, {"painted mask", digest_of(mask)}, {"clumps", clump_hash.value()},
			{"clumps in space", space_hash.value()}};
	for (auto &digest : planet_field_digests(image, require)) {
		digests.push_back(std::move(digest));
	}
	return digests;
}

} // namespace thicket::analysis
