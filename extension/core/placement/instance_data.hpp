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

/// Colors to choose from, each with red, green, blue and alpha, and each for an equal part of the numbers from 0 to 1:
/// a gradient of n entries is sampled at (i + 0.5) / n. A table has 1 to max_colors entries. All numbers are finite, 0
/// to max_color.
using ColorTable = std::vector<glm::vec4>;

inline constexpr std::size_t max_colors = 4096;
inline constexpr float max_color = 65504.0f; ///< The largest half float.

/// Two separate types, so that the two sources cannot be confused.
struct ColorSource : InstanceSource {
	friend bool operator==(const ColorSource &, const ColorSource &) = default;
};
struct VariationSource : InstanceSource {
	friend bool operator==(const VariationSource &, const VariationSource &) = default;
};

/// The data that an instance passes to its shader in addition to the transform. Every number is rounded to a half
/// float, because the Compatibility renderer stores half floats. So all renderers get the same bits, and so does code
/// that reads the data back.
struct InstanceData {
	/// Adds a color, which is COLOR in a shader.
	bool use_colors = false;

	/// The colors to choose from. Null means white. Two pointers are equal only if they share the same table.
	std::shared_ptr<const ColorTable> colors{};

	/// Adds INSTANCE_CUSTOM. Red is the variation, 0 to 1. Green is the wind phase, 0 to 1 from the instance's hash. Blue is the thinning
	/// rank, 0 to 1, which is the density at which the instance is thinned out. Alpha is the scale.
	bool use_custom_data = false;

	ColorSource color{};         ///< Chooses an instance's color in `colors`; random by its hash.
	VariationSource variation{}; ///< The variation in INSTANCE_CUSTOM; random by its hash.

	/// True if instances need a share for their color. The other function returns this for their variation.
	bool color_is_known() const { return use_colors && colors != nullptr && color.known(); }
	bool variation_is_known() const { return use_custom_data && variation.known(); }

	friend bool operator==(const InstanceData &, const InstanceData &) = default;
};

/// The sources of an instance that depend on a different layer. The entry of any other source is null.
std::array<const InstanceSource *, 2> distance_sources(const InstanceData &data);

/// The positions of an instance's sources within their ranges, 0 to 1.
struct InstanceShares {
	float color = unknown_share;
	float variation = unknown_share;
};

/// The shares that are known for an instance that was placed by hand; see share_by_hand.
InstanceShares shares_by_hand(const InstanceData &data, glm::dvec3 position);

/// Refuses a table that is empty, too large, or has a number outside the range, and an invalid source that is used.
Status validate(const InstanceData &data);

/// The number of floats per instance in a buffer, in the engine's order: transform, then color, then custom data.
constexpr std::size_t floats_per_instance(const InstanceData &data) {
	return transform_floats + (data.use_colors ? 4 : 0) + (data.use_custom_data ? 4 : 0);
}

/// Writes the data after the transform, `floats_per_instance(data) - transform_floats` floats. `rank` is the thinning rank of 32 bits.
/// `data` must be valid.
void write_instance_data(const InstanceData &data, std::uint64_t seed, std::uint64_t id, std::uint32_t rank,
		float scale, std::span<float> r_floats, const InstanceShares &shares = {});

/// The half float nearest to `value`, with ties to even, as a float. |value| must be at most max_color.
float rounded_to_half(float value);

} // namespace thicket
