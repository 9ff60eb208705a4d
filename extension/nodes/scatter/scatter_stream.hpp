#pragma once

#include "core/near/near_queue.hpp"
#include "core/placement/layer_edits.hpp"
#include "core/streaming/ground_recheck.hpp"
#include "nodes/drawing/tile_display.hpp"
#include "nodes/drawing/upload_queue.hpp"
#include "nodes/ground/scatter_ground.hpp"
#include "nodes/scatter/frame_times.hpp"
#include "nodes/workers/tile_workers.hpp"

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

/// The ground on which instances are placed.
struct StreamGround {
	/// The ground for workers. Null if only the main thread may sample it.
	std::shared_ptr<const Terrain> terrain;
	HostedGround source; ///< The ground for the main thread.
};

/// Records that a tile was shown or hidden.
struct TileEvent {
	bool is_shown = false;
	std::uint32_t layer = 0;
	glm::ivec2 tile{0};
};

/// The error of a layer whose tiles could not be generated, after it was printed.
struct LayerFailure {
	godot::String message;  ///< The error; empty if there is none.
	bool by_script = false; ///< True if the ground's script failed. `message` then names no layer.
};

/// Statistics since the stream started.
struct StreamFigures {
	std::uint64_t worker_microseconds = 0; ///< The total time of all workers for visible tiles.
	std::uint64_t tiles_made = 0;
	std::uint64_t points_sampled = 0;
	/// The number of computed points, including those around tiles and those for queries.
	std::uint64_t points_computed = 0;
	std::uint64_t heights_rechecked = 0;
};

/// Streams tiles around viewers: connects the TileStreamer, the workers, the uploads and the
/// display. Call `frame` once per frame; it keeps to a time budget. Use it only on the main thread.
class ScatterStream {
public:
	/// Passes every generated tile to `world`, and generates the tiles that `world` requests.
	/// `world` must outlive the stream.
	explicit ScatterStream(InstanceWorld &world);

	/// Sets the rings, which are the objects that keep bodies and scenes near viewers. The rings
	/// share the frame budget.
	void set_rings(std::vector<NearRing *> rings) { rings_ = std::move(rings); }

	/// Replaces the layers and the ground. Regenerates layer i in the area `outdated[i]`; old tiles
	/// stay visible until they are replaced.
	void set_layers(const std::vector<SharedSnapshot> &layers, std::span<const EditedArea> outdated_areas,
			const StreamGround &ground);

	/// Drops visible tiles on ground that has disappeared, if they are outside every view. Their
	/// replacements would be generated last.
	void drop_unseen(const Rect &area) { streamer_.drop_unseen(area); }

	/// Does the work of one frame, such as requesting missing tiles and uploading finished ones,
	/// until `budget` microseconds are spent. Does at least one step even without any budget.
	/// Without viewers, keeps all tiles and still generates tiles for queries. Returns false if a
	/// script that samples the ground has freed this object. Throws std::bad_alloc if memory runs
	/// out; the following frames then repeat the lost work.
	[[nodiscard]] bool frame(std::span<const Viewer> viewers, std::uint64_t budget);

	/// Samples ground that may only be sampled in physics frames, at up to `max_positions_per_call`
	/// positions. Call this every physics frame.
	void physics_frame();

	/// Waits for the workers and immediately removes all tiles and bodies. The stream may be used
	/// again afterward.
	void stop();

	/// Waits for the workers and discards all work. Tiles stay visible until `dissolve_until` hides
	/// and frees them in steps.
	void retire();

	/// Removes bodies, and hides and frees removed tiles, until `deadline`. Does at least one step.
	void dissolve_until(std::chrono::steady_clock::time_point deadline);

	/// Returns the tiles that were shown or hidden since the last call, in order. A regenerated
	/// tile is reported as shown again but not as hidden.
	std::vector<TileEvent> take_events();

	/// Returns positions, in world meters, where re-checks since the last call have found
	/// unreported ground changes under visible tiles.
	std::vector<glm::dvec2> take_ground_changes();

	/// Returns true if all required tiles are visible and drawn with the current settings, and the
	/// rings have no work left.
	bool idle() const;

	/// Returns true if a frame with these viewers and limits would neither request other tiles nor
	/// redraw any because of the limits. Without viewers, always returns true.
	bool follows(std::span<const Viewer> viewers, const DrawLimits &limits) const;

	/// Returns the error of the first viewer whose position is out of range; ok if there is none.
	/// The other viewers are unaffected.
	const Status &viewer_status() const { return viewer_status_; }

	/// Returns a message for each error that has kept tiles from being generated. An error is kept
	/// until its layer or the ground changes.
	godot::PackedStringArray failures() const;

	/// Returns true if `failures` has changed since the last call.
	bool take_failures_changed() { return std::exchange(failures_changed_, false); }

	TileDisplay &display() { return display_; }
	const TileDisplay &display() const { return display_; }

