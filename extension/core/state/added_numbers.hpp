#pragma once

#include "core/state/instance_state.hpp"

namespace thicket {

/// Calls `use` for each floating-point number of an instance: the position, then the basis, column
/// by column.
template <typename Instance, typename Use>
void for_each_number(Instance &instance, Use use) {
	for (int axis = 0; axis < 3; ++axis) {
		use(instance.position[axis]);
	}
	for (int column = 0; column < 3; ++column) {
		for (int row = 0; row < 3; ++row) {
			use(instance.basis[column][row]);
		}
	}
}

} // namespace thicket
