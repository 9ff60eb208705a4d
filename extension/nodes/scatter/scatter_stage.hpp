#pragma once

#include "core/near/tile_overlay.hpp"
#include "core/placement/lod.hpp"
#include "core/streaming/lod_schedule.hpp"
#include "core/streaming/tile_streamer.hpp"
#include "nodes/scatter/tile_visual.hpp"
#include "nodes/scatter/tile_workers.hpp"

#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <tuple>
#include <unordered_set>
#include <vector>

namespace thicket {

/// How a layer looks on stage.
struct LayerLook {
	DrawSettings draw;
	std::vector<godot::Ref<godot::Mesh>> meshes; ///< Null entries are not drawn.

	/// For each distance of `detail` in a row of its own an entry for each of the meshes; null for the finer one.
	std::vector<godot::Ref<godot::Mesh>> lod_meshes;
	LodSettings detail;
};

/// How much of what stands is drawn, whatever the distance.
struct DrawLimits {
	double quality = 1.0;                                                    ///< Share of every tile, 0 to 1.
	std::uint64_t max_instances = std::numeric_limits<std::uint64_t>::max(); ///< Of all tiles together.

	friend bool operator==(const DrawLimits &, const DrawLimits &) = default;
};

/// A tile on show.
struct StagedTile {
	/// The instances of one mesh. No visual where there are no instances or no mesh.
	struct Part {
		std::optional<TileVisual> visual;
		std::vector<godot::Ref<godot::Mesh>> levels; ///< Of a visual: the mesh, then those for the distance.
		std::shared_ptr<const MeshInstances> shown;  ///< The tile's own, or what is left and added by the overlay.
		std::uint64_t drawn = 0;                     ///< How many of them the visual draws,
		std::uint64_t wanted = 0;                    ///< and would draw without a limit for all tiles together.
	};

	std::shared_ptr<const TileInstances> tile; ///< What the layer's rules give.
	std::shared_ptr<const LayerPlan> plan;     ///< That it was made by.
	Rect rect;
	std::vector<Part> parts;

	glm::vec3 min{std::numeric_limits<float>::max()};  ///< The box around all that is drawn, relative to the origin;
	glm::vec3 max{-std::numeric_limits<float>::max()}; ///< inside out where nothing is.
	std::size_t lod = 0;
	std::uint64_t look_version = 0; ///< Of the layer's look that it was last drawn with.

	void grow(const godot::AABB &box);
};

/// What stands on show, and the finished tiles that wait for their upload. Main thread only. Works in small steps, so
/// that its caller can stop when the frame's time is spent.
class ScatterStage {
public:
	/// What lies over all tiles to come; what stands follows where it is marked. It has to stay.
	void set_state(const InstanceState *state) { state_ = state; }

	/// An instance of a layer, whose point lies in `area`, is shown by other means from now on, or no longer.
	void set_hidden(std::uint32_t layer, std::uint64_t id, const Rect &area, bool hidden);

	/// The overlay may have changed in an area (world meters, edges included) of a layer, or all over.
	void mark(std::uint32_t layer, const Rect &area) { marks_.push_back({layer, area}); }
	void mark_all() { marked_all_ = true; }

	/// Draws the tiles anew, one upload each, whose overlay has changed where it was marked. Call it before the frame is drawn.
	void patch();
	bool has_marks() const { return marked_all_ || !marks_.empty(); }

	/// Where new tiles go.
	void set_place(const godot::RID &scenario, std::uint64_t node_id);

	/// The engine's origin in the world, meters: all that stands is moved along at once.
	void set_world_offset(glm::dvec3 offset);

	/// Shows or hides all that stands and all that comes.
	void set_visible(bool visible);

	/// The looks of all layers; tiles drawn with other settings follow, step by step, by `detail_step`. Meshes count for
	/// tiles still to come.
	void set_looks(std::vector<LayerLook> looks);

	/// How much to draw; tiles follow as above.
	void set_limits(const DrawLimits &limits) { next_limits_ = limits; }

	/// Where the viewers are in this frame: what is drawn of a tile depends on its distance to the nearest.
	void look_around(std::span<const Viewer> viewers);

