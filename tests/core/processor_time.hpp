// How much this process has worked: what a busy machine takes away from it does not count, as it would by the clock.

#pragma once

#include <ctime>

namespace thicket::test {

/// Seconds that all threads of this process have computed. On Windows seconds that have passed.
inline double processor_seconds() { return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC); }

} // namespace thicket::test
