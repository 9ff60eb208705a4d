#pragma once

#include <cstddef>
#include <cstdint>

/// The number of calls to operator new on this thread so far. Tests compare counts to verify that
/// code does not allocate once its buffers have grown.
std::size_t allocation_count();

/// While this object exists, operator new fails on this thread after `allowed` calls. Either every
/// later call fails, or only the next one.
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

	/// Returns true if a call to operator new has failed.
	bool reached() const;
};