	/// Draws one tile as its distance, its layer's look and the limits say, without an upload. False if all tiles are.
	bool detail_step();

	/// True if `detail_step` would find nothing to do.
	bool settled() const { return schedule_.settled(); }

	/// Queues a finished job without error for upload.
	void push(std::shared_ptr<TileJob> job);

	/// True from `choose` to `present`, `reject` or `set_aside`.
	bool is_uploading() const { return chosen_; }

	/// Chooses the queued job that is uploaded next. False if it is not there.
	bool choose(std::uint64_t ticket);

	/// Uploads one buffer of the chosen job. When that completes a tile, the tile waits, hidden, in `completed` and nothing
	/// else is uploaded until `present`, `reject` or `set_aside` was called. False when there was nothing to do.
	bool upload_step();
	const TileJob *completed() const { return complete_ ? uploads_.front().get() : nullptr; }

	/// Shows the completed tile, in place of the one that stood there.
	void present();

	/// Throws the completed tile away.
	void reject();

	/// Queues the completed tile again, as it is: once it is chosen it is complete at once.
	void set_aside();

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

	std::size_t waiting() const { return uploads_.size() + aside_.size(); }
	std::size_t tile_count() const { return tiles_.size(); }
	std::uint64_t instance_count() const { return instances_; }

	/// Instances that are drawn when in sight, at most as many as the limits allow.
	std::uint64_t drawn_count() const { return drawn_; }

	/// Buffers handed to the renderer since the stage was new or cleared.
	std::uint64_t upload_count() const { return upload_count_; }

private:
	/// layer, x, y, -grid: neighbors in a layer stay together, the newest grid comes first.
	using Order = std::tuple<std::uint32_t, std::int32_t, std::int32_t, std::int64_t>;
	struct Mark {
		std::uint32_t layer = 0;
		Rect area;
	};
	static Order order(const TileKey &key);
	static TileKey key_of(const Order &order);
	void leave(StagedTile &&tile);
	void count(const StagedTile &tile);
	void uncount(const StagedTile &tile);
	void visit_all();
	void apply_look(const TileKey &key, StagedTile &tile);
	void refine(const TileKey &key, StagedTile &tile);
	StagedTile::Part make_part(const TileJob &job, std::size_t mesh);
	void draw_part(const StagedTile &tile, std::size_t mesh, const LayerLook &look, const MeshUpload &upload,
			StagedTile::Part &r_part);
	void patch(const TileKey &key, StagedTile &r_tile);
	std::vector<std::shared_ptr<const MeshInstances>> overlay(const StagedTile &tile) const;

	VisualPlace place_;
	bool visible_ = true;
	std::vector<LayerLook> looks_;
	std::vector<std::uint64_t> look_versions_; ///< Of each look: another number whenever it draws otherwise.
	std::uint64_t last_version_ = 0;
	std::map<Order, StagedTile> tiles_;
	std::vector<TileVisual> leaving_;
	std::uint64_t instances_ = 0;
	std::uint64_t upload_count_ = 0;

	LodSchedule schedule_;
	DrawLimits limits_;
	DrawLimits next_limits_;
	double share_ = 1.0; ///< Of what is wanted, so that max_instances are not exceeded.
	std::uint64_t drawn_ = 0;
	std::uint64_t wanted_ = 0;
	std::vector<TileKey> cut_; ///< Tiles that the limit cut short, to be visited once more.

	/// Uploaded, and not yet its turn.
	struct Aside {
		std::shared_ptr<TileJob> job;
		StagedTile tile;
	};

	std::deque<std::shared_ptr<TileJob>> uploads_;
	std::vector<Aside> aside_;
	bool chosen_ = false;                                             ///< uploads_.front() is.
	StagedTile current_;                                              ///< As much of uploads_.front() as is uploaded.
	std::vector<std::shared_ptr<const MeshInstances>> current_shown_; ///< What is to be uploaded of it.
	bool complete_ = false;

	const InstanceState *state_ = nullptr;
	std::unordered_set<std::uint64_t> hidden_;
	std::vector<Mark> marks_;
	bool marked_all_ = false;
	bool current_outdated_ = false; ///< Something was marked since current_ was begun.
};

} // namespace thicket
