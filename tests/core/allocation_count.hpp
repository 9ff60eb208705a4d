#pragma once

#include <cstddef>
#include <cstdint>

/// How often this process has called operator new so far, on this thread: for tests of "nothing is allocated once
/// warm".
std::size_t allocation_count();

/// While it lives, operator new fails on this thread after `allowed` calls: all later ones, or the next one alone.
class AllocationLimit {
public:
	enum class Fails : std::uint8_t {
		all_later,
		one,
	};

	explicit AllocationLimit(std::size_t allowed, Fails fails = Fails::all_later);
	~AllocationLimit();
	AllocationLimit(const AllocationLimit &) = delete;
	AllocationLimit &operator=(const AllocationLimit &) = delete;

	/// Whether a call has failed.
	bool reached() const;
};
