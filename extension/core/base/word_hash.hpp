#pragma once

#include <bit>
#include <cstdint>
#include <span>

namespace thicket {

/// FNV-1a (Fowler, Noll and Vo) of 64 bits over 32-bit words instead of bytes: hash = (hash xor word) * 0x100000001b3.
/// With one byte per word, the result is FNV-1a itself. Each step is a bijection of the hash, so inputs that differ in
/// one word never have the same hash. Simple enough for a script to repeat.
class WordHash {
public:
	constexpr void add(std::uint32_t word) { hash_ = (hash_ ^ word) * 0x100000001b3; }
	constexpr void add(float value) { add(std::bit_cast<std::uint32_t>(value)); }
	constexpr void add(std::uint64_t value) {
		add(static_cast<std::uint32_t>(value));
		add(static_cast<std::uint32_t>(value >> 32));
	}
	constexpr void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }

	template <typename Value>
	constexpr void add_all(std::span<const Value> values) {
		for (const Value value : values) {
			add(value);
		}
	}

	constexpr std::uint64_t value() const { return hash_; }

private:
	std::uint64_t hash_ = 0xcbf29ce484222325;
};

} // namespace thicket
