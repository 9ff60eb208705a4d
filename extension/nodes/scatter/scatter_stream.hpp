#pragma once

#include "core/placement/layer_edits.hpp"
#include "nodes/gameplay/instance_world.hpp"
#include "nodes/gameplay/near_ring.hpp"
#include "nodes/scatter/scatter_stage.hpp"
#include "nodes/terrain/scatter_terrain.hpp"

#include <array>
#include <chrono>
#include <deque>
#include <memory>
#include <span>
#include <vector>

namespace thicket {

/// A layer as the stream takes it.
struct StreamedLayer {
	std::shared_ptr<const LayerPlan> plan;
	StreamLayer range;
	LayerLook look;
	bool error_reported = false; ///< One error for a plan, not one for each of its tiles.
};

/// A tile came or went.
struct TileEvent {
	bool shown = false;
	std::uint32_t layer = 0;
	glm::ivec2 tile{0};
};

/// Figures since the stream began.
struct StreamFigures {
	std::uint64_t worker_microseconds = 0; ///< Of all workers, for all tiles.
	std::uint64_t tiles_made = 0;
	std::uint64_t points_sampled = 0;
};

/// Brings the streamer, the workers and the stage together: one call a frame, under a budget. Main thread only.
class ScatterStream {
public:
	/// `world` is told of every tile that is made, and asked which it misses.
	explicit ScatterStream(InstanceWorld &world);

	/// What else works under the budget of a frame.
	void set_rings(std::vector<NearRing *> rings) { rings_ = std::move(rings); }

	/// Replaces the layers and the ground. `outdated[i]` says where layer i has to be made anew; what stands stays until
	/// then. `script` is asked for the ground of plans that have no terrain of their own.
	void set_layers(std::vector<StreamedLayer> layers, std::span<const EditedArea> outdated,
			const HostedTerrain &script);

	/// One frame's work: what came from the workers is uploaded and what is wanted is requested, until `budget`
	/// microseconds are spent. One step is done even where there is no time for it, so that nothing stands still. Without viewers
	/// what stands stays, and what was asked for is made all the same.
	void frame(std::span<const Viewer> viewers, std::uint64_t budget);

	/// The part of the work that belongs into a physics frame: asks for ground that may only be asked then, as much of it
	/// as its terrain allows.
	void physics_frame();

	/// Waits for the workers and clears the stage. The stream may go on afterwards, from nothing.
	void stop();

	/// What came and went since the last call, in order. A tile that was made anew comes without having gone.
	std::vector<TileEvent> take_events();

	/// True when all that is wanted is shown, and drawn as it should be, and the rings have nothing to do.
	bool idle() const;

	ScatterStage &stage() { return stage_; }
	const ScatterStage &stage() const { return stage_; }
	const StreamFigures &figures() const { return figures_; }
	StreamCounts counts() const { return streamer_.counts(); }

private:
	using Clock = std::chrono::steady_clock;

	std::size_t jobs_per_worker() const;
	void request_tiles(std::span<const Viewer> viewers);
	void sort_work(std::span<const Viewer> viewers);
	void start(const TileRequest &request);
	void start_missing();
	void mark_stale(std::span<const StreamedLayer> next, std::span<const EditedArea> outdated);
	void settle_unseen(const std::shared_ptr<TileJob> &job);
	bool ring_step();
	void cancel(std::uint64_t ticket);
	void take_finished();
	void settle(const std::shared_ptr<TileJob> &job);
	std::size_t ground_step(std::size_t most);
	bool ground_step_in_frame();
	bool show_step();
	bool step(std::size_t kind);
	void work_until(Clock::time_point deadline);

	InstanceWorld &world_;
	std::vector<NearRing *> rings_;
	TileStreamer streamer_;
	TileWorkers workers_;
	ScatterStage stage_;
	std::vector<StreamedLayer> layers_;
	HostedTerrain script_;

	std::vector<std::shared_ptr<TileJob>> jobs_;      ///< All under way, from request to upload.
	std::deque<std::shared_ptr<TileJob>> ask_ground_; ///< Those that wait for a script on the main thread.
	std::vector<Viewer> sorted_for_;                  ///< Where viewers were when these were sorted last.
	StreamChanges changes_;
	std::vector<TileEvent> events_;
	Status viewer_status_;
	StreamFigures figures_;
	std::array<Clock::duration, 5> usual_step_{}; ///< Of each kind: ground, show, free, detail, rings.
	std::size_t step_turn_ = 0;
	std::uint64_t usual_job_microseconds_ = 10'000; ///< Of one tile, smoothed; a guess until there were some.
};

} // namespace thicket
