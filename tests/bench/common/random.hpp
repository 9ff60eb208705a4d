#pragma once

#include <bit>
#include <cstdint>

namespace thicket::bench {

/// Performs one step of SplitMix64 (Steele, Lea and Flood 2014), which seeds the state of other
/// generators.
inline std::uint64_t split_mix(std::uint64_t &state) {
	state += 0x9E3779B97F4A7C15;
	std::uint64_t z = state;
	z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9;
	z = (z ^ (z >> 27)) * 0x94D049BB133111EB;
	return z ^ (z >> 31);
}

/// xoroshiro128+ (Blackman and Vigna 2018), one of the fastest generators with good high bits, so
/// random numbers hardly slow down the baselines. It has nothing in common with the hashes of the
/// sampler under test.
class Xoroshiro {
public:
	explicit Xoroshiro(std::uint64_t seed) : low_(split_mix(seed)), high_(split_mix(seed)) {}

	std::uint64_t operator()() {
		const std::uint64_t result = low_ + high_;
		const std::uint64_t mixed = low_ ^ high_;
		low_ = std::rotl(low_, 24) ^ mixed ^ (mixed << 16);
		high_ = std::rotl(mixed, 37);
		return result;
	}

	/// Returns a random integer in [0, count), by multiplication and shift. The bias is below count
	/// / 2^32. `count` must be > 0.
	std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>(((*this)() >> 32) * count >> 32); }

private:
	std::uint64_t low_;
	std::uint64_t high_;
};

} // namespace thicket::bench
