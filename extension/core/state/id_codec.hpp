#pragma once

#include "core/base/bytes.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// Converts an ID to a code with the bits of its cell interleaved (Morton order), so that nearby
/// points usually have nearby codes. The bits above the cell are unchanged.
std::uint64_t code_of(std::uint64_t id);

/// Converts a code back to its ID.
std::uint64_t id_of(std::uint64_t code);

/// Appends a list of strictly ascending numbers to `r_bytes`. The gaps between them are encoded
/// with Golomb-Rice coding in blocks of 128, each with its optimal parameter (R. F. Rice, "Some
/// practical universal noiseless coding techniques", 1979). In a list of a million random 48-bit
/// numbers, each takes 30 bits; nearby numbers take a few bits. The same list always produces the
/// same bytes. Any thread may set `cancel` to stop early; the output is then invalid. `cancel` may
/// be null.
void append_ascending(std::span<const std::uint64_t> numbers, std::vector<std::uint8_t> &r_bytes,
		const std::atomic<bool> *cancel = nullptr);

/// Reads a list of `count` numbers and removes it from the front of `r_bytes`. Returns false if the
/// bytes do not start with such a list, or if `cancel` is set. The numbers take at most 64 times as
/// much memory as the bytes.
bool take_ascending(ByteReader &r_bytes, std::size_t count, std::vector<std::uint64_t> &r_numbers,
		const std::atomic<bool> *cancel = nullptr);

} // namespace thicket
