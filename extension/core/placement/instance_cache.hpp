#pragma once

#include "core/base/mutex.hpp"
#include "core/base/rect.hpp"
#include "core/placement/layer.hpp"
#include "core/terrain/terrain.hpp"

#include <glm/vec2.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// A point of a layer that passes the rules that depend only on the position.
struct CachedPoint {
	glm::dvec2 position;
	std::uint64_t id;
	Ground ground;
	std::uint32_t thinning_rank; ///< Unused unless the point is an instance.
	bool is_instance;            ///< True if the point passes all rules.
};

/// A layer in a square after its rules. The object does not change after its construction.
class InstanceBlock {
public:
	/// Takes lists in any order. `points` and `sampled`, the positions of all sampled points, are empty
	/// for a layer whose own tiles never come from the cache.
	InstanceBlock(std::vector<glm::dvec2> instances, std::vector<CachedPoint> points, std::vector<glm::dvec2> sampled);

	/// Appends the positions of the instances in `rect` to `r_positions`. Throws std::bad_alloc.
	void add_instances(const Rect &rect, std::vector<glm::dvec2> &r_positions) const;

	/// Appends the points in `rect` to `r_points`, and returns the number of all sampled points
	/// there. Throws std::bad_alloc.
	std::size_t add_points(const Rect &rect, std::vector<CachedPoint> &r_points) const;

	std::size_t bytes() const;

private:
	// All lists are sorted by y, then x.
	std::vector<glm::dvec2> instances_;
	std::vector<CachedPoint> points_;
	std::vector<glm::dvec2> sampled_;
};

/// Caches layers after their rules, in square blocks. The tiles of layers that fill gaps need the
/// instances of earlier layers far beyond the tile, so adjacent tiles and layers share most of them.
/// Without a cache, a chain of such layers generates the first ones again for each tile.
///
/// Instances depend on the settings of the layer, which include those of the layers before it, and
/// on the ground. An edit creates new settings for the edited layer and for all layers that depend on
/// it, so LayerSettings::number and Terrain::version identify all inputs. A game's changes to
/// instances are no input. Threads may share a cache. No call waits for a block that a different
/// thread is generating.
class InstanceCache {
public:
	static constexpr std::size_t default_bytes = std::size_t{32} << 20;

	/// Returns the width and height of the blocks of a layer, in meters. Smaller blocks are sampled
	/// less efficiently. Larger blocks would reach too far beyond the tiles of layers with few
	/// instances.
	static double block_size(const LayerSettings &layer) { return std::min(64.0 * layer.set.radius, 256.0); }

	/// Returns true if the tiles of a layer itself come from the cache, which saves margins if they are
	/// small. `width` is the larger side of the tile.
	static bool has_tiles(const LayerSettings &layer, double width) {
		return fills(layer) && width <= 0.5 * block_size(layer);
	}

	struct Key {
		std::uint64_t layer = 0;  ///< LayerSettings::number.
		std::uint64_t ground = 0; ///< Terrain::version; never 0.
		glm::ivec2 block{0};      ///< The coordinates of a tile of block_size.

		bool operator<(const Key &other) const;
	};

	/// Creates a cache of at most `bytes` bytes, which evicts the least recently used blocks first.
	explicit InstanceCache(std::size_t bytes = default_bytes) : limit_(bytes) {}

	/// The permission to generate a missing block. If it ends without a block, a different caller may
	/// generate the block.
	class Claim {
	public:
		Claim() = default;
		~Claim();
		Claim(const Claim &) = delete;
		Claim &operator=(const Claim &) = delete;

		/// Returns false if the block is present, or if a different caller is generating it.
		explicit operator bool() const { return cache_ != nullptr; }

	private:
		friend class InstanceCache;

		InstanceCache *cache_ = nullptr;
		Key key_;
	};

	/// Returns a block. If it is missing, returns null. If no caller is generating it, `r_claim`
	/// then permits the caller to do so.
	std::shared_ptr<const InstanceBlock> find(const Key &key, Claim &r_claim);

	/// Adds a generated block.
	void add(const Key &key, std::shared_ptr<const InstanceBlock> block);

	/// Returns the memory of all cached blocks.
	std::size_t bytes() const;

private:
	struct Entry {
		std::shared_ptr<const InstanceBlock> block; ///< Null while a caller is generating it.
		std::uint64_t used = 0;                     ///< Value of `clock_` at the latest request.
	};

	void give_up(const Key &key);
	void trim();

	const std::size_t limit_;
	mutable Mutex mutex_;
	std::map<Key, Entry> entries_;
	std::size_t bytes_ = 0;
	std::uint64_t clock_ = 0;
};

} // namespace thicket
