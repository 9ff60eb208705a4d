#pragma once

#include <glm/vec3.hpp>

namespace thicket {

/// The properties of an LOD that determine whether it casts a shadow.
struct LodCaster {
	glm::dvec3 size{0.0};          ///< Size in meters of the model's bounding box at the layer's largest scale.
	double per_square_meter = 0.0; ///< Number of instances per square meter at the layer's highest density.
	double distance = 0.0;         ///< Distance in meters from which the LOD is drawn.
};

/// Number of instances per square meter from which a layer is considered dense.
inline constexpr double dense_layer = 1.0;
inline constexpr double small_plant = 2.0; ///< Longest side in meters below which a model is considered small.
/// Distance up to which small models in dense layers cast shadows, in multiples of their longest
/// side.
inline constexpr double near_in_sizes = 10.0;
/// Distance up to which a shadow map resolves a shadow, in multiples of the shadow's width.
inline constexpr double shadow_sight = 512.0;

/// Returns true if an LOD should cast a shadow by default.
///
/// Small, dense plants such as grass hide each other's shadows at a distance. An LOD of such a
/// layer therefore casts no shadow if it begins at `near_in_sizes` times the longest side or
/// farther. In other layers, each LOD casts the shadow of its mesh, which costs less for coarser
/// meshes.
///
/// No LOD casts a shadow if, where it begins, the shadow is narrower than a pixel of the shadow
/// map. The shadow is assumed to be as wide as the second longest side of the box, for any
/// direction of the sun. The width of a pixel is the distance divided by `shadow_sight`. The map of
/// a directional light is 4096 pixels wide and high, and the farthest of its four splits is 2048
/// pixels wide and high. That split must cover about four times the distance.
///
/// Also returns true if a size is NAN or negative.
bool casts_shadow(const LodCaster &lod);

} // namespace thicket
