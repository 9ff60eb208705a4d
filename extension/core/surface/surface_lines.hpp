#pragma once

#include "core/surface/surface_dart.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// The lines that wait in each cell of a race: short lists that share one pool. The first line of a list is its earliest, the others are in no
/// order.
class SurfaceLines {
public:
	/// A list is the number of its first line.
	using List = std::uint32_t;
	static constexpr List empty = ~List{0};

	/// Forgets all lists, and keeps the memory.
	void clear();

	const SurfaceLine &first(List list) const { return entries_[list].line; }
	void add(List &r_list, const SurfaceLine &line);
	SurfaceLine take_first(List &r_list);
	void drop(List &r_list);

	std::size_t bytes() const { return entries_.capacity() * sizeof(Entry); }

private:
	struct Entry {
		SurfaceLine line;
		List next;
	};
	void free(List entry);

	std::vector<Entry> entries_;
	List unused_ = empty;
};

} // namespace thicket
