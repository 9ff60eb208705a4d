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

/// One tile, from its request to its uploads. Only one thread at a time owns it.
struct TileJob {
	/// The progress of the job.
	enum class Step : std::uint8_t {
		start,        ///< Nothing is done yet.
		needs_ground, ///< `positions` wait for the main thread to fill `ground`.
		has_ground,   ///< `ground` is full.
		done,         ///< `tile` and `uploads` are ready, or there is an error.
	};

	TileRequest request;
	SharedSnapshot layer;                   ///< Never null.
	std::shared_ptr<const Terrain> terrain; ///< Null if the main thread must call a script for the ground.
	Step step = Step::start;

	/// A contiguous part of `positions` that needs the same ground data; see GroundQuery.
	struct Part {
		std::size_t end = 0; ///< In `positions`; the next part begins here.
		std::vector<std::int32_t> textures;
		bool normals = true;
	};

	std::vector<glm::dvec2> positions;
	std::vector<Part> parts;
	std::vector<Ground> ground;
	std::size_t answered = 0; ///< The number of entries of `ground` that are filled.

	Status status;
	std::shared_ptr<const CompactTile> tile; ///< The result of the rules, without a game's changes.
	std::vector<GroundProbe> probes;         ///< See TileBuilder::probes; empty if `unseen`.
	std::vector<MeshUpload> uploads;   ///< The same tile for the renderer, a part for each mesh; empty if `unseen`.
	std::uint64_t microseconds = 0;    ///< Time that workers spent on it.
	std::uint64_t points_computed = 0; ///< For this job; see SampleStats::computed.

	bool unseen = false; ///< Generated for queries, not for display. Main thread only, as is the next member.
	bool stale = false;  ///< True if data that it depends on was edited after it was begun.

	std::atomic<bool> cancelled = false; ///< Set by the main thread, at any time.
};

/// Sorts jobs by work_order. Jobs for queries, and jobs whose ground is partly known, keep their index.
void sort_jobs(std::deque<std::shared_ptr<TileJob>> &r_jobs, std::span<const Viewer> viewers);

/// Generates tiles on the engine's WorkerThreadPool, or on the main thread if there are no threads. Called on the main thread only, apart
/// from the work itself.
class TileWorkers {
public:
	/// Runs at most `threads` tasks of the pool at a time. With 0 threads, `work_until` does the work.
	explicit TileWorkers(std::size_t threads);
	~TileWorkers();
	TileWorkers(const TileWorkers &) = delete;
	TileWorkers &operator=(const TileWorkers &) = delete;

	/// Queues a job. Jobs are processed in the order of their arrival, or of the last sort.
	void push(std::shared_ptr<TileJob> job);

	/// Sorts the waiting jobs; see sort_jobs. Returns false, without sorting, if a worker holds the lock.
	bool sort(std::span<const Viewer> viewers);

	/// Removes and returns the jobs that are done or need ground, in the order in which they were finished. Includes
	/// cancelled jobs. Never waits for a worker: a job that is not available immediately is returned in the next frame.
	/// Call this in every frame, because it also starts workers for waiting jobs.
	std::vector<std::shared_ptr<TileJob>> take_finished();

	/// Releases a large object without cost for the main thread. A worker frees it before the next job, or within a
	/// second if there is none.
	void let_go(std::shared_ptr<const void> unneeded);

	/// Takes back buffers that were uploaded. The worker that receives them reuses some of them for later tiles.
	void take_back(std::vector<MeshUpload> &&uploads);

	/// The number of such objects and buffers that workers have received.
	std::uint64_t freed() const { return freed_.load(std::memory_order_relaxed); }

	/// The number of buffers that were reused.
	std::uint64_t reused() const;

	/// Without worker threads: generates tiles until the deadline, at least one if any waits. A script that is called
	/// for heights may call anything except this function. With worker threads: does nothing.
	void work_until(std::chrono::steady_clock::time_point deadline);

	/// Cancels all jobs and waits until no worker uses any of our data. Takes a few milliseconds, or as long as a
	/// script needs for heights that were just requested.
	void stop();

	/// How many tiles are generated at a time, at least 1.
	std::size_t threads() const { return workers_.size(); }

private:
	struct Worker {
		explicit Worker(const std::shared_ptr<BlockCache> &blocks) : builder(SampleMargins{}, blocks) {}

		TileWorkers *owner = nullptr;
		TileBuilder builder;
		TileInstances tile;
		SpareBuffers spare;
		std::shared_ptr<TileJob> job; ///< Guarded by mutex_.
		std::int64_t task = -1;       ///< The engine's task, -1 if there is none. Main thread only.
	};

	static bool lock_soon(std::unique_lock<std::mutex> &r_lock);
	void hand_over();

	/// Starts as many workers as there are waiting jobs, and one for unneeded objects.
	void wake();
	static void run(void *p_worker);
	bool work_on_next(Worker &worker);
	static void advance(Worker &worker, TileJob &job);
	static void finish(Worker &worker, TileJob &job);
	std::shared_ptr<TileJob> next(Worker &worker);
	void hand_in(Worker &worker);

	const bool on_main_thread_;
	std::mutex mutex_;
	std::deque<std::shared_ptr<TileJob>> queue_;
	std::vector<std::shared_ptr<TileJob>> finished_;
	std::vector<std::shared_ptr<const void>> unneeded_;
	std::vector<MeshUpload> uploaded_;
	std::atomic<std::size_t> waiting_ = 0;    ///< The size of queue_.
	std::atomic<std::uint64_t> freed_ = 0;    ///< The number of objects freed from unneeded_ and uploaded_.
	std::atomic<bool> much_unneeded_ = false; ///< Whether unneeded_ and uploaded_ need their own worker.

	// Main thread only. Jobs that are not in the queue yet, and objects that are not in the list of unneeded ones yet.
	std::deque<std::shared_ptr<TileJob>> incoming_;
	std::vector<std::shared_ptr<const void>> unneeded_here_;
	std::vector<MeshUpload> uploaded_here_;
	int frames_unneeded_ = 0; ///< The number of consecutive frames in which either list had something.
	std::vector<std::unique_ptr<Worker>> workers_;
};

} // namespace thicket
