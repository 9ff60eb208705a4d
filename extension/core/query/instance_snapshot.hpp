#pragma once

#include "core/base/mutex.hpp"
#include "core/query/instance_query.hpp"
#include "core/query/instance_world.hpp"

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

namespace thicket {

/// A snapshot of a world, for concurrent queries on any number of threads. Queries return the
/// results that the world would have returned when the snapshot was taken. The snapshot keeps the
/// tiles that were known then and generates others on the thread of the query.
class InstanceSnapshot {
public:
	/// Copies `world`. `state` is a copy of the world's state (InstanceState::share), or empty if
	/// nothing was changed. `maker` must be thread-safe. If it returns an error for a tile, queries
	/// that need this tile fail.
	InstanceSnapshot(const InstanceWorld &world, std::optional<InstanceState> state, TileMaker maker);

	/// Runs a query, as InstanceWorld::answer does.
	template <class Query>
	Status answer(Query &&query) const {
		Source source(*this);
		const Status status = complete_state();
		return status.ok() ? query(InstanceQuery{layers_, source, state()}) : status;
	}

	std::span<const QueryLayer> layers() const { return layers_; }

	/// Returns the state, or null if nothing was changed.
	const InstanceState *state() const { return state_.has_value() ? &*state_ : nullptr; }

	/// Generated tiles are dropped once they contain more instances than this in total.
	static constexpr std::size_t max_generated_instances = 400'000;

private:
	using Tile = std::shared_ptr<const CompactTile>;

	class Source : public GeneratingTileSource {
	public:
		explicit Source(const InstanceSnapshot &snapshot) : snapshot_(snapshot) {}

	private:
		Tile find(const WorldTile &tile) override;
		Status make(std::span<const WorldTile> tiles, std::vector<Tile> &r_tiles) override;
		void keep(const WorldTile &tile, const Tile &generated) override;

		const InstanceSnapshot &snapshot_;
	};

	Status complete_state() const;
	Tile find(const WorldTile &tile) const;
	void keep(const WorldTile &tile, const Tile &generated) const;

	std::vector<QueryLayer> layers_;
	std::vector<KnownTile> known_; ///< Tiles that were known when the snapshot was taken, ascending by key.
	TileMaker maker_;

	mutable Mutex mutex_; ///< Protects all members below, except `state_` once it is complete.
	mutable std::optional<InstanceState> state_;
	mutable bool complete_ = false;
	mutable std::map<WorldTileKey, Tile> generated_;
	mutable std::size_t generated_instances_ = 0;
};

} // namespace thicket
