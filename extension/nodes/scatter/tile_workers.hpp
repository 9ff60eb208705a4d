#pragma once

#include "core/placement/tile_builder.hpp"
#include "core/streaming/tile_streamer.hpp"
#include "nodes/layer/layer_snapshot.hpp"
#include "nodes/scatter/mesh_upload.hpp"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace thicket {

/// One tile from its request to what is uploaded. One thread owns it at a time.
struct TileJob {
	/// What is done for it.
	enum class Step : std::uint8_t {
		start,        ///< Nothing done yet.
		needs_ground, ///< `positions` wait for the main thread to fill `ground`.
		has_ground,   ///< `ground` is full.
		done,         ///< `tile` and `uploads`, or an error.
	};

	TileRequest request;
	SharedSnapshot layer;                   ///< Never null.
	std::shared_ptr<const Terrain> terrain; ///< Null where the main thread has to ask a script for the ground.
	Step step = Step::start;

	/// Some of `positions`, one after the other, of which the same has to be known; see GroundQuery.
	struct Part {
		std::size_t end = 0; ///< In `positions`; where the next part begins.
		std::vector<std::int32_t> textures;
		bool normals = true;
	};

	std::vector<glm::dvec2> positions;
	std::vector<Part> parts;
	std::vector<Ground> ground;
	std::size_t answered = 0; ///< How much of `ground` is filled.

	Status status;
	std::shared_ptr<const KeptTile> tile; ///< What the rules give, whatever a game has changed.
	std::vector<GroundProbe> probes;      ///< See TileBuilder::probes; none if `unseen`.
	std::vector<MeshUpload> uploads;      ///< The same for the renderer, a part for each mesh; none if `unseen`.
	std::uint64_t microseconds = 0;       ///< Spent on it by workers.
	std::uint64_t points_computed = 0;    ///< For it; see SampleStats::computed.

	bool unseen = false; ///< Made for queries, not to be shown. Main thread only, as is the next.
	bool stale = false;  ///< Something that it shows was edited after it was begun.

	std::atomic<bool> cancelled = false; ///< Raised by the main thread, at any time.
};

/// Sorts jobs as work_order does. A job whose ground is half known keeps its index, and so does one that is made for queries.
void sort_jobs(std::deque<std::shared_ptr<TileJob>> &r_jobs, std::span<const Viewer> viewers);

/// Makes tiles on the engine's WorkerThreadPool, or on the main thread where there is none. Called on the main thread only,
/// apart from the work itself.
class TileWorkers {
public:
	/// At most `threads` tasks of the pool at a time. With 0, work is done in `work_until`.
	explicit TileWorkers(std::size_t threads);
	~TileWorkers();
	TileWorkers(const TileWorkers &) = delete;
	TileWorkers &operator=(const TileWorkers &) = delete;

	/// Queues a job. Jobs are worked on in the order in which they came, or as they were sorted since.
	void push(std::shared_ptr<TileJob> job);

	/// Sorts what waits; see sort_jobs. False if a worker is at it just now.
	bool sort(std::span<const Viewer> viewers);

	/// Takes out the jobs that are done or need ground, in the order in which they were finished. Cancelled ones come too. Never waits
	/// for a worker: what cannot be had at once comes in the next frame.
	/// To be called in every frame: it also starts workers for jobs that wait.
	std::vector<std::shared_ptr<TileJob>> take_finished();

	/// Lets go of something large where that costs the main thread nothing: on a worker, before the next job or, if none comes, within a second.
	void let_go(std::shared_ptr<const void> unneeded);

	/// The same for buffers that were uploaded: the worker that gets them writes later tiles into some of them.
	void take_back(std::vector<MeshUpload> &&uploads);

	/// How much of both has come to workers.
	std::uint64_t freed() const { return freed_.load(std::memory_order_relaxed); }

	/// How many buffers were written into once more.
	std::uint64_t reused() const;

	/// Without threads: makes tiles until the time is over, and one at least if any waits. A script that is asked for heights may
	/// call anything but this meanwhile. With threads: does nothing.
	void work_until(std::chrono::steady_clock::time_point deadline);

	/// Cancels everything and waits until no worker holds anything of ours: a few milliseconds, or as long as a script
	/// takes for the heights that it was just asked for.
	void stop();

	/// How many tiles are made at a time, at least 1.
	std::size_t threads() const { return workers_.size(); }

private:
	struct Worker {
		explicit Worker(const std::shared_ptr<BlockCache> &blocks) : builder(SampleMargins{}, blocks) {}

		TileWorkers *owner = nullptr;
		TileBuilder builder;
		TileInstances tile;
		SpareBuffers spare;
		std::shared_ptr<TileJob> job; ///< Guarded by mutex_.
		std::int64_t task = -1;       ///< The engine's task, -1 for none. Main thread only.
	};

	static bool lock_soon(std::unique_lock<std::mutex> &r_lock);
	void hand_over();

	/// Starts as many workers as there are jobs that wait, and one for what is unneeded.
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
	std::atomic<std::uint64_t> freed_ = 0;    ///< What was in unneeded_ and uploaded_.
	std::atomic<bool> much_unneeded_ = false; ///< Whether what is in both is worth a worker of its own.

	// Of the main thread alone: what is still to be put into the queue, and among what is unneeded.
	std::deque<std::shared_ptr<TileJob>> incoming_;
	std::vector<std::shared_ptr<const void>> unneeded_here_;
	std::vector<MeshUpload> uploaded_here_;
	int frames_unneeded_ = 0; ///< For so many there has been something in either.
	std::vector<std::unique_ptr<Worker>> workers_;
};

} // namespace thicket
