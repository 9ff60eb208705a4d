#pragma once

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace thicket {

/// Computes heights and normals in patches that are not at the border of a grid of 16-bit height
/// samples, many at a time with vectors. The code uses the same operations as smooth_patch in the
/// same order, so the results are bit-identical.
struct InnerPatches {
	static constexpr std::size_t capacity = 32;
	static constexpr std::size_t rows = 4; ///< The row before the patch, its two rows, and the row after it.

	/// The conversion of stored 16-bit samples to heights in meters: height = base + sample *
	/// scale.
	struct Heights {
		double base = 0.0;
		double scale = 1.0;
		glm::dvec2 posts_per_meter{1.0};
	};

	/// Adds a position in the patch whose first height sample is at `first`. Rows are `stride`
	/// samples apart. `fraction` is the fraction of the way to the patch's far corner on each axis.
	/// `index` is for the caller's use.
	void add(const std::uint16_t *first, std::ptrdiff_t stride, glm::dvec2 fraction, std::size_t index) {
		const std::uint16_t *row = first - stride - 1;
		for (std::size_t i = 0; i < rows; ++i, row += stride) {
			std::memcpy(&posts[i][count], row, sizeof posts[i][count]);
		}
		x[count] = fraction.x;
		y[count] = fraction.y;
		indices[count++] = index;
	}

	bool full() const { return count == capacity; }

	/// Computes the ground at all added positions.
	void compute(const Heights &heights);

	std::size_t count = 0;
	std::array<std::size_t, capacity> indices{};                               ///< The `index` of each patch.
	alignas(64) std::array<std::array<std::uint64_t, capacity>, rows> posts{}; ///< Four adjacent samples in each word.
	alignas(64) std::array<double, capacity> x{};
	alignas(64) std::array<double, capacity> y{};

	// The results, valid after `compute`.
	alignas(64) std::array<float, capacity> height{};
	alignas(64) std::array<float, capacity> normal_x{};
	alignas(64) std::array<float, capacity> normal_y{};
	alignas(64) std::array<float, capacity> normal_z{};
};

} // namespace thicket
