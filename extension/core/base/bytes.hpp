#pragma once

#include "core/base/word_hash.hpp"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

// Stored data is a sequence of bytes. All numbers are little-endian.

/// Returns the 64-bit FNV-1a hash of `bytes`. Byte strings of equal length that differ in only one
/// byte always have different checksums.
inline std::uint64_t checksum(std::span<const std::uint8_t> bytes) {
	WordHash hash;
	for (const std::uint8_t byte : bytes) {
		hash.add(std::uint32_t{byte});
	}
	return hash.value();
}

/// Appends an unsigned number in little-endian order.
template <typename Number>
void append(std::vector<std::uint8_t> &r_bytes, Number number) {
	for (std::size_t byte = 0; byte < sizeof number; ++byte) {
		r_bytes.push_back(static_cast<std::uint8_t>(number >> 8 * byte));
	}
}

/// Reads little-endian numbers from the front of a byte string. A read past the end returns 0.
/// After such a read, `good` returns false and all subsequent reads return 0.
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

	/// Returns an empty span if fewer than `count` bytes remain.
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

	/// Returns the bytes that have not been read yet.
	std::span<const std::uint8_t> rest() const { return rest_; }

private:
	std::span<const std::uint8_t> rest_;
	bool good_ = true;
};

} // namespace thicket
