#pragma once

#include "core/model/model_size.hpp"

#include <cstdint>
#include <optional>
#include <string_view>

namespace thicket {

/// The kind of a model, which determines the default placement of its instances.
enum class ModelKind : std::uint8_t {
	tree,
	shrub,
	grass, ///< Grass, flowers, ferns and moss.
	rock,  ///< Rocks, stumps and logs.
};

/// Returns the kind that an English word in a name denotes, such as "Pine_2b", "DeadTrees" or
/// "rock-mossy". If there are several such words, the last one applies, as in "grass-trees" or
/// "flower bush". Case, digits and plural endings are ignored. Returns nothing if the name has no
/// such word.
std::optional<ModelKind> kind_named(std::string_view name);

/// Returns the most likely kind for a size. A tree is at least 2.5 m tall and slender. A rock fills
/// at least a quarter of its bounding box. Grass is less than 0.7 m tall. Everything else is a
/// shrub.
ModelKind kind_of(const ModelSize &size);

/// Default layer settings for a kind and size of model. For their meanings, see Placement, Rules
/// and Clumping.
struct ModelFit {
	double radius = 0.0; ///< Minimum distance between instances in meters.
	double density = 1.0;
	double min_scale = 1.0;
	double max_scale = 1.0;
	double max_tilt_degrees = 0.0;
	double align_to_normal = 0.0;
	/// Meters, 0 or less. Sinks the base into the ground far enough that upright models show no gap
	/// on slopes of up to 25 degrees.
	double height_offset = 0.0;
	double clump_size = 0.0; ///< Meters; 0 for no clumps.
	double clump_coverage = 0.5;
};
ModelFit fit_of(ModelKind kind, const ModelSize &size);

} // namespace thicket
