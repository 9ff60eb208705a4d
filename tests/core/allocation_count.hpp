#pragma once

#include <cstddef>
#include <cstdint>

/// Number of calls of operator new on this thread so far. Tests compare it to prove that warm code allocates nothing.
std::size_t allocation_count();

/// During the lifetime of this object, operator new fails on this thread after `allowed` calls: in every later call, or
/// only in the next one.
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

	/// True if a call has failed.
	bool reached() const;
};
