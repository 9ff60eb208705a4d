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

/// Tiles of one layer, sorted by distance to one moving viewer. Only the nearest tiles are kept in order. For all
/// others, the queue only stores how near they may have come.
///
/// If memory runs out, methods throw std::bad_alloc and the queue is unchanged.
///
/// A `measure(Entry &)` argument sets an entry's distance, or returns false for an entry that must be removed.
class TileQueue {
public:
	struct Entry {
		double distance_squared = 0.0;
		std::uint32_t slot = 0; ///< In the layer's TileTable,
		glm::ivec2 at{0};       ///< if this tile is in it still.
	};

	/// Adds a tile at any distance. It may already be in the queue.
	void add(std::uint32_t slot, glm::ivec2 at) { fresh_.push_back({0.0, slot, at}); }

	/// Reports that the viewer has moved at most `meters`.
	void move(double meters) {
		moved_ += meters;
		outdated_ = true;
	}

	/// Sorts in the added tiles and the viewer's moves. `first` does so too. Callers that do not call `first` for a long time should call
	/// this.
	template <class Measure>
	void sort(Measure &&measure) {
		if (fresh_.empty() && !outdated_) {
			// No tile was added and the viewer has not moved, so all entries are in order.
			return;
		}
		if (far_.size() > 2 * far_sorted_ + 4 * batch) {
			sort_all(measure, far_.size()); // Removes duplicates.
			return;
		}
		if (near_.size() + fresh_.size() > 4 * batch) {
			sort_all(measure, batch);
			return;
		}
		// No far entry can be nearer than the reach, so none of them is measured.
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

	/// Returns the nearest entry for which `fits(const Entry &)` holds, or null if there is none. If an entry does not
	/// fit, it is not tested again with the same `cursor` (0 or 1) until a tile is added or the viewer has moved.
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
	/// The minimum number of entries kept in order: more than are used in most frames.
	static constexpr std::size_t batch = 64;

	static bool nearer(const Entry &a, const Entry &b) {
		if (a.distance_squared != b.distance_squared) {
			return a.distance_squared < b.distance_squared;
		}
		return a.at.y != b.at.y ? a.at.y < b.at.y : a.at.x < b.at.x;
	}

	/// No far entry is nearer than this.
	double reach_squared() const {
		const double reach = std::max(far_from_ - moved_, 0.0);
		return far_.empty() ? std::numeric_limits<double>::infinity() : reach * reach;
	}

	template <class Measure>
	void sort_all(Measure &&measure, std::size_t most) {
		reserve_more(near_, far_.size() + fresh_.size());
		reserve_more(far_, near_.size() + fresh_.size()); // Upper bound: all entries.
		near_.insert(near_.end(), far_.begin(), far_.end());
		near_.insert(near_.end(), fresh_.begin(), fresh_.end());
		std::erase_if(near_, [&](Entry &entry) { return !measure(entry); });
		far_.clear();
		if (near_.size() > most) {
			// The entries behind the first `most` need no order.
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

	std::vector<Entry> near_;  ///< Sorted, up to `reach_squared`.
	std::vector<Entry> far_;   ///< Unsorted, with the distances last measured.
	std::vector<Entry> fresh_; ///< Not measured yet.
	std::array<std::size_t, 2> cursors_{};
	std::size_t far_sorted_ = 0; ///< Number of far entries at the last full sort.
	double far_from_ = 0.0;      ///< Distance of the nearest of them, in meters.
	double moved_ = 0.0;         ///< Meters that the viewer has moved since then.
	bool outdated_ = false;
};

} // namespace thicket
