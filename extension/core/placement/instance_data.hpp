#pragma once

#include "core/base/status.hpp"
#include "core/placement/placement.hpp"

#include <glm/vec4.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// Colors to choose from, red, green, blue and alpha, each as likely as any other: a gradient of n entries is sampled at
/// (i + 0.5) / n. 1 to max_colors entries of finite numbers, 0 to max_color.
using ColorTable = std::vector<glm::vec4>;

inline constexpr std::size_t max_colors = 4096;
inline constexpr float max_color = 65504.0f; ///< The largest half float.

/// What an instance's shader gets to know beside the transform. Every number is rounded to a half float, as which the
/// Compatibility renderer keeps it, so that all renderers, and who reads back, get the same bits.
struct InstanceData {
	/// Adds a color, COLOR in a shader, chosen by the instance's hash.
	bool use_colors = false;

	/// What to choose from. Null: white. Two are equal only if they share the table itself.
	std::shared_ptr<const ColorTable> colors{};

	/// Adds INSTANCE_CUSTOM: r variation and g wind phase, 0 to 1 each by the instance's hash; b thinning rank, 0 to 1,
	/// the density at which the instance would go; a scale.
	bool use_custom_data = false;

	friend bool operator==(const InstanceData &, const InstanceData &) = default;
};

/// Refuses a table that is empty, too large, or has a number outside the range.
Status validate(const InstanceData &data);

/// Floats an instance in a buffer, in the engine's order: transform, then color, then custom data.
constexpr std::size_t floats_per_instance(const InstanceData &data) {
	return transform_floats + (data.use_colors ? 4 : 0) + (data.use_custom_data ? 4 : 0);
}

/// Writes what follows the transform, `floats_per_instance(data) - transform_floats` floats. `rank` is the thinning rank
/// of 32 bits. `data` must be valid.
void write_instance_data(const InstanceData &data, std::uint64_t seed, std::uint64_t id, std::uint32_t rank,
		float scale, std::span<float> r_floats);

/// The half float nearest to `value`, ties to even, as a float. |value| is at most max_color.
float rounded_to_half(float value);

} // namespace thicket
