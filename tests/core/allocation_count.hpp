#pragma once

#include <cstddef>

/// How often this process has called operator new so far, on this thread: for tests of "nothing is allocated once
/// warm".
std::size_t allocation_count();

/// While it lives, operator new fails on this thread after `allowed` calls.
class AllocationLimit {
public:
	explicit AllocationLimit(std::size_t allowed);
	~AllocationLimit();
	AllocationLimit(const AllocationLimit &) = delete;
	AllocationLimit &operator=(const AllocationLimit &) = delete;
};
