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

/// The current format, and the format of release 0.2.0, which has no origin and no times of writes.
inline constexpr std::uint32_t state_format = 2;
inline constexpr std::uint32_t former_state_format = 1;

/// The header of a serialized state.
struct StateHeader {
	enum List { removed, timed, present, removed_placed, added, with_data, list_count };

	std::uint32_t format = state_format;
	bool is_complete = true; ///< False for a diff.
	double time = 0.0;
	StateOrigin origin;
	std::map<std::uint16_t, std::uint64_t> stamps;
	/// Sizes of the lists. For the former format, only the first size is set here.
	std::array<std::uint64_t, list_count> sizes{};

	/// Returns the number of IDs in the record. In the former format, it counts only the removed
	/// points.
	std::uint64_t named() const { return sizes[removed] + sizes[present] + sizes[removed_placed] + sizes[added]; }
};

/// Replaces `r_bytes` with the serialized record. The output is invalid if `cancel` is set during
/// the call.
void write(const StateRecord &record, std::vector<std::uint8_t> &r_bytes, const std::atomic<bool> *cancel = nullptr,
		std::uint32_t format = state_format);

/// Reads the header of a serialized state, which takes microseconds. The remaining bytes are not
/// checked.
Status read_header(std::span<const std::uint8_t> bytes, StateHeader &r_header);

/// Reads a serialized state. Only bytes that `write` would reproduce exactly are accepted. `limits`
/// are checked before more IDs or data are read than they permit. A replacement that they do not
/// allow is an error. After an error, the content of the record is unspecified. After `cancel` is
/// set, the function fails within a few milliseconds.
Status read(std::span<const std::uint8_t> bytes, StateRecord &r_record, const DiffLimits &limits = DiffLimits::none(),
		const std::atomic<bool> *cancel = nullptr);

} // namespace thicket
