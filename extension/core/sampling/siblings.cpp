#include "core/sampling/siblings.hpp"

namespace thicket {

void SiblingPool::grow() {
	// Less than doubling: the pool is a large part of a cell's 64 bytes.
	const std::size_t size = entries_.size() + entries_.size() / 4 + 64;
	entries_.reserve(size);
	entries_.resize(size);
}

} // namespace thicket
