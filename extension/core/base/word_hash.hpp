#pragma once

#include <bit>
#include <cstdint>
#include <span>

namespace thicket {

/// A 64-bit FNV-1a hash (Fowler, Noll and Vo) over 32-bit words instead of bytes: hash = (hash xor
/// word) * 0x100000001b3. With one byte per word, the result is the standard FNV-1a. Each step is a
/// bijection of the hash, so inputs of equal length that differ in only one word always have
/// different hashes. The hash is simple enough to reimplement in a script.
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
