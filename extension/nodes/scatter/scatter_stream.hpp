#pragma once

#include "core/near/near_queue.hpp"
#include "core/placement/layer_edits.hpp"
#include "core/streaming/ground_recheck.hpp"
#include "nodes/scatter/frame_times.hpp"
#include "nodes/drawing/tile_display.hpp"
#include "nodes/workers/tile_workers.hpp"
#include "nodes/drawing/upload_queue.hpp"
#include "nodes/ground/scatter_ground.hpp"

#include <godot_cpp/variant/packed_string_array.hpp>
#include <godot_cpp/variant/string.hpp>

#include <array>
#include <chrono>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace thicket {

/// The ground that instances are placed on.
struct StreamGround {
	std::shared_ptr<const Terrain> terrain; ///< For workers; null if only the main thread may sample the ground.
	HostedGround source;                    ///< Sampled on the main thread.
};

/// A tile was shown or hidden.
struct TileEvent {
	bool shown = false;
	std::uint32_t layer = 0;
	glm::ivec2 tile{0};
};

/// The printed error of tiles that could not be generated.
struct LayerFailure {
	godot::String sentence; ///< Empty if there is none.
	bool by_script = false; ///< True if the ground's script failed; its error names no layer.
};

/// Statistics since the stream began.
struct StreamFigures {
	std::uint64_t worker_microseconds = 0; ///< The time of all workers for all tiles.
	std::uint64_t tiles_made = 0;
	std::uint64_t points_sampled = 0;
	std::uint64_t points_computed = 0; ///< Includes the points around tiles, and tiles for queries.
	std::uint64_t heights_rechecked = 0;
};

/// Connects the streamer, the workers, the uploads and the display. One call per frame, under a time budget. Main
/// thread only.
class ScatterStream {
public:
	/// Notifies `world` of every generated tile, and generates the tiles that `world` lacks.
	explicit ScatterStream(InstanceWorld &world);

	/// The rings also work under the budget of a frame.
	void set_rings(std::vector<NearRing *> rings) { rings_ = std::move(rings); }

	/// Replaces the layers and the ground. `outdated[i]` is the area in which layer i must be regenerated; the old tiles stay visible
	/// until then.
	void set_layers(const std::vector<SharedSnapshot> &layers, std::span<const EditedArea> outdated,
			const StreamGround &ground);

	/// One frame's work: requests wanted tiles and uploads finished ones, until `budget` microseconds are spent. Always
	/// does at least one step, so that work goes on even without time. Without viewers, all tiles stay, and tiles for
	/// queries are still generated. Returns false if a script that was called for the ground has freed this object.
	/// Throws std::bad_alloc if memory runs out; the next frames then repeat the lost work.
	[[nodiscard]] bool frame(std::span<const Viewer> viewers, std::uint64_t budget);

	/// Samples grounds that may only be sampled in a physics frame, at as many positions as each ground allows.
	void physics_frame();

	/// Waits for the workers and clears the display. The stream may be used again afterwards, and then starts empty.
	void stop();

	/// Waits for the workers and starts empty. The tiles stay visible until `dissolve_until` removes them step by step.
	void retire();

	/// Removes bodies and frees hidden tiles until `deadline`. Does at least one step.
	void dissolve_until(std::chrono::steady_clock::time_point deadline);

	/// The tiles that were shown and hidden since the last call, in order. A regenerated tile is shown again without
	/// being hidden first.
	std::vector<TileEvent> take_events();

	/// Positions under visible tiles, in world meters, where re-checks since the last call have found that the ground
	/// changed without a report.
	std::vector<glm::dvec2> take_ground_changes();

	/// True if all wanted tiles are visible and drawn with the current settings, and the rings have nothing to do.
	bool idle() const;

	/// True if a frame with these viewers and limits would request no other tiles and redraw none because of the
	/// limits. Without viewers, all tiles stay, so no others are requested.
	bool follows(std::span<const Viewer> viewers, const DrawLimits &limits) const;

	/// The error of a viewer whose position is out of range for streaming. Tiles are still streamed around the other
	/// viewers.
	const Status &viewer_status() const { return viewer_status_; }

	/// One sentence for each error that has kept tiles from being generated. A sentence stays until its layer or the
	/// ground changes.
	godot::PackedStringArray failures() const;

	/// Whether the failures have changed since the last call.
	bool take_failures_changed() { return std::exchange(failures_changed_, false); }

	TileDisplay &display() { return display_; }
	const TileDisplay &display() const { return display_; }

	/// See TileWorkers::let_go.
	void let_go(std::shared_ptr<const void> unneeded) { workers_.let_go(std::move(unneeded)); }

