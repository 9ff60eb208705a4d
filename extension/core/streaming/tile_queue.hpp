#pragma once

#include "core/base/reserve.hpp"

#include <glm/vec3.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace thicket {

/// Tiles of one layer, ordered by distance to one moving viewer. Only the nearest tiles are sorted.
/// For the remaining tiles, the queue maintains a lower bound of their distance.
///
/// If memory runs out, methods throw std::bad_alloc and leave the queue unchanged.
///
/// The `measure` arguments are functions that update the distance of an Entry. They return false if
/// the entry must be removed.
class TileQueue {
public:
	struct Entry {
		double distance_squared = 0.0;
		std::uint32_t slot = 0; ///< Slot in the layer's TileTable, if the tile still exists.
		glm::ivec3 at{0};       ///< Column, row and slab of the tile.
	};

	/// Adds a tile at any distance. It may already be in the queue.
	void add(std::uint32_t slot, glm::ivec3 at) { fresh_.push_back({0.0, slot, at}); }

	/// Reports that the viewer has moved by at most `meters`.
	void move(double meters) {
		moved_ += meters;
		outdated_ = true;
	}

	/// Updates the order after tiles were added or the viewer has moved. `first` calls it. Call
	/// `sort` to limit the queue's size if `first` is not called for a long time.
	template <class Measure>
	void sort(Measure &&measure) {
		if (fresh_.empty() && !outdated_) {
			// No tile was added and the viewer has not moved, so the order is up to date.
			return;
		}
		if (far_.size() > 2 * far_sorted_ + 4 * batch) {
			sort_all(measure, far_.size()); // This sort also removes duplicates.
			return;
		}
		if (near_.size() + fresh_.size() > 4 * batch) {
			sort_all(measure, batch);
			return;
		}
		// No far entry can be nearer than the reach, so far entries need not be measured.
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

	/// Returns the nearest entry for which `fits(entry)` is true, or null if there is none. An
	/// entry that does not fit is not tested again with the same `cursor` (0 or 1) until a tile is
	/// added or the viewer moves.
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
	/// The minimum number of sorted entries. Most frames use fewer.
	static constexpr std::size_t batch = 64;

	static bool nearer(const Entry &a, const Entry &b) {
		if (a.distance_squared != b.distance_squared) {
			return a.distance_squared < b.distance_squared;
		}
		if (a.at.y != b.at.y) {
			return a.at.y < b.at.y;
		}
		return a.at.x != b.at.x ? a.at.x < b.at.x : a.at.z < b.at.z;
	}

	/// Returns a lower bound for the squared distance of all far entries.
	double reach_squared() const {
		const double reach = std::max(far_from_ - moved_, 0.0);
		return far_.empty() ? std::numeric_limits<double>::infinity() : reach * reach;
	}

	template <class Measure>
	void sort_all(Measure &&measure, std::size_t max_count) {
		reserve_more(near_, far_.size() + fresh_.size());
		reserve_more(far_, near_.size() + fresh_.size()); // Any entry may become a far one.
		near_.insert(near_.end(), far_.begin(), far_.end());
		near_.insert(near_.end(), fresh_.begin(), fresh_.end());
		std::erase_if(near_, [&](Entry &entry) { return !measure(entry); });
		far_.clear();
		if (near_.size() > max_count) {
			// Entries after the first `max_count` are not sorted.
			const auto end = near_.begin() + static_cast<std::ptrdiff_t>(max_count);
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

	std::vector<Entry> near_;  ///< Sorted entries. The order is reliable up to `reach_squared`.
	std::vector<Entry> far_;   ///< Unsorted entries, with their last measured distances.
	std::vector<Entry> fresh_; ///< Entries that have not been measured yet.
	std::array<std::size_t, 2> cursors_{};
	std::size_t far_sorted_ = 0; ///< Number of far entries at the last full sort.
	double far_from_ = 0.0;      ///< Distance in meters of the nearest far entry at the last full sort.
	double moved_ = 0.0;         ///< Meters by which the viewer has moved since the last full sort.
	bool outdated_ = false;
};

} // namespace thicket