	/// Frees a large object on a worker; see TileWorkers::free_on_worker.
	void free_on_worker(std::shared_ptr<const void> object) { workers_.free_on_worker(std::move(object)); }

	/// Returns the times of the node's whole frame. The node starts and completes the measurement.
	FrameTimes &times() { return times_; }

	/// Returns the number of tiles that are generated but not yet visible.
	std::size_t upload_queue_size() const { return uploads_.size(); }
	const StreamFigures &figures() const { return figures_; }

	/// Returns the number of objects and buffers that workers have received to free; see
	/// TileWorkers::freed_count.
	std::uint64_t freed_by_workers() const { return workers_.freed_count(); }

	/// Returns the number of buffers that workers have reused; see TileWorkers::reused_count.
	std::uint64_t buffers_reused() const { return workers_.reused_count(); }
	StreamCounts counts() const { return streamer_.counts(); }

private:
	using Clock = std::chrono::steady_clock;

	/// The kinds of work that share the time of a frame.
	enum class Step : std::uint8_t {
		query_ground, ///< Samples the ground of a tile on the main thread.
		upload,       ///< Uploads a part of a tile and shows the tile after the last part.
		free,         ///< Hides and frees removed tiles.
		lod,          ///< Redraws some tiles to match their distances.
		divide,       ///< Divides a tile into cells, or draws it as a whole again.
		fade,         ///< Prepares LODs that will fade in.
		rings,        ///< Adds and removes bodies.
		recheck,      ///< Compares a few ground heights with those of visible tiles.
	};
	static constexpr std::size_t step_kinds = 8;

	std::size_t jobs_per_worker() const;
	void accept_viewers(std::span<const Viewer> viewers);
	void request_tiles();
	void sort_work();
	void start(const TileRequest &request);
	void start_query_jobs();
	void mark_stale(std::span<const SharedSnapshot> layers, std::span<const EditedArea> outdated_areas);
	bool work_in_frame(std::span<const Viewer> viewers, std::uint64_t budget);
	void start_over();
	void report_once(const TileJob &job);
	void report_recheck(const Status &status);
	LayerFailure print_failure(const std::string &location, const Status &status, const std::string &rule_problem = {});
	void forget_failure(LayerFailure &r_failure);
	void process_query_result(const std::shared_ptr<TileJob> &job);
	bool ring_step();
	void cancel(std::uint64_t ticket);
	void forget_work();
	void take_finished_jobs();
	void process_result(const std::shared_ptr<TileJob> &job);
	std::size_t ground_step(std::size_t max_count);
	std::size_t max_positions(bool in_physics_frame) const;
	bool upload_step();
	void finish_upload();
	bool rechecks() const;
	void keep_displayed(const TileRequest &request);
	void allow_recheck(Clock::duration budget);
	bool recheck_step();
	std::size_t recheck_heights(std::size_t max_count);
	bool do_step(Step step);
	bool may_divide() const;
	bool may_fade() const;
	static Step following_step(Step step);
	static FramePart part_of(Step step);
	bool work_until(Clock::time_point deadline);

	/// Expires with this object, so that the stream can detect that a script has freed it.
	std::shared_ptr<const char> life_ = std::make_shared<const char>('\0');
	InstanceWorld &world_;
	FrameTimes times_;
	std::vector<NearRing *> rings_;
	TileStreamer streamer_;
	TileWorkers workers_;
	UploadQueue uploads_;
	TileDisplay display_;
	std::vector<SharedSnapshot> layers_;
	/// The last error of each layer. Kept until the layer or the ground changes.
	std::vector<LayerFailure> failures_;
	StreamGround ground_;

	std::vector<std::shared_ptr<TileJob>> jobs_; ///< All jobs from request to upload.
	/// The jobs whose ground must be sampled on the main thread.
	std::deque<std::shared_ptr<TileJob>> ground_jobs_;
	std::vector<Viewer> sorted_viewers_; ///< The viewers at the time of the last sort.
	StreamChanges changes_;
	std::vector<TileEvent> events_;
	std::vector<Viewer> viewers_; ///< The viewers of the last frame that are in range.
	Status viewer_status_;        ///< The error of the first skipped viewer.
	Status update_status_;

	GroundRecheck recheck_;
	Clock::duration recheck_time_left_{0};      ///< The time left for re-checks; negative after overruns.
	Clock::duration average_height_time_{1000}; ///< The average time per height.
	bool is_recheck_due_ = false;               ///< True until this frame's re-check is done.
	/// The error of the last failed re-check. Kept until the layers or the ground change.
	LayerFailure recheck_failure_;
	bool failures_changed_ = false;
	StreamFigures figures_;
	std::array<Clock::duration, step_kinds> average_step_times_{}; ///< The average time of each Step.
	Step next_step_ = Step::query_ground;
	std::uint32_t uploads_since_divide_ = 0;
	std::uint32_t uploads_since_fade_ = 0;
	/// The average time that a worker needs for a tile. The initial value is a guess.
	std::uint64_t average_job_microseconds_ = 10'000;
};

} // namespace thicket
