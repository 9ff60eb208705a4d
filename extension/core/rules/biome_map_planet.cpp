// This file implements biome maps on planets.

#include "core/base/floating_point.hpp"
#include "core/base/tangent_axes.hpp"
#include "core/base/trigonometry.hpp"
#include "core/rules/biome_map.hpp"
#include "core/rules/biome_pixels.hpp"
#include "core/rules/planet_positions.hpp"
#include "core/rules/sphere_image.hpp"

#include <glm/geometric.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace thicket {

namespace {

/// Returns the angle of a cap in degrees.
double degrees_of(double sine) { return angle_degrees(sine, std::sqrt(1.0 - sine * sine)) + angle_rounding; }

} // namespace

/// Returns the distance in meters, on the sphere, from a queried position to the farthest pixel that may
/// affect it.
double BiomeMap::reach_on_planet() const {
	return 1.001 * (std::numbers::sqrt3 * borders_.noise + 0.5 * std::numbers::sqrt2 * borders_.width) + 1e-6;
}

std::uint8_t BiomeMap::pixel_toward(const glm::dvec3 &from_center) const {
	const glm::dvec2 at = sphere_image_position(from_center) * glm::dvec2(size_);
	// Column 0 is next to the last column.
	const int column = at.x < size_.x ? held_index(at.x, size_.x) : 0;
	return pixel(column, held_index(at.y, size_.y));
}

/// Returns the displacement of borders at a position in space, in meters.
glm::dvec3 BiomeMap::bend(const glm::dvec3 &position) const {
	return borders_.noise *
			glm::dvec3(border_offset(position, 0), border_offset(position, 1), border_offset(position, 2));
}

void BiomeMap::taps_toward(double planet_radius, const glm::dvec3 &from_center, BiomeTaps &r_taps) const {
	if (!has_direction(from_center)) {
		r_taps.fill(no_biome);
		return;
	}
	const glm::dvec3 up = Planet::up(from_center);
	if (const BiomeSet nearby_biomes = biomes_toward(planet_radius, {up, 0.0}); std::has_single_bit(nearby_biomes)) {
		// As on the plane, borders are far away.
		r_taps.fill(static_cast<std::uint8_t>(std::countr_zero(nearby_biomes)));
		return;
	}
	const glm::dvec3 position = planet_radius * up;
	const glm::dvec3 bent_position = borders_.noise > 0.0 ? position + bend(position) : position;
	if (borders_.width <= 0.0) {
		// All taps have the same position.
		r_taps.fill(pixel_toward(bent_position));
		return;
	}
	const TangentAxes axes = tangent_axes(up);
	for (std::size_t tap = 0; tap < biome_taps; ++tap) {
		const glm::dvec2 offset = borders_.width * biome_tap_offsets[tap];
		r_taps[tap] = pixel_toward(bent_position + offset.x * axes.along + offset.y * axes.across);
	}
}

std::uint8_t BiomeMap::dominant_toward(double planet_radius, const glm::dvec3 &from_center) const {
	BiomeTaps taps{};
	taps_toward(planet_radius, from_center, taps);
	return dominant_of(taps);
}

BiomeSet BiomeMap::biomes_toward(double planet_radius, const PlanetCap &cap) const {
	const double sine = cap.sine + reach_on_planet() / planet_radius;
	if (!(sine < 1.0)) {
		return biomes_in_blocks({{0, 0}, size_});
	}
	const glm::dvec2 middle = sphere_image_position(cap.middle);
	const double degrees = degrees_of(sine);
	const double top = middle.y * 180.0 - degrees;
	const double bottom = middle.y * 180.0 + degrees;
	const auto row = [this](double from_pole) {
		return held_index(from_pole / 180.0 * size_.y, size_.y);
	};
	const int first_row = row(top);
	const int end_row = row(bottom) + 1;
	const double level = std::sqrt(cap.middle.x * cap.middle.x + cap.middle.z * cap.middle.z);
	const double squared = level * level - sine * sine;
	if (top <= 0.0 || bottom >= 180.0 || !(squared > 0.0)) {
		// The cap contains a pole, and so all columns.
		return biomes_in_blocks({{0, first_row}, {size_.x, end_row}});
	}
	const double half_width = (angle_degrees(sine, std::sqrt(squared)) + angle_rounding) / 360.0;
	const auto column = [this](double part) {
		return held_index(part * size_.x, size_.x);
	};
	const double left = middle.x - half_width;
	const double right = middle.x + half_width;
	BiomeSet result = biomes_in_blocks({{column(left), first_row}, {column(right) + 1, end_row}});
	if (left < 0.0) {
		result |= biomes_in_blocks({{column(left + 1.0), first_row}, {size_.x, end_row}});
	}
	if (right > 1.0) {
		result |= biomes_in_blocks({{0, first_row}, {column(right - 1.0) + 1, end_row}});
	}
	return result;
}

/// Returns a cap that contains every direction affected by these pixels.
PlanetCap BiomeMap::cap_reached_from(double planet_radius, const Pixels &pixels) const {
	const glm::dvec2 turns_per_pixel(1.0 / size_.x, 0.5 / size_.y);
	const glm::dvec2 middle = 0.5 * glm::dvec2(pixels.min + pixels.max) * turns_per_pixel;
	const glm::dvec2 half = 0.5 * glm::dvec2(pixels.max - pixels.min) * turns_per_pixel;
	// From the middle, every pixel is reached by an angle along the meridian and one around the axis.
	const double radians = 2.0 * std::numbers::pi * (half.x + half.y);
	const double sine = radians < 1.0 ? radians + reach_on_planet() / planet_radius + 1e-9 : 1.0;
	const Rotation longitude = rotation_by(middle.x);
	const Rotation from_pole = rotation_by(middle.y);
	return {Planet::up({from_pole.sine * longitude.sine, from_pole.cosine, from_pole.sine * longitude.cosine}), sine};
}

} // namespace thicket
