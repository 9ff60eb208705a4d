#pragma once

#include "core/surface/surface_dart.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace thicket {

/// Stores, for each cell of a SurfaceRace, the lines that have not been thrown yet: short linked lists
/// in one common pool. The first line of a list is the earliest; the others are unordered.
class SurfaceLines {
public:
	/// The index of a list's first entry, or `empty`.
	using List = std::uint32_t;
	static constexpr List empty = ~List{0};

	/// Removes all lists and keeps the memory.
	void clear();

	const SurfaceLine &first(List list) const { return entries_[list].line; }
	void add(List &r_list, const SurfaceLine &line);
	void replace_first(List &r_list, const SurfaceLine &line);
	void drop_first(List &r_list);
	void drop(List &r_list);

	std::size_t bytes() const { return entries_.capacity() * sizeof(Entry); }

private:
	struct Entry {
		SurfaceLine line;
		List next;
	};
	void free(List entry);
	/// Moves the earliest line to the front, after the first line has changed. The others stay unordered.
	void move_earliest_first(List &r_list);

	std::vector<Entry> entries_;
	List unused_ = empty;
};

} // namespace thicket
