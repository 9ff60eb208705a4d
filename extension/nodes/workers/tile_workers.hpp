#pragma once

#include "core/placement/tile_builder.hpp"
#include "core/streaming/tile_streamer.hpp"
#include "nodes/layer/layer_snapshot.hpp"
#include "nodes/workers/mesh_upload.hpp"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace thicket {

/// The state of one tile from its request to its upload. Owned by one thread at a time.
struct TileJob {
	/// The next step of the job.
	enum class Step : std::uint8_t {
		start,        ///< Nothing is done yet.
		needs_ground, ///< The main thread must sample `positions` and fill `ground`; see `Part`.
		has_ground,   ///< `ground` is filled in.
		done,         ///< `tile` and `uploads` are ready, or there is an error.
	};

	TileRequest request;
	SharedSnapshot layer;                   ///< The layer of the tile; never null.
	std::shared_ptr<const Terrain> terrain; ///< The ground; null if only the main thread may sample it.
	Step step = Step::start;

	/// A range of `positions` that need the same ground data; see GroundQuery. If `terrain` is not
	/// null, a worker has sampled the ground, and only the density rules are left.
	struct Part {
		std::size_t end = 0; ///< An index in `positions`; the next part begins here.
		std::vector<std::int32_t> textures;
		bool normals = true;
		std::vector<SharedDensityRule> density_rules;
		DensityRuleQuery density{}; ///< Without the rules, which are in `density_rules`.

		/// Evaluates the density rules at positions of this part.
		Status query_density(std::span<const glm::dvec2> part_positions, std::span<Ground> r_ground) const {
			return DensityRuleQuery{density_rules, density.sides, density.planet}.query(part_positions, r_ground);
		}
	};

	std::vector<glm::dvec2> positions;
	std::vector<Part> parts;
	std::vector<Ground> ground;
	/// The ground of earlier steps; see TileBuilder::find_further.
	std::vector<std::vector<Ground>> earlier_ground;
	std::size_t answered_count = 0; ///< The number of entries of `ground` that are filled.

	Status status;
	std::shared_ptr<const CompactTile> tile; ///< The result, without a game's changes.
	/// The ground heights for re-checks (TileBuilder::probes); empty if `for_query`.
	std::vector<GroundProbe> probes;
	/// The tile in the renderer's format, one entry per mesh; empty if `for_query`.
	std::vector<MeshUpload> uploads;
	std::uint64_t microseconds = 0;    ///< The total time of workers for this tile.
	std::uint64_t points_computed = 0; ///< The number of points computed for this tile; see SampleStats::computed.

	/// True if the tile is generated for queries, not for display. Only the main thread uses this
	/// flag and `is_stale`.
	bool for_query = false;
	bool is_stale = false; ///< True if the job's input was edited after the job was started.

	std::atomic<bool> cancelled = false; ///< The main thread may set this at any time.
};

/// Sorts jobs by work_order. Jobs for queries, and jobs whose ground is partly sampled, keep their
/// positions in the queue.
void sort_jobs(std::deque<std::shared_ptr<TileJob>> &r_jobs, std::span<const Viewer> viewers);

/// Generates tiles on the engine's WorkerThreadPool, or on the main thread if there are no worker
/// threads. Call all methods on the main thread.
class TileWorkers {
public:
	/// Runs at most `threads` pool tasks at a time. If `threads` is 0, `work_until` does the work
	/// instead.
	explicit TileWorkers(std::size_t threads);
	~TileWorkers();
	TileWorkers(const TileWorkers &) = delete;
	TileWorkers &operator=(const TileWorkers &) = delete;

	/// Queues a job. Jobs are processed in the order of `push`, or in the order set by the last
	/// call to `sort`.
	void push(std::shared_ptr<TileJob> job);

	/// Sorts the waiting jobs; see sort_jobs. Returns false without sorting if a worker holds the
	/// lock.
	bool sort(std::span<const Viewer> viewers);

	/// Removes and returns the jobs that are done or need ground, in the order of completion,
	/// including canceled ones. Never blocks: if a worker holds the lock, returns the jobs in a
	/// later frame. Call this every frame, because it also starts workers for waiting jobs.
	std::vector<std::shared_ptr<TileJob>> take_finished_jobs();

	/// Releases a large object off the main thread. A worker frees it before the next job, or
	/// within about a second if there are no jobs.
	void free_on_worker(std::shared_ptr<const void> object);

	/// Returns uploaded buffers to the workers, which reuse some of them for later tiles.
	void take_back(std::vector<MeshUpload> &&uploads);

	/// Returns the number of objects and buffers that workers have received from `free_on_worker`
	/// and `take_back`.
	std::uint64_t freed_count() const { return freed_count_.load(std::memory_order_relaxed); }

	/// Returns the number of reused buffers.
	std::uint64_t reused_count() const;

	/// Generates tiles until the deadline if there are no worker threads, but at least one tile if
	/// any are queued. With worker threads, does nothing. A script that is called for heights must
	/// not cause a nested call to this function.
	void work_until(std::chrono::steady_clock::time_point deadline);

	/// Cancels all jobs and waits until no worker uses any of their data. Takes a few milliseconds,
	/// or as long as a thread-safe ground script takes to return.
	void stop();

	/// Returns the number of tiles that are generated at a time, at least 1.
	std::size_t threads() const { return workers_.size(); }

private:
	struct Worker {
		Worker(const std::shared_ptr<BlockCache> &blocks, const std::shared_ptr<InstanceCache> &instances) :
				builder(SampleMargins{}, blocks, instances) {}

		TileWorkers *owner = nullptr;
		TileBuilder builder;
		TileInstances tile;
		BufferPool buffer_pool;
		std::shared_ptr<TileJob> job; ///< The job in progress, guarded by mutex_.
		std::int64_t task = -1;       ///< The pool's task ID; -1 if none. Used only on the main thread.
	};

	static bool try_lock_briefly(std::unique_lock<std::mutex> &r_lock);
	void flush_pending();

	/// Starts a worker for each waiting job, or one for unneeded objects if there are many and no
	/// jobs.
	void start_workers();
	static void run(void *p_worker);
	bool process_next_job(Worker &worker);
	static void advance(Worker &worker, TileJob &job);
	static Status prepare_queries(const TileBuilder &builder, TileJob &job);
	static void finish(Worker &worker, TileJob &job);
	std::shared_ptr<TileJob> take_next_job(Worker &worker);
	void return_result(Worker &worker);

	const bool on_main_thread_;
	std::mutex mutex_;
	std::deque<std::shared_ptr<TileJob>> queue_;
	std::vector<std::shared_ptr<TileJob>> finished_jobs_;
	std::vector<std::shared_ptr<const void>> unneeded_objects_;
	std::vector<MeshUpload> uploaded_buffers_;
	std::atomic<std::size_t> waiting_count_ = 0;  ///< The size of queue_.
	std::atomic<std::uint64_t> freed_count_ = 0;  ///< The result of `freed_count`.
	std::atomic<bool> has_much_unneeded_ = false; ///< True if freeing them is worth a worker.

	// The jobs and objects that `flush_pending` has yet to move to the shared queues. Used only on the
	// main thread.
	std::deque<std::shared_ptr<TileJob>> pending_jobs_;
	std::vector<std::shared_ptr<const void>> pending_objects_;
	std::vector<MeshUpload> pending_buffers_;
	int unneeded_frame_count_ = 0; ///< Consecutive frames in which unneeded_ or uploaded_ was not empty.
	std::vector<std::unique_ptr<Worker>> workers_;
};

} // namespace thicket
