#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>

namespace thicket::fuzz {

/// Converts a fuzzer's bytes to arguments. Returns zeros after the last byte.
class Bytes {
public:
	Bytes(const std::uint8_t *data, std::size_t size) : rest_(data, size) {}

	template <typename T>
	T raw() {
		T value{};
		const std::size_t byte_count = rest_.size() < sizeof value ? rest_.size() : sizeof value;
		std::memcpy(&value, rest_.data(), byte_count);
		rest_ = rest_.subspan(byte_count);
		return value;
	}

	bool chance(int one_in) { return raw<std::uint8_t>() % one_in == 0; }
	std::uint32_t below(std::uint32_t count) { return raw<std::uint32_t>() % count; }

	/// Returns a number in [from, to] in most cases, and occasionally a special value or any bit
	/// pattern.
	double number(double from, double to) {
		static constexpr double inf = std::numeric_limits<double>::infinity();
		static constexpr std::array<double, 14> nasty = {0.0, -0.0, 1.0, -1.0, inf, -inf,
				std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::denorm_min(),
				std::numeric_limits<double>::min(), std::numeric_limits<double>::max(),
				std::numeric_limits<double>::lowest(), 1e300, -4.9e6, 0x1p31};
		if (chance(24)) {
			return nasty[raw<std::uint8_t>() % nasty.size()];
		}
		if (chance(48)) {
			return raw<double>();
		}
		return from + (to - from) * (static_cast<double>(raw<std::uint16_t>()) / 65535.0);
	}

private:
	std::span<const std::uint8_t> rest_;
};

} // namespace thicket::fuzz
