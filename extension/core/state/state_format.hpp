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

/// Which form is written, and the form that release 0.2.0 wrote, which has no origin and no times of writing.
inline constexpr std::uint32_t state_format = 2;
inline constexpr std::uint32_t former_state_format = 1;

/// The front of a stored form.
struct StateHeader {
	enum List { removed, timed, standing, gone, added, with_data, list_count };

	std::uint32_t format = state_format;
	bool whole = true;
	double time = 0.0;
	StateOrigin origin;
	std::map<std::uint16_t, std::uint64_t> stamps;
	std::array<std::uint64_t, list_count>
			sizes{}; ///< Sizes of the lists. The former format has only the first of them here.

	/// How many ids the record names; of the former format those that are removed.
	std::uint64_t named() const { return sizes[removed] + sizes[standing] + sizes[gone] + sizes[added]; }
};

/// Replaces `r_bytes` by the stored form of a record, and by nothing of use once `cancel` was raised.
void write(const StateRecord &record, std::vector<std::uint8_t> &r_bytes, const std::atomic<bool> *cancel = nullptr,
		std::uint32_t format = state_format);

/// Reads the front of a stored form, in microseconds. Does not look whether the rest is whole.
Status read_header(std::span<const std::uint8_t> bytes, StateHeader &r_header);

/// Reads a stored form, and nothing else: what is read is written again to the byte. Refuses more ids and longer data than `limits` allow
/// before it reads them, and a replacement if they allow none. After an error the record is unspecified. Once `cancel` was raised it
/// refuses anything, within some milliseconds.
Status read(std::span<const std::uint8_t> bytes, StateRecord &r_record, const DiffLimits &limits = DiffLimits::none(),
		const std::atomic<bool> *cancel = nullptr);

} // namespace thicket
