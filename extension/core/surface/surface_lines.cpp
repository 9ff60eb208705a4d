#include "core/surface/surface_lines.hpp"

namespace thicket {

void SurfaceLines::clear() {
	entries_.clear();
	unused_ = empty;
}

void SurfaceLines::add(List &r_list, const SurfaceLine &line) {
	List entry = unused_;
	if (entry == empty) {
		entry = static_cast<List>(entries_.size());
		entries_.emplace_back();
	} else {
		unused_ = entries_[entry].next;
	}
	if (r_list == empty || line.time < first(r_list).time) {
		entries_[entry] = {line, r_list};
		r_list = entry;
	} else {
		entries_[entry] = {line, entries_[r_list].next};
		entries_[r_list].next = entry;
	}
}

void SurfaceLines::replace_first(List &r_list, const SurfaceLine &line) {
	entries_[r_list].line = line;
	move_earliest_first(r_list);
}

void SurfaceLines::drop_first(List &r_list) {
	const List dropped = r_list;
	r_list = entries_[dropped].next;
	free(dropped);
	move_earliest_first(r_list);
}

void SurfaceLines::move_earliest_first(List &r_list) {
	if (r_list == empty) {
		return;
	}
	List before_earliest = empty;
	SurfaceTime earliest = first(r_list).time;
	for (List before = r_list; entries_[before].next != empty; before = entries_[before].next) {
		const SurfaceTime time = first(entries_[before].next).time;
		if (time < earliest) {
			earliest = time;
			before_earliest = before;
		}
	}
	if (before_earliest != empty) {
		const List moved = entries_[before_earliest].next;
		entries_[before_earliest].next = entries_[moved].next;
		entries_[moved].next = r_list;
		r_list = moved;
	}
}

void SurfaceLines::drop(List &r_list) {
	while (r_list != empty) {
		const List dropped = r_list;
		r_list = entries_[dropped].next;
		free(dropped);
	}
}

void SurfaceLines::free(List entry) {
	entries_[entry].next = unused_;
	unused_ = entry;
}

} // namespace thicket
