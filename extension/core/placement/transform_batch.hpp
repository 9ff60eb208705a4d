#pragma once

#include "core/placement/placement.hpp"

#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>

namespace thicket {

/// Computes the transforms of many instances with vector instructions. The results are
/// bit-identical to those of write_basis.
struct TransformBatch {
	static constexpr std::size_t capacity = 64; ///< Maximum number of instances in a batch.

	// Inputs of `make`. `add` fills the first `count` entries.
	std::size_t count = 0;
	alignas(64) std::array<std::uint64_t, capacity> ids{};
	alignas(64) std::array<float, capacity> normal_x{};
	alignas(64) std::array<float, capacity> normal_y{};
	alignas(64) std::array<float, capacity> normal_z{};
	alignas(64) std::array<float, capacity> position_x{};
	alignas(64) std::array<float, capacity> position_y{};
	alignas(64) std::array<float, capacity> position_z{};

	/// True if the first `count` instances have a heading (see write_basis).
	bool has_headings = false;
	alignas(64) std::array<double, capacity> heading_cosine{};
	alignas(64) std::array<double, capacity> heading_sine{};

	/// Sets the heading of the next instance to add. Either all instances of a batch have one, or none.
	void set_heading(const std::optional<Rotation> &heading) {
		has_headings = heading.has_value();
		if (has_headings) {
			heading_cosine[count] = heading->cosine;
			heading_sine[count] = heading->sine;
		}
	}

	/// Adds an instance. `position` is the result of standing_position.
	void add(std::uint64_t id, glm::vec3 normal, glm::vec3 position) {
		ids[count] = id;
		normal_x[count] = normal.x;
		normal_y[count] = normal.y;
		normal_z[count] = normal.z;
		position_x[count] = position.x;
		position_y[count] = position.y;
		position_z[count++] = position.z;
	}

	glm::vec3 normal(std::size_t i) const { return {normal_x[i], normal_y[i], normal_z[i]}; }
	glm::vec3 position(std::size_t i) const { return {position_x[i], position_y[i], position_z[i]}; }

	/// Computes the transforms and scales of all instances. `placement` must be valid.
	/// `scale_numbers` has the numbers that select the scales (see write_basis), or is empty if they
	/// are random.
	void make(const Placement &placement, std::uint64_t seed, const UpField &up = {},
			std::span<const double> scale_numbers = {});

	// The outputs of `make`.
	static constexpr std::size_t row_floats = transform_floats / 3;
	/// For each of the three rows of a transform, the list of this row for all instances.
	alignas(64) std::array<std::array<float, capacity * row_floats>, 3> rows{};
	alignas(64) std::array<float, capacity> scale{};

	/// Copies the transform of one instance.
	void write(std::size_t i, std::span<float, transform_floats> r_transform) const {
		for (std::size_t row = 0; row < rows.size(); ++row) {
			std::memcpy(r_transform.data() + row * row_floats, rows[row].data() + i * row_floats,
					row_floats * sizeof(float));
		}
	}
};

} // namespace thicket
