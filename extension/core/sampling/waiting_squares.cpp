#include "core/sampling/waiting_squares.hpp"

#include <algorithm>

namespace thicket {

void WaitingSquares::clear() { used_ = 1; }

void WaitingSquares::grow(std::uint32_t more) {
	constexpr std::size_t first_slots = 1024;
	const std::size_t size = std::max({first_slots, 2 * slots_.size(), std::size_t{used_} + more});
	followers_.resize(size);
	slots_.resize(size);
	slots_.front().time.fill(time_never);
}

} // namespace thicket
