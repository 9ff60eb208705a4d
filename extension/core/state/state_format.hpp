#pragma once

#include "core/base/status.hpp"
#include "core/state/diff_limits.hpp"
#include "core/state/state_record.hpp"

#include <array>
#include <atomic>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace thicket {

/// The format that is written, and the format of release 0.2.0, which has no origin and no times of writes.
inline constexpr std::uint32_t state_format = 2;
inline constexpr std::uint32_t former_state_format = 1;

/// The front of a serialized state.
struct StateHeader {
	enum List { removed, timed, standing, gone, added, with_data, list_count };

	std::uint32_t format = state_format;
	bool whole = true;
	double time = 0.0;
	StateOrigin origin;
	std::map<std::uint16_t, std::uint64_t> stamps;
	std::array<std::uint64_t, list_count>
			sizes{}; ///< Sizes of the lists. The former format only has the first of them here.

	/// The number of ids in the record; in the former format, the number of removed ids.
	std::uint64_t named() const { return sizes[removed] + sizes[standing] + sizes[gone] + sizes[added]; }
};

/// Replaces `r_bytes` with the serialized record. The output is invalid once `cancel` is raised.
void write(const StateRecord &record, std::vector<std::uint8_t> &r_bytes, const std::atomic<bool> *cancel = nullptr,
		std::uint32_t format = state_format);

/// Reads the front of a serialized state, in microseconds. Does not check whether the rest is complete.
Status read_header(std::span<const std::uint8_t> bytes, StateHeader &r_header);

/// Reads a serialized state. Accepts only bytes that `write` would reproduce exactly. Refuses more ids and longer data than `limits`
/// permit before it reads them, and a replacement if they permit none. After an error the record is unspecified. Once `cancel` is raised,
/// refuses any input within some milliseconds.
Status read(std::span<const std::uint8_t> bytes, StateRecord &r_record, const DiffLimits &limits = DiffLimits::none(),
		const std::atomic<bool> *cancel = nullptr);

} // namespace thicket
