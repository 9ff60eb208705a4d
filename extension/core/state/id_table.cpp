#include "core/state/id_table.hpp"

#include <atomic>
#include <random>

namespace thicket {

std::uint64_t salt_of_this_run() {
	static const std::uint64_t salt = split_mix(std::random_device{}());
	return salt;
}

std::uint64_t new_table_owner() {
	static std::atomic<std::uint64_t> last{0};
	return last.fetch_add(1, std::memory_order_relaxed) + 1;
}

} // namespace thicket
