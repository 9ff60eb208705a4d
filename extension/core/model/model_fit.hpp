#pragma once

#include "core/model/model_size.hpp"

#include <cstdint>
#include <optional>
#include <string_view>

namespace thicket {

/// The kind of a model. Decides how its instances are placed.
enum class ModelKind : std::uint8_t {
	tree,
	shrub,
	grass, ///< And flowers, ferns, moss.
	rock,  ///< And stumps, logs.
};

/// The kind that an English word in a name says, such as "Pine_2b", "DeadTrees" or "rock-mossy"; the last one of several, as in
/// "grass-trees" or "flower bush". Ignores case, digits and a plural's s. Nothing if there is no such word.
std::optional<ModelKind> kind_named(std::string_view name);

/// The most likely kind by size: a tree is taller than 2.5 m and slender, a rock encloses a quarter of its box, grass is less than 0.7 m tall.
ModelKind kind_of(const ModelSize &size);

/// Values of a layer that suit a kind and a size. Names as in Placement, Rules and Clumping.
struct ModelFit {
	double radius = 0.0; ///< Meters.
	double density = 1.0;
	double min_scale = 1.0;
	double max_scale = 1.0;
	double max_tilt_degrees = 0.0;
	double align_to_normal = 0.0;
	double height_offset =
			0.0; ///< Meters, not above 0: the base is below the ground even at its lowest edge on a slope of 25 degrees.
	double clump_size = 0.0; ///< Meters; 0 for none.
	double clump_coverage = 0.5;
};
ModelFit fit_of(ModelKind kind, const ModelSize &size);

} // namespace thicket
