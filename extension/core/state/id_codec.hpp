#pragma once

#include "core/base/bytes.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// A code in whose numeric order neighbors in the plane are mostly neighbors: the bits of the id's cell are interleaved (Morton order),
/// and the bits above are unchanged.
std::uint64_t code_of(std::uint64_t id);

/// The id of this code.
std::uint64_t id_of(std::uint64_t code);

/// Appends a list of ascending numbers: the gaps between them in blocks of 128, each with its own best parameter, in Golomb-Rice coding
/// (R. F. Rice, "Some practical universal noiseless coding techniques", 1979). A random number of 2^48 takes 30 bits in a list of a
/// million; neighbors take a few bits. The same list always produces the same bytes. If `cancel` is raised, from any thread, the output
/// is invalid. `cancel` is null if the call cannot be cancelled.
void append_ascending(std::span<const std::uint64_t> numbers, std::vector<std::uint8_t> &r_bytes,
		const std::atomic<bool> *cancel = nullptr);

/// Removes a list of `count` numbers from the front. Returns false if the bytes do not begin with one, or once `cancel` is raised. Never
/// uses more than 64 times the memory of the bytes.
bool take_ascending(ByteReader &r_bytes, std::size_t count, std::vector<std::uint64_t> &r_numbers,
		const std::atomic<bool> *cancel = nullptr);

} // namespace thicket
