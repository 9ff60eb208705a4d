#pragma once

#include "core/base/bytes.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// An id by which neighbors of the plane are mostly neighbors in the order of numbers: the bits of its cell are interleaved (Morton's
/// order), those above stay.
std::uint64_t code_of(std::uint64_t id);

/// The id that has this code.
std::uint64_t id_of(std::uint64_t code);

/// Adds a list of numbers, each larger than the one before: the gaps between them in blocks of 128, each with the parameter that suits
/// it, as Golomb and Rice have it (R. F. Rice, "Some practical universal noiseless coding techniques", 1979). A random number of 2^48
/// costs 30 bits in a list of a million, neighbors cost a few. The same list gives the same bytes. What comes of it once `cancel` was
/// raised, from any thread, is of no use; null for never.
void append_ascending(std::span<const std::uint64_t> numbers, std::vector<std::uint8_t> &r_bytes,
		const std::atomic<bool> *cancel = nullptr);

/// Takes a list of `count` numbers off the front. False if there is none, and once `cancel` was raised; never uses more memory than 64
/// times what the bytes do.
bool take_ascending(ByteReader &r_bytes, std::size_t count, std::vector<std::uint64_t> &r_numbers,
		const std::atomic<bool> *cancel = nullptr);

} // namespace thicket
