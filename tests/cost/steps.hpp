#pragma once

#include <cstddef>
#include <cstdint>

namespace thicket::cost {

/// Returns the number of steps of this thread so far. Each basic block of our code that is entered
/// counts as one step, as do each 16 bytes that memmove, memcpy or memset processes. The number
/// does not depend on the load of the machine. The sources must be compiled with count_steps=yes.
std::uint64_t steps();

} // namespace thicket::cost
