#pragma once

#include "core/rules/painted_mask.hpp"

#include <doctest/doctest.h>

#include <random>
#include <vector>

/// Returns the density at one position.
inline float density(const thicket::DensityField &field, glm::dvec2 position) {
	float value = -1.0f;
	REQUIRE(field.sample({&position, 1}, {&value, 1}).ok());
	return value;
}

/// Returns the density that an 8-bit pixel value represents.
inline float byte_density(int value) { return static_cast<float>(value / 255.0); }

inline thicket::PaintedMask mask_of(double pixel_size, double background) {
	thicket::PaintedMask mask;
	REQUIRE(mask.reset(pixel_size, background).ok());
	return mask;
}

inline std::vector<std::uint8_t> read(const thicket::PaintedMask &mask, const thicket::PixelRect &region) {
	std::vector<std::uint8_t> pixels;
	REQUIRE(mask.read(region, pixels).ok());
	return pixels;
}

inline int pixel(const thicket::PaintedMask &mask, int x, int y) { return read(mask, {{x, y}, {x + 1, y + 1}})[0]; }

inline thicket::Rect write(
		thicket::PaintedMask &r_mask, const thicket::PixelRect &region, const std::vector<std::uint8_t> &pixels) {
	thicket::Rect changed{{1.0, 2.0}, {3.0, 4.0}};
	REQUIRE(r_mask.write(region, pixels, changed).ok());
	return changed;
}

inline thicket::Rect paint(thicket::PaintedMask &r_mask, const thicket::Brush &brush) {
	thicket::Rect changed{{1.0, 2.0}, {3.0, 4.0}};
	REQUIRE(r_mask.paint(brush, changed).ok());
	return changed;
}

/// Returns a mask with random pixels around the origin, from -70 to 70 on both axes.
inline thicket::PaintedMask noisy_mask(double pixel_size, unsigned seed) {
	thicket::PaintedMask mask = mask_of(pixel_size, 0.5);
	std::mt19937 random(seed);
	std::vector<std::uint8_t> pixels(140 * 140);
	for (std::uint8_t &value : pixels) {
		value = static_cast<std::uint8_t>(random());
	}
	write(mask, {{-70, -70}, {70, 70}}, pixels);
	return mask;
}