	/// For the node's whole frame, which begins and ends elsewhere.
	FrameTimes &times() { return times_; }

	/// Tiles that are generated and not yet visible.
	std::size_t upload_queue_size() const { return uploads_.size(); }
	const StreamFigures &figures() const { return figures_; }

	/// The number of unneeded objects that workers have freed.
	std::uint64_t freed_by_workers() const { return workers_.freed(); }

	/// The number of buffers that workers have reused.
	std::uint64_t buffers_reused() const { return workers_.reused(); }
	StreamCounts counts() const { return streamer_.counts(); }

private:
	using Clock = std::chrono::steady_clock;

	/// The kinds of work that share a frame's time.
	enum class Step : std::uint8_t {
		ask_ground, ///< Calls a script for the ground of a tile.
		upload,     ///< Uploads a part of a tile, and shows the tile with its last part.
		free,       ///< Frees tiles that are no longer visible.
		lod,        ///< Redraws some tiles to match their distances.
		divide,     ///< Draws a tile in cells, or as a whole again.
		fade,       ///< Prepares LODs that are to fade in.
		rings,      ///< Adds and removes bodies.
		recheck,    ///< Compares the ground under some visible tiles with the ground that they were generated on.
	};
	static constexpr std::size_t step_kinds = 8;

	std::size_t jobs_per_worker() const;
	void accept(std::span<const Viewer> viewers);
	void request_tiles();
	void sort_work();
	void start(const TileRequest &request);
	void start_missing();
	void mark_stale(std::span<const SharedSnapshot> next, std::span<const EditedArea> outdated);
	bool work_in_frame(std::span<const Viewer> viewers, std::uint64_t budget);
	void start_over();
	void report_once(const TileJob &job);
	void report_recheck(const Status &status);
	LayerFailure print_failure(const std::string &where, const Status &status);
	void forget_failure(LayerFailure &r_failure);
	void settle_unseen(const std::shared_ptr<TileJob> &job);
	bool ring_step();
	void cancel(std::uint64_t ticket);
	void forget_work();
	void take_finished();
	void settle(const std::shared_ptr<TileJob> &job);
	std::size_t ground_step(std::size_t most);
	std::size_t positions_at_once(bool in_physics_frame) const;
	bool upload_step();
	void finish_upload();
	bool rechecks() const;
	void keep_shown(const TileRequest &request);
	void allow_recheck(Clock::duration budget);
	bool recheck_step();
	std::size_t recheck_heights(std::size_t most);
	bool do_step(Step step);
	bool may_divide() const;
	bool may_fade() const;
	static Step after(Step step);
	static FramePart part_of(Step step);
	bool work_until(Clock::time_point deadline);

	std::shared_ptr<const char> life_ = std::make_shared<const char>('\0'); ///< Expires with this object.
	InstanceWorld &world_;
	FrameTimes times_;
	std::vector<NearRing *> rings_;
	TileStreamer streamer_;
	TileWorkers workers_;
	UploadQueue uploads_;
	TileDisplay display_;
	std::vector<SharedSnapshot> layers_;
	std::vector<LayerFailure> failures_; ///< One error per layer, not per tile, until it or the ground changes.
	StreamGround ground_;

	std::vector<std::shared_ptr<TileJob>> jobs_;      ///< All jobs from their request to their upload.
	std::deque<std::shared_ptr<TileJob>> ask_ground_; ///< The jobs that wait for a script on the main thread.
	std::vector<Viewer> sorted_for_;                  ///< The viewers when the jobs were last sorted.
	StreamChanges changes_;
	std::vector<TileEvent> events_;
	std::vector<Viewer> viewers_; ///< The viewers of the last frame that are within range.
	Status viewer_status_;        ///< The error of the first viewer that was left out.
	Status update_status_;

	GroundRecheck recheck_;
	Clock::duration recheck_left_{0};    ///< Time for re-checks; negative after one took too long.
	Clock::duration usual_height_{1000}; ///< The usual time for one height.
	bool recheck_due_ = false;           ///< Set once per frame.
	LayerFailure recheck_failure_;       ///< The last one, for no layer. Kept until the layers or the ground change.
	bool failures_changed_ = false;
	StreamFigures figures_;
	std::array<Clock::duration, step_kinds> usual_step_{}; ///< The usual time of each Step.
	Step next_step_ = Step::ask_ground;
	std::uint32_t uploads_since_divide_ = 0;
	std::uint32_t uploads_since_fade_ = 0;
	std::uint64_t usual_job_microseconds_ = 10'000; ///< For one tile, smoothed; at first, a guess.
};

} // namespace thicket
