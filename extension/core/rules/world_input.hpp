#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace thicket {

/// Where a WorldInput comes from.
enum class WorldInputKind : std::uint8_t {
	biome,    ///< The weight of a biome, 0 to 1.
	texture,  ///< The weight of a texture of the ground, 0 to 1.
	distance, ///< The distance to the nearest instance of an earlier layer in meters, at most WorldInput::max_distance.
	mask,     ///< A channel of the layer's mask texture, 0 to 1.
};

/// A value that an expression reads from outside the rules of its layer. The expression only names
/// the source, which the layer provides (see WorldSource).
struct WorldInput {
	WorldInputKind kind = WorldInputKind::biome;
	std::string name{}; ///< The name of the biome or the layer; empty for a biome that has a number.
	/// The number of the texture, the index of the biome, or the channel of the mask (0 for red to 3
	/// for alpha).
	std::int32_t number = 0;
	double max_distance = 0.0; ///< Meters, min_input_distance to max_input_distance; 0 for other kinds.

	friend bool operator==(const WorldInput &, const WorldInput &) = default;
};

inline constexpr std::size_t max_world_inputs = 16; ///< Maximum number of world inputs of an expression.
inline constexpr std::int32_t max_input_texture = 255;
inline constexpr double min_input_distance = 0.001; ///< Meters.
inline constexpr double max_input_distance = 1e3;   ///< Meters.

/// The names of the mask's channels in an expression, in the order of WorldInput::number.
inline constexpr std::array<std::string_view, 4> mask_channel_inputs{
		"mask_red", "mask_green", "mask_blue", "mask_alpha"};

/// Returns the input as the text of an expression, such as biome("Forest").
std::string text_of(const WorldInput &input);

/// Returns the text of an expression with the layer `from` of distance() replaced by `to`, which must
/// not be empty or contain both kinds of quotes.
std::string with_renamed_layer(std::string_view text, std::string_view from, std::string_view to);

} // namespace thicket
