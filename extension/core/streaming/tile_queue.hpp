#pragma once

#include "core/base/reserve.hpp"

#include <glm/vec2.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace thicket {

/// Tiles of one layer in the order of their distance to one viewer, who moves. Only the nearest are kept in order; of the
/// others no more is known than how near they may have come.
///
/// Where memory ends, std::bad_alloc is thrown and the queue is as it was.
///
/// `measure(Entry &)`, where it is asked for, sets an entry's distance, or returns false for one that is to be thrown out.
class TileQueue {
public:
	struct Entry {
		double distance_squared = 0.0;
		std::uint32_t slot = 0; ///< In the layer's TileTable,
		glm::ivec2 at{0};       ///< if this tile is in it still.
	};

	/// Adds a tile, at any distance. It may be in the queue already.
	void add(std::uint32_t slot, glm::ivec2 at) { fresh_.push_back({0.0, slot, at}); }

	/// The viewer has moved so many meters, or at least not farther.
	void move(double meters) {
		moved_ += meters;
		outdated_ = true;
	}

	/// Works in what was added and the viewer's moves. `first` does, too: this is for those who do not call it for long.
	template <class Measure>
	void sort(Measure &&measure) {
		if (fresh_.empty() && !outdated_) {
			// Fast path: nothing came and nobody moved, so all is in order.
			return;
		}
		if (far_.size() > 2 * far_sorted_ + 4 * batch) {
			sort_all(measure, far_.size()); // Finds what came in twice.
			return;
		}
		if (near_.size() + fresh_.size() > 4 * batch) {
			sort_all(measure, batch);
			return;
		}
		// Fast path: no far entry can have come nearer than the reach, so none of them is measured.
		reserve_more(near_, fresh_.size());
		reserve_more(far_, fresh_.size());
		std::erase_if(near_, [&](Entry &entry) { return !measure(entry); });
		for (Entry &entry : fresh_) {
			if (measure(entry)) {
				(entry.distance_squared <= reach_squared() ? near_ : far_).push_back(entry);
			}
		}
		start_over();
	}

	/// The nearest entry for which `fits(const Entry &)` holds; null for none. One that did not fit will not be asked for
	/// again with the same `cursor`, 0 or 1, until something was added or the viewer has moved.
	template <class Measure, class Fits>
	const Entry *first(std::size_t cursor, Measure &&measure, Fits &&fits) {
		sort(measure);
		std::size_t &at = cursors_[cursor];
		while (true) {
			for (; at < near_.size() && near_[at].distance_squared <= reach_squared(); ++at) {
				if (fits(near_[at])) {
					return &near_[at];
				}
			}
			if (far_.empty()) {
				return nullptr;
			}
			sort_all(measure, 2 * at + batch);
		}
	}

private:
	/// So many are kept in order, at least: more than are asked for in most frames.
	static constexpr std::size_t batch = 64;

	static bool nearer(const Entry &a, const Entry &b) {
		if (a.distance_squared != b.distance_squared) {
			return a.distance_squared < b.distance_squared;
		}
		return a.at.y != b.at.y ? a.at.y < b.at.y : a.at.x < b.at.x;
	}

	/// Nothing far is nearer than this.
	double reach_squared() const {
		const double reach = std::max(far_from_ - moved_, 0.0);
		return far_.empty() ? std::numeric_limits<double>::infinity() : reach * reach;
	}

	template <class Measure>
	void sort_all(Measure &&measure, std::size_t most) {
		reserve_more(near_, far_.size() + fresh_.size());
		reserve_more(far_, near_.size() + fresh_.size()); // Of all, at most.
		near_.insert(near_.end(), far_.begin(), far_.end());
		near_.insert(near_.end(), fresh_.begin(), fresh_.end());
		std::erase_if(near_, [&](Entry &entry) { return !measure(entry); });
		far_.clear();
		if (near_.size() > most) {
			// Fast path: those behind the first `most` need no order.
			const auto end = near_.begin() + static_cast<std::ptrdiff_t>(most);
			std::nth_element(near_.begin(), end, near_.end(), nearer);
			far_from_ = std::sqrt(end->distance_squared);
			far_.assign(end, near_.end());
			near_.erase(end, near_.end());
		}
		far_sorted_ = far_.size();
		moved_ = 0.0;
		start_over();
	}

	void start_over() {
		std::sort(near_.begin(), near_.end(), nearer);
		const auto same = [](const Entry &a, const Entry &b) {
			return a.slot == b.slot && a.at == b.at;
		};
		near_.erase(std::unique(near_.begin(), near_.end(), same), near_.end());
		fresh_.clear();
		cursors_ = {};
		outdated_ = false;
	}

	std::vector<Entry> near_;  ///< In order, as far as `reach_squared`.
	std::vector<Entry> far_;   ///< In no order; as they were when sorted last.
	std::vector<Entry> fresh_; ///< Not measured yet.
	std::array<std::size_t, 2> cursors_{};
	std::size_t far_sorted_ = 0; ///< How many were far when all were sorted last,
	double far_from_ = 0.0;      ///< the distance of the nearest of them, in meters,
	double moved_ = 0.0;         ///< and how far the viewer has moved since.
	bool outdated_ = false;
};

} // namespace thicket
