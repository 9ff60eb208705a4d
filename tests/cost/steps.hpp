#pragma once

#include <cstddef>
#include <cstdint>

namespace thicket::cost {

/// Steps that this thread has made: basic blocks that it has entered, calls for memory, and 16 bytes that were moved, copied or
/// set at a time. They do not depend on the machine or its load. Sources have to be compiled with count_steps=yes.
std::uint64_t steps();

} // namespace thicket::cost
