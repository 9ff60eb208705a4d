#pragma once

#include <glm/vec3.hpp>

namespace thicket {

/// The properties of an LOD that determine whether it casts a shadow.
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
/// Small plants that grow densely, like grass, soon hide each other's shadows. So an LOD of such a layer casts no
/// shadow if it begins at `near_in_sizes` times the longest side or farther. In other layers each LOD casts the shadow
/// of its own mesh, and a coarser mesh costs less. No LOD casts a shadow if it begins where the shadow is thinner than
/// a pixel of its map. As the width of a box's shadow, the middle one of its sides counts, whatever the direction of
/// the sun. The width of a pixel is the distance divided by `shadow_sight`: the map of a directional light has 4096
/// pixels, of which the farthest of four splits gets 2048, and that split must cover about four times the distance
/// across.
///
/// A NAN or a negative size keeps the LOD's shadow.
bool casts_shadow(const LodCaster &lod);

} // namespace thicket
