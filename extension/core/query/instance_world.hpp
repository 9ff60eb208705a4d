#pragma once

#include "core/placement/layer_edits.hpp"
#include "core/query/instance_query.hpp"
#include "core/query/generating_tile_source.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

namespace thicket {

/// Generates tiles immediately, in order. The entry of a tile that is not available or was not
/// generated is null. Returns the error of the first tile that failed; other tiles may then still
/// have been generated.
using TileMaker = std::function<Status(
		std::span<const WorldTile> tiles, std::vector<std::shared_ptr<const CompactTile>> &r_tiles)>;

/// The layer, x, y and slab of a tile.
using WorldTileKey = std::tuple<std::uint32_t, std::int32_t, std::int32_t, std::int32_t>;

inline WorldTileKey key_of(const WorldTile &tile) { return {tile.layer, tile.tile.x, tile.tile.y, tile.slab}; }

/// A known tile with its key.
struct KnownTile {
	WorldTileKey key;
	std::shared_ptr<const CompactTile> tile; ///< The content of the tile; never null.
};

/// The instances of a world, for all queries. The object stores the known tiles, which are visible
/// tiles and tiles generated for queries, and refers to the state with a game's changes. Use it on
/// one thread only.
class InstanceWorld {
public:
	/// Replaces the layers. Tiles of a layer whose set or tile size has changed are dropped.
	void set_layers(std::vector<QueryLayer> layers);

	/// Marks the tiles that an edit touches as outdated, so that queries no longer use them. Only
	/// `known_in` uses outdated tiles, until they are replaced, because nearby instances would
	/// otherwise vanish for a few frames.
	void invalidate(std::uint32_t layer, const EditedArea &area);
	void set_maker(TileMaker maker) { maker_ = std::move(maker); }
	void set_state(const InstanceState *state) {
		state_ = state;
		touch();
	}
	void clear();

	/// Adds a finished tile. A tile is idle if only this object references it. Once idle tiles have
	/// more than `max_idle_instances` instances in total, each call drops a few of these tiles, the
	/// least recently used first.
	void keep(const WorldTile &tile, std::shared_ptr<const CompactTile> instances);

	/// Returns the tiles dropped since the last call, so that the caller can free their memory on
	/// another thread.
	std::vector<std::shared_ptr<const CompactTile>> take_forgotten();

	/// Returns all known tiles that are not outdated, ascending by key.
	std::vector<KnownTile> known_tiles() const;

	/// Returns a tile, or null if it is unknown or outdated.
	std::shared_ptr<const CompactTile> find(const WorldTile &tile) const;

	/// Returns a number that increases with every change that may affect results: added or outdated
	/// tiles, layers, the state.
	std::uint64_t version() const { return version_; }
	void touch();

	/// Returns false only if `known_in` returns the same result for this rectangle as it did at
	/// `version`. For old versions, may return true even if nothing has changed.
	bool changed_since(std::uint64_t version, std::uint32_t layer, const Rect &rect) const;

	std::span<const QueryLayer> layers() const { return layers_; }
	const InstanceState *state() const { return state_; }

	/// Appends the instances in `space` (world meters), using only known tiles, including outdated
	/// ones. Unknown and outdated tiles are recorded as missing.
	void known_in(std::uint32_t layer, const TileSpace &space, std::vector<PlacedInstance> &r_found) const;

	/// Records a tile as missing.
	void miss(const WorldTile &tile) const;

	/// Returns the tiles recorded as missing since the last call, without duplicates and without
	/// tiles that are known by now. Tiles that are still needed must be recorded again.
	std::vector<WorldTile> take_missing();

	/// Runs a query that may generate missing tiles, on this thread. The caller must keep the world
	/// alive during the call, because a script that provides the ground may run arbitrary code.
	template <class Query>
	Status answer(Query &&query) {
		const std::vector<QueryLayer> layers = layers_;
		GeneratingSource source(*this);
		return query(InstanceQuery{layers, source, state_});
	}

	/// Runs a query that uses known tiles only. Unknown tiles are treated as empty.
	template <class Query>
	Status query_known(Query &&query) const {
		KnownSource source(*this);
		return query(InstanceQuery{layers_, source, state_});
	}

	static constexpr std::size_t max_idle_instances = 400'000;

private:
	struct Entry {
		std::shared_ptr<const CompactTile> tile;
		std::size_t size = 0;           ///< Size of the tile; see kept_size.
		mutable std::uint64_t used = 0; ///< Counter value of the last use.
		/// True after an edit touched the tile. An outdated tile is used only by `known_in`.
		bool outdated = false;
	};

	class KnownSource : public TileSource {
	public:
		explicit KnownSource(const InstanceWorld &world) : world_(world) {}
		Status find_tile(const WorldTile &tile, std::shared_ptr<const CompactTile> &r_tile) override;

	private:
		const InstanceWorld &world_;
	};

	/// The source for `known_in`. It also returns outdated tiles, and records missing ones.
	class NearSource : public TileSource {
	public:
		explicit NearSource(const InstanceWorld &world) : world_(world) {}
		Status find_tile(const WorldTile &tile, std::shared_ptr<const CompactTile> &r_tile) override;

	private:
		const InstanceWorld &world_;
	};

	class GeneratingSource : public GeneratingTileSource {
	public:
		explicit GeneratingSource(InstanceWorld &world) : world_(world) {}

	private:
		std::shared_ptr<const CompactTile> find(const WorldTile &tile) override;
		Status make(
				std::span<const WorldTile> tiles, std::vector<std::shared_ptr<const CompactTile>> &r_tiles) override;
		void keep(const WorldTile &tile, const std::shared_ptr<const CompactTile> &generated) override;

		InstanceWorld &world_;
		/// The value of the world's `edits_` when tiles were last requested. If the world's value
		/// has changed since, generated tiles are not kept.
		std::uint64_t edits_ = 0;
	};

	using Key = WorldTileKey;

	/// A version in which the only change was an added tile.
	struct TileChange {
		std::uint64_t version = 0;
		std::uint32_t layer = 0;
		Rect rect;
	};
	static constexpr std::size_t max_new_tiles = 256;

	void find_idle();
	void forget_some();

	std::vector<QueryLayer> layers_;
	std::map<Key, Entry> tiles_;
	TileMaker maker_;
	const InstanceState *state_ = nullptr;
	std::uint64_t version_ = 1;
	std::uint64_t touched_ = 1;        ///< The version of the last change that may affect any position.
	std::deque<TileChange> new_tiles_; ///< Changes after `touched_`, in order of version.
	std::uint64_t edits_ = 0;          ///< Increases with every change that may outdate tiles.
	mutable std::uint64_t uses_ = 0;

	std::size_t added_since_idle_check_ = 0; ///< Instances added since the last check for idle tiles.
	/// The next tile to check for being idle; empty if no check is in progress.
	std::optional<Key> next_idle_check_;
	/// Idle tiles with their last use. The list is a heap once the check is complete.
	std::vector<std::pair<std::uint64_t, Key>> idle_;
	std::size_t idle_instances_ = 0;
	std::vector<std::shared_ptr<const CompactTile>> forgotten_;
	mutable std::set<Key> missing_;
};

} // namespace thicket
