#pragma once

#include "core/placement/layer_edits.hpp"
#include "core/query/instance_query.hpp"
#include "nodes/gameplay/scatter_state.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <tuple>
#include <vector>

namespace thicket {

/// Makes a tile of a layer on the spot.
using TileMaker =
		std::function<Status(std::uint32_t layer, glm::ivec2 tile, std::shared_ptr<const TileInstances> &r_tile)>;

/// What stands in the world of a node, for all who ask: the tiles that are known (shared with those on show, and some that were made for
/// queries) and the node's state. Main thread only.
class InstanceWorld {
public:
	/// The layers as they are from now on. Tiles of a layer whose set or tile size is another are forgotten.
	void set_layers(std::vector<QueryLayer> layers);

	/// Forgets the tiles that an edit touches.
	void invalidate(std::uint32_t layer, const EditedArea &area);
	void set_maker(TileMaker maker) { maker_ = std::move(maker); }
	void set_state(const InstanceState *state) { state_ = state; }
	void clear();

	/// Takes a finished tile in. Those that nobody else holds are forgotten, the oldest first, once they are more than
	/// `max_idle_instances` together.
	void keep(std::uint32_t layer, glm::ivec2 tile, std::shared_ptr<const TileInstances> instances);
	bool knows(std::uint32_t layer, glm::ivec2 tile) const;

	/// Rises with everything that may change an answer: tiles that came or went, layers, the state.
	std::uint64_t version() const { return version_; }
	void touch() { ++version_; }

	std::span<const QueryLayer> layers() const { return layers_; }
	const InstanceState *state() const { return state_; }

	/// What stands within `distance` metres of a place in the plane, in tiles that are known: makes none. Adds to `r_found`.
	void known_near(
			std::uint32_t layer, glm::dvec2 center, double distance, std::vector<PlacedInstance> &r_found) const;

	/// Runs a query that may make the tiles it misses, on this thread.
	template <class Query>
	Status ask(Query &&query) {
		MakingSource source(*this);
		return query(InstanceQuery{layers_, source, state_});
	}

	/// The same on what is known alone.
	template <class Query>
	Status ask_known(Query &&query) const {
		KnownSource source(*this);
		return query(InstanceQuery{layers_, source, state_});
	}

	static constexpr std::size_t max_idle_instances = 400'000;

private:
	struct Entry {
		std::shared_ptr<const TileInstances> tile;
		mutable std::uint64_t used = 0; ///< When it was last asked for.
	};

	class KnownSource : public TileSource {
	public:
		explicit KnownSource(const InstanceWorld &world) : world_(world) {}
		Status find_tile(std::uint32_t layer, glm::ivec2 tile, std::shared_ptr<const TileInstances> &r_tile) override;

	private:
		const InstanceWorld &world_;
	};

	class MakingSource : public TileSource {
	public:
		explicit MakingSource(InstanceWorld &world) : world_(world) {}
		Status find_tile(std::uint32_t layer, glm::ivec2 tile, std::shared_ptr<const TileInstances> &r_tile) override;

	private:
		InstanceWorld &world_;
	};

	using Key = std::tuple<std::uint32_t, std::int32_t, std::int32_t>;

	void forget_idle();

	std::vector<QueryLayer> layers_;
	std::map<Key, Entry> tiles_;
	TileMaker maker_;
	const InstanceState *state_ = nullptr;
	std::uint64_t version_ = 1;
	mutable std::uint64_t uses_ = 0;
	std::size_t kept_since_forgetting_ = 0;
};

} // namespace thicket
