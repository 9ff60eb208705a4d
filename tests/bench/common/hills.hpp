#pragma once

#include "core/terrain/heightfield.hpp"

#include <cstdint>
#include <vector>

namespace thicket::bench {

/// A heightfield of hills with 512 x 384 height samples (posts), 20 m apart and 0 to 800 m high.
/// The heights are six octaves of value noise, computed with integers, so that every machine and
/// compiler produces the same heights. Slopes are mostly below 45 degrees.
class Hills {
public:
	static constexpr int columns = 512;
	static constexpr int rows = 384;
	static constexpr double spacing = 20.0;

	static HeightfieldFrame frame(glm::dvec2 corner) {
		const glm::dvec2 size((columns - 1) * spacing, (rows - 1) * spacing);
		return {{columns, rows}, {corner, corner + size}, 0.0, 800.0};
	}

	static std::vector<std::uint16_t> posts() {
		std::vector<std::uint16_t> posts;
		posts.reserve(std::size_t{columns} * rows);
		for (std::uint32_t y = 0; y < rows; ++y) {
			for (std::uint32_t x = 0; x < columns; ++x) {
				posts.push_back(height(x, y));
			}
		}
		return posts;
	}

	/// Returns the hills with their first post at `corner`.
	static Heightfield at(glm::dvec2 corner) {
		Heightfield field;
		const Status status = field.set(frame(corner), posts());
		(void)status; // The frame above is valid.
		return field;
	}

private:
	static std::uint32_t noise(std::uint32_t x, std::uint32_t y, std::uint32_t octave) {
		std::uint32_t bits = x * 0x9E3779B1u ^ y * 0x85EBCA77u ^ octave * 0xC2B2AE3Du;
		bits = (bits ^ bits >> 15) * 0x2C1B3C6Du;
		bits = (bits ^ bits >> 12) * 0x297A2D39u;
		return (bits ^ bits >> 15) & 0xffff;
	}

	/// Returns one octave of the noise. It is smooth between lattice points, which are 2^shift
	/// posts apart.
	static std::uint32_t octave_at(std::uint32_t x, std::uint32_t y, std::uint32_t shift) {
		const std::uint32_t step = 1u << shift;
		const auto smooth = [step](std::uint32_t t) { // Computes 3 t^2 - 2 t^3, in units of 1 / 4096.
			const std::uint32_t u = t * 64 / step;
			return u * u * (192 - 2 * u) / 64;
		};
		const std::uint32_t column = x >> shift;
		const std::uint32_t row = y >> shift;
		const std::uint32_t u = smooth(x & (step - 1));
		const std::uint32_t v = smooth(y & (step - 1));
		const auto mix = [](std::uint32_t a, std::uint32_t b, std::uint32_t t) {
			return (a * (4096 - t) + b * t) >> 12;
		};
		return mix(mix(noise(column, row, shift), noise(column + 1, row, shift), u),
				mix(noise(column, row + 1, shift), noise(column + 1, row + 1, shift), u), v);
	}

	static std::uint16_t height(std::uint32_t x, std::uint32_t y) {
		std::uint32_t sum = 0;
		for (std::uint32_t octave = 0; octave < 6; ++octave) {
			sum += octave_at(x, y, 7 - octave) >> (octave + 1);
		}
		return static_cast<std::uint16_t>(sum);
	}
};

} // namespace thicket::bench
