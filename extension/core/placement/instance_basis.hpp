#pragma once

#include "core/placement/placement.hpp"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace thicket {

/// Rotations and scales of many instances at once, by vectors; the same bits as one after the other.
struct BasisBatch {
	static constexpr std::size_t most = 64; ///< Instances.

	// What they follow from, filled by the caller up to `count`.
	std::size_t count = 0;
	alignas(64) std::array<std::uint64_t, most> ids{};
	alignas(64) std::array<double, most> normal_x{};
	alignas(64) std::array<double, most> normal_y{};
	alignas(64) std::array<double, most> normal_z{};

	void add(std::uint64_t id, glm::vec3 normal) {
		ids[count] = id;
		normal_x[count] = double{normal.x};
		normal_y[count] = double{normal.y};
		normal_z[count++] = double{normal.z};
	}

	/// Writes, for all of them, what write_basis does. `placement` must be valid.
	void make(const Placement &placement, std::uint64_t seed);

	// What they are then.
	alignas(64) std::array<std::array<float, most>, 9> basis{}; ///< Row by row.
	alignas(64) std::array<float, most> scale{};

	/// Copies one to its transform, without its position.
	void write(std::size_t i, std::span<float, transform_floats> r_transform) const {
		for (std::size_t row = 0; row < 3; ++row) {
			for (std::size_t column = 0; column < 3; ++column) {
				r_transform[4 * row + column] = basis[3 * row + column][i];
			}
		}
	}
};

} // namespace thicket
