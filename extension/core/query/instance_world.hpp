#pragma once

#include "core/placement/layer_edits.hpp"
#include "core/query/instance_query.hpp"
#include "core/query/making_tile_source.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

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

/// Generates tiles immediately, in order; null for a tile that is not available or was not generated. Returns the error
/// of the first tile that failed; after an error, some other tiles may exist.
using TileMaker = std::function<Status(
		std::span<const WorldTile> tiles, std::vector<std::shared_ptr<const CompactTile>> &r_tiles)>;

/// A layer, and x and y of a tile.
using WorldTileKey = std::tuple<std::uint32_t, std::int32_t, std::int32_t>;

inline WorldTileKey key_of(const WorldTile &tile) { return {tile.layer, tile.tile.x, tile.tile.y}; }

/// A known tile, for a snapshot.
struct KnownTile {
	WorldTileKey key;
	std::shared_ptr<const CompactTile> tile; ///< Never null.
};

/// The instances of a world, for all queries: the known tiles (shared with the visible ones, and some that were generated for queries) and
/// the changes of a game. One thread at a time.
class InstanceWorld {
public:
	/// Replaces the layers. Tiles of a layer whose set or tile size has changed are dropped.
	void set_layers(std::vector<QueryLayer> layers);

	/// Marks the tiles that an edit touches as no longer known. `known_in` keeps using them until they are replaced.
	/// Otherwise all nearby instances would vanish for some frames.
	void invalidate(std::uint32_t layer, const EditedArea &area);
	void set_maker(TileMaker maker) { maker_ = std::move(maker); }
	void set_state(const InstanceState *state) {
		state_ = state;
		touch();
	}
	void clear();

	/// Adds a finished tile. Tiles that no other code uses are dropped once they have more than `max_idle_instances` in
	/// total. The oldest are dropped first, a few for each tile that is added.
	void keep(std::uint32_t layer, glm::ivec2 tile, std::shared_ptr<const CompactTile> instances);

	/// The tiles that were dropped since the last call. Freeing their memory takes some time, so a different thread may do it.
	std::vector<std::shared_ptr<const CompactTile>> take_forgotten();

	/// All known tiles, ascending.
	std::vector<KnownTile> known_tiles() const;

	/// A known tile; null if it is not known.
	std::shared_ptr<const CompactTile> find(const WorldTile &tile) const;

	/// Increases with everything that may change a result: tiles that are added or dropped, layers, the state.
	std::uint64_t version() const { return version_; }
	void touch();

	/// False if `known_in` returns the same result for this rectangle as at that version. For old versions, may return
	/// true although nothing has changed.
	bool changed_since(std::uint64_t version, std::uint32_t layer, const Rect &rect) const;

	std::span<const QueryLayer> layers() const { return layers_; }
	const InstanceState *state() const { return state_; }

	/// Finds the instances within a rectangle, in world meters, in known tiles. Unknown tiles are recorded as missing. Adds to `r_found`.
	void known_in(std::uint32_t layer, const Rect &rect, std::vector<PlacedInstance> &r_found) const;

	/// Requests a tile that is not known.
	void miss(const WorldTile &tile) const;

	/// The tiles that were requested since the last call, each once. A caller that still needs them must request them again.
	std::vector<WorldTile> take_missing();

	/// Runs a query that may generate the tiles it misses, on this thread. The caller must keep the world alive, because a script that is
	/// queried for the ground may do anything.
	template <class Query>
	Status ask(Query &&query) {
		const std::vector<QueryLayer> layers = layers_;
		MakingSource source(*this);
		return query(InstanceQuery{layers, source, state_});
	}

	/// Runs a query that reads known tiles only; unknown tiles count as empty.
	template <class Query>
	Status ask_known(Query &&query) const {
		KnownSource source(*this);
		return query(InstanceQuery{layers_, source, state_});
	}

	static constexpr std::size_t max_idle_instances = 400'000;

private:
	struct Entry {
		std::shared_ptr<const CompactTile> tile;
		std::size_t size = 0;           ///< See kept_size.
		mutable std::uint64_t used = 0; ///< The time of the last query that used it.
		bool outdated = false;          ///< An edit has touched it: still valid for `known_in`, but not for queries.
	};

	class KnownSource : public TileSource {
	public:
		explicit KnownSource(const InstanceWorld &world) : world_(world) {}
		Status find_tile(std::uint32_t layer, glm::ivec2 tile, std::shared_ptr<const CompactTile> &r_tile) override;

	private:
		const InstanceWorld &world_;
	};

	/// For `known_in`.
	class NearSource : public TileSource {
	public:
		explicit NearSource(const InstanceWorld &world) : world_(world) {}
		Status find_tile(std::uint32_t layer, glm::ivec2 tile, std::shared_ptr<const CompactTile> &r_tile) override;

	private:
		const InstanceWorld &world_;
	};

	class MakingSource : public MakingTileSource {
	public:
		explicit MakingSource(InstanceWorld &world) : world_(world) {}

	private:
		std::shared_ptr<const CompactTile> find(const WorldTile &tile) override;
		Status make(
				std::span<const WorldTile> tiles, std::vector<std::shared_ptr<const CompactTile>> &r_tiles) override;
		void keep(const WorldTile &tile, const std::shared_ptr<const CompactTile> &made) override;

		InstanceWorld &world_;
		/// The edits of the world when tiles were last requested. After further edits, generated tiles are not kept.
		std::uint64_t edits_ = 0;
	};

	using Key = WorldTileKey;

	/// A tile that became known, as the only change of that version.
	struct TileChange {
		std::uint64_t version = 0;
		std::uint32_t layer = 0;
		Rect rect;
	};
	static constexpr std::size_t most_new_tiles = 256;

	void look_for_idle();
	void forget_some();

	std::vector<QueryLayer> layers_;
	std::map<Key, Entry> tiles_;
	TileMaker maker_;
	const InstanceState *state_ = nullptr;
	std::uint64_t version_ = 1;
	std::uint64_t touched_ = 1;        ///< The version of the last change that may affect any position.
	std::deque<TileChange> new_tiles_; ///< The changes since then, in order.
	std::uint64_t edits_ = 0;          ///< Increases with everything that makes tiles outdated.
	mutable std::uint64_t uses_ = 0;

	std::size_t kept_since_looking_ = 0;              ///< Number of instances.
	std::optional<Key> look_from_;                    ///< The first tile that is still to be checked for being idle.
	std::vector<std::pair<std::uint64_t, Key>> idle_; ///< By time of last use; a heap, once all are checked.
	std::size_t idle_instances_ = 0;
	std::vector<std::shared_ptr<const CompactTile>> forgotten_;
	mutable std::set<Key> missing_;
};

} // namespace thicket
