// Measures the CPU time of this process. Unlike wall time, it does not depend on other processes.

#pragma once

#include <ctime>

namespace thicket::test {

/// Returns the CPU time of all threads of this process, in seconds. On Windows, std::clock measures
/// wall time instead.
inline double processor_seconds() { return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC); }

} // namespace thicket::test
