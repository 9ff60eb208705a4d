#pragma once

#include <glm/vec3.hpp>

namespace thicket {

/// A level of detail of a layer's model, as far as that decides about its shadow.
struct LodCaster {
	glm::dvec3 size{0.0};          ///< Meters, of the box around the model at the layer's largest scale.
	double per_square_meter = 0.0; ///< Instances of the layer where it stands as densely as it may.
	double distance = 0.0;         ///< Meters from which the LOD is drawn.
};

inline constexpr double dense_layer = 1.0;    ///< Instances per square meter from which a layer is dense,
inline constexpr double small_plant = 2.0;    ///< and meters of the longest side below which its models are small.
inline constexpr double near_in_sizes = 10.0; ///< Longest sides away, up to which such a layer has shadows.
inline constexpr double shadow_sight = 512.0; ///< Widths of a shadow away, up to which a shadow map shows it.

/// Whether an LOD should cast a shadow if nobody says so.
///
/// Where small plants stand densely, as grass does, they hide each other's shadows soon: an LOD casts none that begins `near_in_sizes` times the
/// longest side away, or farther. Elsewhere each LOD casts the shadow of its own mesh, which is the cheaper the coarser it is. No LOD
/// casts one that begins where a shadow is thinner than a pixel of its map. How wide the shadow of a box is tells the middle one of its
/// sides, whichever way the sun stands; and a pixel is a `shadow_sight`th of the distance wide, since a directional light's map of 4096
/// pixels has 2048 for the farthest of four splits, which must cover about four times the distance across.
///
/// A NAN or a negative size leaves the LOD its shadow.
bool casts_shadow(const LodCaster &lod);

} // namespace thicket
