#pragma once

#include "nodes/layer/layer_snapshot.hpp"

namespace thicket {

/// Sets MeshAppearance::fades of each drawn mesh. A mesh can fade if all its materials have shaders that
/// include scatter_fade.gdshaderinc and none of them disables the parameter scatter_cross_fade. The
/// mesh must not use CUSTOM3.
void add_fades(LayerDrawing &r_drawing);

} // namespace thicket
