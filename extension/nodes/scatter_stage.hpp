#pragma once

#include "core/streaming/tile_streamer.hpp"
#include "nodes/tile_visual.hpp"
#include "nodes/tile_workers.hpp"

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <tuple>
#include <vector>

namespace thicket {

/// How a layer looks on stage.
struct LayerLook {
	DrawSettings draw;
	std::vector<godot::Ref<godot::Mesh>> meshes; ///< Null entries are not drawn.
};

/// A tile on show.
struct StagedTile {
	/// The instances of one mesh. No visual where there are no instances or no mesh.
	struct Part {
		std::optional<TileVisual> visual;
		std::vector<std::uint64_t> ids;
		std::vector<std::uint32_t> ranks;
		godot::PackedFloat32Array hidden_buffer; ///< Of a part without a visual.
	};

	glm::dvec3 origin{0.0};
	TileCounts counts;
	std::vector<Part> parts;
};

/// What stands on show, and the finished tiles that wait for their upload. Main thread only. Works in small steps, so
/// that its caller can stop when the frame's time is spent.
class ScatterStage {
public:
	/// Where new tiles go.
	void set_place(const godot::RID &scenario, std::uint64_t node_id);

	/// Shows or hides all that stands and all that comes.
	void set_visible(bool visible);

	/// The looks of all layers; a tile with other settings than `looks` says is set anew at once. Meshes count for
	/// tiles still to come.
	void set_looks(std::vector<LayerLook> looks);

	/// Queues a finished job without error for upload.
	void push(std::shared_ptr<TileJob> job);

	/// Uploads one buffer. When that completes a tile, the tile waits, hidden, in `completed` and nothing else is
	/// uploaded until `present` or `reject` was called. False when there was nothing to do.
	bool upload_step();
	const TileJob *completed() const { return complete_ ? uploads_.front().get() : nullptr; }

	/// Shows the completed tile, in place of the one that stood there.
	void present();

	/// Throws the completed tile away.
	void reject();

	/// Takes a queued tile out, if it is there.
	void forget(std::uint64_t ticket);

	/// True if a tile stands under this key.
	bool holds(const TileKey &key) const;

	/// Takes a tile off the stage; what it held is freed step by step, by `free_step`. False if it does not stand
	/// there.
	bool drop(const TileKey &key);
	bool free_step();

	/// Frees everything now.
	void clear();

	/// The shown tile of a layer, null if there is none; the newest grid goes first.
	const StagedTile *find(std::uint32_t layer, glm::ivec2 tile) const;
	std::vector<glm::ivec2> tiles(std::uint32_t layer) const;

	/// How many layers have or had a look.
	std::size_t layer_count() const { return looks_.size(); }

	std::size_t waiting() const { return uploads_.size(); }
	std::size_t tile_count() const { return tiles_.size(); }
	std::uint64_t instance_count() const { return instances_; }

private:
	/// layer, x, y, -grid: neighbours in a layer stay together, the newest grid comes first.
	using Order = std::tuple<std::uint32_t, std::int32_t, std::int32_t, std::int64_t>;
	static Order order(const TileKey &key);
	void apply_look(std::uint32_t layer, StagedTile &tile);
	void leave(StagedTile &&tile);
	StagedTile::Part make_part(const TileJob &job, MeshUpload &upload, std::size_t mesh);

	VisualPlace place_;
	bool visible_ = true;
	std::vector<LayerLook> looks_;
	std::map<Order, StagedTile> tiles_;
	std::vector<TileVisual> leaving_;
	std::uint64_t instances_ = 0;

	std::deque<std::shared_ptr<TileJob>> uploads_;
	StagedTile current_; ///< As much of uploads_.front() as is uploaded.
	bool complete_ = false;
};

} // namespace thicket
