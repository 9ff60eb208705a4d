#pragma once

#include "nodes/layer/layer_snapshot.hpp"

namespace thicket {

/// Says of each mesh that is drawn whether it can fade: whether all its materials are shaders that include scatter_fade.gdshaderinc, and none of them has
/// its parameter scatter_cross_fade off.
void add_fades(LayerDrawing &r_drawing);

} // namespace thicket
