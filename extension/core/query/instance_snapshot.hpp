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

/// The state of a world at one moment, for queries on any number of threads at the same time. Queries return the same
/// results as the world did at that moment. The snapshot contains the tiles that were known at that moment, and
/// generates others on the thread of the query.
class InstanceSnapshot {
public:
	/// Copies `world`. `state` shares the memory of the world's state (InstanceState::share); it is empty if nothing
	/// was changed. `maker` is called on several threads at the same time. It may refuse a tile; queries that need this
	/// tile are then refused.
	InstanceSnapshot(const InstanceWorld &world, std::optional<InstanceState> state, TileMaker maker);

	/// Runs a query, as InstanceWorld::ask does.
	template <class Query>
	Status ask(Query &&query) const {
		Source source(*this);
		const Status status = complete_state();
		return status.ok() ? query(InstanceQuery{layers_, source, state()}) : status;
	}

	std::span<const QueryLayer> layers() const { return layers_; }

	/// Null if nothing was changed.
	const InstanceState *state() const { return state_.has_value() ? &*state_ : nullptr; }

	/// Tiles that queries have generated are dropped once they have more instances than this in total.
	static constexpr std::size_t max_made_instances = 400'000;

private:
	using Tile = std::shared_ptr<const CompactTile>;

	class Source : public MakingTileSource {
	public:
		explicit Source(const InstanceSnapshot &snapshot) : snapshot_(snapshot) {}

	private:
		Tile find(const WorldTile &tile) override;
		Status make(std::span<const WorldTile> tiles, std::vector<Tile> &r_tiles) override;
		void keep(const WorldTile &tile, const Tile &made) override;

		const InstanceSnapshot &snapshot_;
	};

	Status complete_state() const;
	Tile find(const WorldTile &tile) const;
	void keep(const WorldTile &tile, const Tile &made) const;

	std::vector<QueryLayer> layers_;
	std::vector<KnownTile> known_; ///< Ascending.
	TileMaker maker_;

	mutable Mutex mutex_; ///< Protects all members below, except `state_` once it is complete.
	mutable std::optional<InstanceState> state_;
	mutable bool complete_ = false;
	mutable std::map<WorldTileKey, Tile> made_;
	mutable std::size_t made_instances_ = 0;
};

} // namespace thicket
