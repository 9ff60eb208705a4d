#pragma once

#include "nodes/layer/layer_snapshot.hpp"

namespace thicket {

/// Records for each drawn mesh whether it can fade. A mesh can fade if all its materials are shaders that include
/// scatter_fade.gdshaderinc, if none of them has turned off its parameter scatter_cross_fade, and if the mesh itself
/// does not use CUSTOM3.
void add_fades(LayerDrawing &r_drawing);

} // namespace thicket
