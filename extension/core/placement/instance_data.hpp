#pragma once

#include "core/base/status.hpp"
#include "core/placement/instance_source.hpp"
#include "core/placement/placement.hpp"

#include <glm/vec4.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// Colors to choose from, red, green, blue and alpha, each for an equal part of the numbers from 0 to 1: a gradient of n entries
/// is sampled at (i + 0.5) / n. 1 to max_colors entries of finite numbers, 0 to max_color.
using ColorTable = std::vector<glm::vec4>;

inline constexpr std::size_t max_colors = 4096;
inline constexpr float max_color = 65504.0f; ///< The largest half float.

/// Two sources that are told apart by their types.
struct ColorSource : InstanceSource {
	friend bool operator==(const ColorSource &, const ColorSource &) = default;
};
struct VariationSource : InstanceSource {
	friend bool operator==(const VariationSource &, const VariationSource &) = default;
};

/// What an instance's shader gets to know beside the transform. Every number is rounded to a half float, as which the
/// Compatibility renderer keeps it, so that all renderers, and who reads back, get the same bits.
struct InstanceData {
	/// Adds a color, COLOR in a shader.
	bool use_colors = false;

	/// What to choose from. Null: white. Two are equal only if they share the table itself.
	std::shared_ptr<const ColorTable> colors{};

	/// Adds INSTANCE_CUSTOM: r variation, 0 to 1; g wind phase, 0 to 1 by the instance's hash; b thinning rank, 0 to 1, the density
	/// at which the instance would go; a scale.
	bool use_custom_data = false;

	ColorSource color{};         ///< Where in `colors` an instance's color is; random by its hash.
	VariationSource variation{}; ///< Of INSTANCE_CUSTOM; random by its hash.

	/// True if instances need a share for their color, or for their variation.
	bool color_is_known() const { return use_colors && colors != nullptr && color.known(); }
	bool variation_is_known() const { return use_custom_data && variation.known(); }

	friend bool operator==(const InstanceData &, const InstanceData &) = default;
};

/// The sources of an instance that look at another layer; null for the others.
std::array<const InstanceSource *, 2> distance_sources(const InstanceData &data);

/// How far an instance's sources are along their ranges, 0 to 1.
struct InstanceShares {
	float color = unknown_share;
	float variation = unknown_share;
};

/// What is known about an instance that was placed by hand; see share_by_hand.
InstanceShares shares_by_hand(const InstanceData &data, glm::dvec3 position);

/// Refuses a table that is empty, too large, or has a number outside the range; and a source that is used and refused.
Status validate(const InstanceData &data);

/// Floats an instance in a buffer, in the engine's order: transform, then color, then custom data.
constexpr std::size_t floats_per_instance(const InstanceData &data) {
	return transform_floats + (data.use_colors ? 4 : 0) + (data.use_custom_data ? 4 : 0);
}

/// Writes what follows the transform, `floats_per_instance(data) - transform_floats` floats. `rank` is the thinning rank
/// of 32 bits. `data` must be valid.
void write_instance_data(const InstanceData &data, std::uint64_t seed, std::uint64_t id, std::uint32_t rank,
		float scale, std::span<float> r_floats, const InstanceShares &shares = {});

/// The half float nearest to `value`, ties to even, as a float. |value| is at most max_color.
float rounded_to_half(float value);

} // namespace thicket
