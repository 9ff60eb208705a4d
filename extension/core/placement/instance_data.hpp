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

/// RGBA colors, which divide the range 0 to 1 into equal parts: entry i of n is a gradient's color
/// at (i + 0.5) / n. A table has 1 to max_colors entries, and all numbers are finite, 0 to
/// max_color.
using ColorTable = std::vector<glm::vec4>;

inline constexpr std::size_t max_colors = 4096;
inline constexpr float max_color = 65504.0f; ///< The largest finite half float.

/// The source of an instance's color. Color, variation and scale have separate types, so that the
/// sources cannot be confused.
struct ColorSource : InstanceSource {
	friend bool operator==(const ColorSource &, const ColorSource &) = default;
};
struct VariationSource : InstanceSource {
	friend bool operator==(const VariationSource &, const VariationSource &) = default;
};

struct ScaleSource : InstanceSource {
	/// Returns true if the scale is not simply a random number.
	bool used() const { return known() || curve != nullptr; }

	friend bool operator==(const ScaleSource &, const ScaleSource &) = default;
};

/// The per-instance data of a shader, in addition to the transform, and the source of the scale.
/// Every number for a shader is rounded to a half float, because the Compatibility renderer stores
/// half floats. All renderers, and code that reads the data back, therefore get the same values.
struct InstanceData {
	/// Adds a color to the data, which shaders read as COLOR.
	bool use_colors = false;

	/// The colors to choose from; null means white. Comparison is by address, not by content.
	std::shared_ptr<const ColorTable> colors{};

	/// Adds custom data, which shaders read as INSTANCE_CUSTOM. Red is the variation, 0 to 1. Green
	/// is the wind phase, a random number from 0 to 1. Blue is the thinning rank, 0 to 1: the
	/// density at which the instance is thinned out. Alpha is the scale.
	bool use_custom_data = false;

	ColorSource color{};         ///< Selects an instance's color in `colors`; random by default.
	VariationSource variation{}; ///< The variation in INSTANCE_CUSTOM; random by default.

	/// Selects an instance's scale between Placement::min_scale and Placement::max_scale; random by
	/// default. Placement::scale_curve applies afterwards.
	ScaleSource scale{};

	/// Return true if the color, the variation or the scale depends on a known source, so that
	/// SourceFractions are needed.
	bool color_is_known() const { return use_colors && colors != nullptr && color.known(); }
	bool variation_is_known() const { return use_custom_data && variation.known(); }
	bool scale_is_known() const { return scale.known(); }
	bool has_fractions() const { return color_is_known() || variation_is_known() || scale_is_known(); }

	friend bool operator==(const InstanceData &, const InstanceData &) = default;
};

/// Returns the sources of the scale, the color and the variation, or null for those that do not
/// depend on the distance to a different layer.
std::array<const InstanceSource *, 3> distance_sources(const InstanceData &data);

/// The values of an instance's sources as fractions of their ranges, 0 to 1, or unknown_fraction.
struct SourceFractions {
	float color = unknown_fraction;
	float variation = unknown_fraction;
	float scale = unknown_fraction;
};

/// Returns the fractions of a hand-placed instance; see fraction_by_hand. The scale's is unknown,
/// because hand-placed instances have their own scale.
SourceFractions fractions_by_hand(
		const InstanceData &data, glm::dvec3 position, bool on_surface, const Planet &planet = {});

/// Returns an error for a color table that is empty, too large, or has numbers out of range, and
/// for invalid sources that are in use.
Status validate(const InstanceData &data);

/// Returns the number of floats per instance in a buffer with Godot's layout: transform, then
/// color, then custom data.
constexpr std::size_t floats_per_instance(const InstanceData &data) {
	return transform_floats + (data.use_colors ? 4 : 0) + (data.use_custom_data ? 4 : 0);
}

/// Writes the `floats_per_instance(data) - transform_floats` floats that follow the transform.
/// `rank` is the 32-bit thinning rank. `data` must be valid.
void write_instance_data(const InstanceData &data, std::uint64_t seed, std::uint64_t id, std::uint32_t rank,
		float scale, std::span<float> r_floats, const SourceFractions &fractions = {});

/// Returns the number from 0 to 1 that selects the scale of an instance with this id.
double scale_number(const ScaleSource &source, std::uint64_t seed, std::uint64_t id, float fraction);

/// Rounds `value` to the nearest half float, with ties to even, and returns it as a float. |value|
/// must be at most max_color.
float rounded_to_half(float value);

} // namespace thicket
