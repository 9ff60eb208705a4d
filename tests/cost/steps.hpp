#pragma once

#include <cstddef>
#include <cstdint>

namespace thicket::cost {

/// Steps of this thread: basic blocks entered, memory requests, and every 16 bytes that were moved, copied or set. They
/// are independent of the machine and its load. Compile the sources with count_steps=yes.
std::uint64_t steps();

} // namespace thicket::cost
