#pragma once

#include "nodes/layer/layer_snapshot.hpp"

namespace thicket {

/// Records for each drawn mesh whether it can fade. It can if all its materials are shaders that include scatter_fade.gdshaderinc, if none
/// of them has its parameter scatter_cross_fade off, and if the mesh itself does not use CUSTOM3.
void add_fades(LayerDrawing &r_drawing);

} // namespace thicket
