#pragma once

#include <atomic>
#include <cstdint>

namespace thicket {

/// A number that no other object has during the lifetime of the process, and never 0. Caches use it
/// instead of an object's address, which a later object may have, too. A copy has its own number,
/// and each assignment changes the number. All numbers compare equal, so that they do not affect
/// the comparison of the objects that contain them.
class UniqueNumber {
public:
	UniqueNumber() = default;
	UniqueNumber(const UniqueNumber &) {}
	UniqueNumber(UniqueNumber &&) noexcept {}
	UniqueNumber &operator=(const UniqueNumber &) {
		value_ = next();
		return *this;
	}
	UniqueNumber &operator=(UniqueNumber &&) noexcept {
		value_ = next();
		return *this;
	}
	~UniqueNumber() = default;

	std::uint64_t value() const { return value_; }

	friend bool operator==(const UniqueNumber &, const UniqueNumber &) { return true; }

private:
	static std::uint64_t next() {
		static std::atomic<std::uint64_t> count = 0;
		return ++count;
	}

	std::uint64_t value_ = next();
};

} // namespace thicket
