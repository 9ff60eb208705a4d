#pragma once

#include <cstddef>

/// How often this process has called operator new so far, on this thread: for tests of "nothing is allocated once
/// warm".
std::size_t allocation_count();
