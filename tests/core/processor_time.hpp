// Measures this process's processor time, which other processes on a busy machine do not affect.

#pragma once

#include <ctime>

namespace thicket::test {

/// Seconds of processor time of all threads of this process. On Windows, seconds of wall time.
inline double processor_seconds() { return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC); }

} // namespace thicket::test
