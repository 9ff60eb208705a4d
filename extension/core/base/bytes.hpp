#pragma once

#include "core/base/word_hash.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

// Stored data is a sequence of bytes. All numbers in it are little-endian.

/// The FNV-1a hash of some bytes. Byte strings of equal length that differ in a single byte never have the same checksum.
inline std::uint64_t checksum(std::span<const std::uint8_t> bytes) {
	WordHash hash;
	for (const std::uint8_t byte : bytes) {
		hash.add(std::uint32_t{byte});
	}
	return hash.value();
}

/// Appends an unsigned number.
template <typename Number>
void append(std::vector<std::uint8_t> &r_bytes, Number number) {
	for (std::size_t byte = 0; byte < sizeof number; ++byte) {
		r_bytes.push_back(static_cast<std::uint8_t>(number >> 8 * byte));
	}
}

/// Reads numbers from the front of some bytes. A read past the end returns zeros and sets `good` to false.
class ByteReader {
public:
	explicit ByteReader(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

	template <typename Number>
	Number take() {
		Number number = 0;
		const std::span<const std::uint8_t> bytes = take_bytes(sizeof number);
		for (std::size_t byte = 0; byte < bytes.size(); ++byte) {
			number = static_cast<Number>(number | Number{bytes[byte]} << 8 * byte);
		}
		return number;
	}

	/// Empty if fewer than `count` bytes are left.
	std::span<const std::uint8_t> take_bytes(std::size_t count) {
		good_ = good_ && count <= rest_.size();
		if (!good_) {
			return {};
		}
		const std::span<const std::uint8_t> bytes = rest_.first(count);
		rest_ = rest_.subspan(count);
		return bytes;
	}

	bool good() const { return good_; }
	bool at_end() const { return rest_.empty(); }

	/// The bytes that have not been read yet.
	std::span<const std::uint8_t> rest() const { return rest_; }

private:
	std::span<const std::uint8_t> rest_;
	bool good_ = true;
};

} // namespace thicket
