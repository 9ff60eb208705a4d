#pragma once

#include <cstdint>

namespace thicket {

/// How often this program has asked for memory through operator new, on all threads. The difference of two readings
/// says whether what ran between them allocated. allocation_counter.cpp replaces the operators.
std::uint64_t allocations();

} // namespace thicket
