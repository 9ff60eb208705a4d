#pragma once

#include <glm/vec3.hpp>

namespace thicket {

/// The properties of an LOD of a layer's model that decide about its shadow.
struct LodCaster {
	glm::dvec3 size{0.0};          ///< Meters, of the box around the model at the layer's largest scale.
	double per_square_meter = 0.0; ///< Instances of the layer per square meter at its highest density.
	double distance = 0.0;         ///< Meters from which the LOD is drawn.
};

inline constexpr double dense_layer = 1.0;    ///< Instances per square meter from which a layer is dense,
inline constexpr double small_plant = 2.0;    ///< and meters of the longest side below which its models are small.
inline constexpr double near_in_sizes = 10.0; ///< Multiples of the longest side up to which such a layer has shadows.
inline constexpr double shadow_sight = 512.0; ///< Multiples of a shadow's width up to which a shadow map shows it.

/// Whether an LOD should cast a shadow by default.
///
/// Where small plants grow densely, as grass does, they soon hide each other's shadows. So an LOD of such a layer casts none if it begins
/// at `near_in_sizes` times the longest side or farther. Elsewhere each LOD casts the shadow of its own mesh, which is cheaper the coarser
/// it is. No LOD casts a shadow if it begins where the shadow is thinner than a pixel of its map. The width of a box's shadow is the middle
/// one of its sides, whatever the direction of the sun. A pixel is a `shadow_sight`th of the distance wide: the map of a directional light,
/// with 4096 pixels, has 2048 for the farthest of four splits, which must cover about four times the distance across.
///
/// A NAN or a negative size keeps the LOD's shadow.
bool casts_shadow(const LodCaster &lod);

} // namespace thicket
