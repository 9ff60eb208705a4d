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

SurfaceLine SurfaceLines::take_first(List &r_list) {
	const List taken = r_list;
	const SurfaceLine line = first(taken);
	r_list = entries_[taken].next;
	free(taken);
	List before_earliest = empty;
	List earliest = r_list;
	for (List before = r_list; before != empty; before = entries_[before].next) {
		const List at = entries_[before].next;
		if (at != empty && first(at).time < first(earliest).time) {
			before_earliest = before;
			earliest = at;
		}
	}
	if (before_earliest != empty) {
		entries_[before_earliest].next = entries_[earliest].next;
		entries_[earliest].next = r_list;
		r_list = earliest;
	}
	return line;
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
