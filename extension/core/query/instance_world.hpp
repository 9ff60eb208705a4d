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

/// Makes tiles on the spot, in order; null for one that cannot be had or was not made. After an error, that of the first tile which has
/// one, some others may be there.
using TileMaker =
		std::function<Status(std::span<const WorldTile> tiles, std::vector<std::shared_ptr<const KeptTile>> &r_tiles)>;

/// A layer, and x and y of a tile.
using WorldTileKey = std::tuple<std::uint32_t, std::int32_t, std::int32_t>;

inline WorldTileKey key_of(const WorldTile &tile) { return {tile.layer, tile.tile.x, tile.tile.y}; }

/// A tile that is known, for a snapshot.
struct KnownTile {
	WorldTileKey key;
	std::shared_ptr<const KeptTile> tile; ///< Never null.
};

/// What stands in a world, for all who ask: the tiles that are known (shared with those on show, and some that were made for
/// queries) and what a game has changed. One thread at a time.
class InstanceWorld {
public:
	/// The layers as they are from now on. Tiles of a layer whose set or tile size is another are forgotten.
	void set_layers(std::vector<QueryLayer> layers);

	/// The tiles that an edit touches are known no longer. For `known_in` they stand until their successors are there, or all that is
	/// near would vanish for some frames.
	void invalidate(std::uint32_t layer, const EditedArea &area);
	void set_maker(TileMaker maker) { maker_ = std::move(maker); }
	void set_state(const InstanceState *state) {
		state_ = state;
		touch();
	}
	void clear();

	/// Takes a finished tile in. Those that nobody else holds are forgotten, the oldest first and a few for each tile that comes, once
	/// they have more than `max_idle_instances` together.
	void keep(std::uint32_t layer, glm::ivec2 tile, std::shared_ptr<const KeptTile> instances);

	/// The tiles that were forgotten since the last call: to give back their memory takes some time, which another thread may have.
	std::vector<std::shared_ptr<const KeptTile>> take_forgotten();

	/// All known tiles, ascending.
	std::vector<KnownTile> known_tiles() const;

	/// A known tile; null for one that is not.
	std::shared_ptr<const KeptTile> find(const WorldTile &tile) const;

	/// Rises with everything that may change an answer: tiles that came or went, layers, the state.
	std::uint64_t version() const { return version_; }
	void touch();

	/// False if `known_in` returns the same for this rectangle as at that version. May be true without need, for what is long ago.
	bool changed_since(std::uint64_t version, std::uint32_t layer, const Rect &rect) const;

	std::span<const QueryLayer> layers() const { return layers_; }
	const InstanceState *state() const { return state_; }

	/// What stands within a rectangle, meters of the world, in tiles that are known. Those that are not are missed. Adds to `r_found`.
	void known_in(std::uint32_t layer, const Rect &rect, std::vector<PlacedInstance> &r_found) const;

	/// Wants a tile that is not known.
	void miss(const WorldTile &tile) const;

	/// The tiles that somebody wanted since the last call, once each; who still wants them has to say so again.
	std::vector<WorldTile> take_missing();

	/// Runs a query that may make the tiles it misses, on this thread. Whoever calls it holds the world: a script that is asked for the
	/// ground may do anything.
	template <class Query>
	Status ask(Query &&query) {
		const std::vector<QueryLayer> layers = layers_;
		MakingSource source(*this);
		return query(InstanceQuery{layers, source, state_});
	}

	/// The same on what is known alone; what is not counts as empty.
	template <class Query>
	Status ask_known(Query &&query) const {
		KnownSource source(*this);
		return query(InstanceQuery{layers_, source, state_});
	}

	static constexpr std::size_t max_idle_instances = 400'000;

private:
	struct Entry {
		std::shared_ptr<const KeptTile> tile;
		std::size_t size = 0;           ///< See kept_size.
		mutable std::uint64_t used = 0; ///< When it was last asked for.
		bool outdated = false;          ///< An edit has touched it: good enough for who is near, wrong for who asks.
	};

	class KnownSource : public TileSource {
	public:
		explicit KnownSource(const InstanceWorld &world) : world_(world) {}
		Status find_tile(std::uint32_t layer, glm::ivec2 tile, std::shared_ptr<const KeptTile> &r_tile) override;

	private:
		const InstanceWorld &world_;
	};

	/// For `known_in`.
	class NearSource : public TileSource {
	public:
		explicit NearSource(const InstanceWorld &world) : world_(world) {}
		Status find_tile(std::uint32_t layer, glm::ivec2 tile, std::shared_ptr<const KeptTile> &r_tile) override;

	private:
		const InstanceWorld &world_;
	};

	class MakingSource : public MakingTileSource {
	public:
		explicit MakingSource(InstanceWorld &world) : world_(world) {}

	private:
		std::shared_ptr<const KeptTile> find(const WorldTile &tile) override;
		Status make(std::span<const WorldTile> tiles, std::vector<std::shared_ptr<const KeptTile>> &r_tiles) override;
		void keep(const WorldTile &tile, const std::shared_ptr<const KeptTile> &made) override;

		InstanceWorld &world_;
		std::uint64_t edits_ = 0; ///< Of the world, when tiles were asked for last. After others they are not kept.
	};

	using Key = WorldTileKey;

	/// A tile became known, as the only change of that version.
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
	std::uint64_t touched_ = 1;        ///< The version of the last change that may be anywhere.
	std::deque<TileChange> new_tiles_; ///< The changes since then, in order.
	std::uint64_t edits_ = 0;          ///< Rises with everything that makes tiles outdated.
	mutable std::uint64_t uses_ = 0;

	std::size_t kept_since_looking_ = 0;              ///< Instances.
	std::optional<Key> look_from_;                    ///< The first tile that is still to be looked at for idle ones.
	std::vector<std::pair<std::uint64_t, Key>> idle_; ///< By when they were used last: a heap, once all were looked at.
	std::size_t idle_instances_ = 0;
	std::vector<std::shared_ptr<const KeptTile>> forgotten_;
	mutable std::set<Key> missing_;
};

} // namespace thicket
