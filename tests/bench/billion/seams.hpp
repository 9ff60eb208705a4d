#pragma once

#include "region.hpp"

#include <glm/vec2.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <utility>
#include <vector>

namespace thicket::bench::billion {

/// The points of a tile that can be too close to points of another tile, in lattice units of the
/// whole set.
using Rim = std::vector<glm::ivec2>;

/// Keeps the rims of finished tiles while any of their neighbors is missing. When a tile is
/// finished, it gets the rims of the neighbors that were finished earlier. This works for any order
/// of tiles. Several threads may use one object.
class Seams {
public:
	explicit Seams(const Region &region) : region_(region), done_(region.tiles()) {}

	/// Stores a finished tile's rim, and returns the rims of the neighbors that were finished
	/// earlier, so that each pair of neighbors is compared once. If the tile was already finished,
	/// the repetition is counted and the result is empty.
	std::vector<std::shared_ptr<const Rim>> finish(glm::ivec2 tile_position, Rim &&rim) {
		auto shared = std::make_shared<const Rim>(std::move(rim));
		std::vector<std::shared_ptr<const Rim>> earlier_rims;
		const std::lock_guard lock(mutex_);
		if (done_[region_.index_of(tile_position)]) {
			++repeated_;
			return earlier_rims;
		}
		done_[region_.index_of(tile_position)] = true;
		++finished_;
		std::uint32_t neighbors = 0;
		for (std::int32_t step = 0; step < 9; ++step) {
			const glm::ivec2 neighbor = tile_position + glm::ivec2(step % 3 - 1, step / 3 - 1);
			if (step == 4 || !region_.has_tile(neighbor)) {
				continue;
			}
			++neighbors;
			const auto entry = kept_.find(region_.index_of(neighbor));
			if (entry != kept_.end()) {
				earlier_rims.push_back(entry->second.rim);
				if (--entry->second.missing == 0) {
					drop(entry);
				}
			}
		}
		keep(tile_position, std::move(shared), neighbors - static_cast<std::uint32_t>(earlier_rims.size()));
		return earlier_rims;
	}

	/// Returns the number of finished tiles, each counted once.
	std::uint64_t finished() const {
		const std::lock_guard lock(mutex_);
		return finished_;
	}
	/// Returns the number of calls for tiles that were already finished.
	std::uint64_t repeated() const {
		const std::lock_guard lock(mutex_);
		return repeated_;
	}
	/// Returns the maximum number of points that were kept at once.
	std::size_t max_kept() const {
		const std::lock_guard lock(mutex_);
		return max_kept_;
	}

private:
	struct Kept {
		std::shared_ptr<const Rim> rim;
		std::uint32_t missing; ///< The number of unfinished neighbors.
	};
	using Map = std::unordered_map<std::uint64_t, Kept>;

	Region region_;
	mutable std::mutex mutex_;
	Map kept_;
	std::vector<bool> done_;
	std::uint64_t finished_ = 0;
	std::uint64_t repeated_ = 0;
	std::size_t points_kept_ = 0;
	std::size_t max_kept_ = 0;

	void keep(glm::ivec2 tile_position, std::shared_ptr<const Rim> rim, std::uint32_t missing) {
		if (missing > 0) {
			points_kept_ += rim->size();
			max_kept_ = std::max(max_kept_, points_kept_);
			kept_.emplace(region_.index_of(tile_position), Kept{std::move(rim), missing});
		}
	}

	void drop(Map::iterator kept) {
		points_kept_ -= kept->second.rim->size();
		kept_.erase(kept);
	}
};

} // namespace thicket::bench::billion
