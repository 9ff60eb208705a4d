#include "nodes/workers/tile_workers.hpp"

#include "core/base/guard.hpp"
#include "core/sampling/block_cache.hpp"
#include "core/streaming/work_order.hpp"

#include <godot_cpp/classes/worker_thread_pool.hpp>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <thread>
#include <utility>

using namespace godot;

namespace thicket {

void sort_jobs(std::deque<std::shared_ptr<TileJob>> &r_jobs, std::span<const Viewer> viewers) {
	std::vector<std::size_t> indices;
	std::vector<std::shared_ptr<TileJob>> jobs;
	std::vector<TileSpace> areas;
	for (std::size_t index = 0; index < r_jobs.size(); ++index) {
		const std::shared_ptr<TileJob> &job = r_jobs[index];
		if (!job->for_query && (job->step != TileJob::Step::needs_ground || job->answered_count == 0)) {
			indices.push_back(index);
			jobs.push_back(job);
			areas.push_back(job->request.space);
		}
	}
	std::vector<std::size_t> order;
	work_order(areas, viewers, order);
	for (std::size_t i = 0; i < indices.size(); ++i) {
		r_jobs[indices[i]] = jobs[order[i]];
	}
}

TileWorkers::TileWorkers(std::size_t threads) : on_main_thread_(threads == 0) {
	const auto blocks = std::make_shared<BlockCache>();
	const auto instances = std::make_shared<InstanceCache>();
	for (std::size_t index = 0; index < std::max<std::size_t>(threads, 1); ++index) {
		workers_.push_back(std::make_unique<Worker>(blocks, instances));
		workers_.back()->owner = this;
	}
}

TileWorkers::~TileWorkers() { stop(); }

/// Tries for a few microseconds to take the lock. Does not block: the system may have paused a
/// worker that holds the lock, and the frame must not wait for it.
bool TileWorkers::try_lock_briefly(std::unique_lock<std::mutex> &r_lock) {
	constexpr int max_tries = 200;
	for (int i = 0; i < max_tries && !r_lock.owns_lock(); ++i) {
		static_cast<void>(r_lock.try_lock());
	}
	return r_lock.owns_lock();
}

void TileWorkers::push(std::shared_ptr<TileJob> job) {
	pending_jobs_.push_back(std::move(job));
	flush_pending();
}

/// Moves new jobs and unneeded objects to the shared queues. If the lock is taken, a later call
/// moves them.
void TileWorkers::flush_pending() {
	std::unique_lock lock(mutex_, std::defer_lock);
	if (try_lock_briefly(lock)) {
		// Reserves space so that workers never allocate to return a result. An error here reaches
		// the caller.
		const std::size_t jobs = finished_jobs_.size() + queue_.size() + pending_jobs_.size() + workers_.size();
		finished_jobs_.reserve(std::max(finished_jobs_.capacity(), jobs));
		queue_.insert(queue_.end(), pending_jobs_.begin(), pending_jobs_.end());
		pending_jobs_.clear();
		unneeded_objects_.insert(unneeded_objects_.end(), pending_objects_.begin(), pending_objects_.end());
		pending_objects_.clear();
		std::ranges::move(pending_buffers_, std::back_inserter(uploaded_buffers_));
		pending_buffers_.clear();
		waiting_count_ = queue_.size();
		// Starting a worker takes microseconds as well, so it must be worthwhile.
		const std::size_t all_unneeded = unneeded_objects_.size() + uploaded_buffers_.size();
		unneeded_frame_count_ = all_unneeded == 0 ? 0 : unneeded_frame_count_ + 1;
		has_much_unneeded_ = all_unneeded >= 16 || unneeded_frame_count_ > 60;
		lock.unlock();
	}
	start_workers();
}

bool TileWorkers::sort(std::span<const Viewer> viewers) {
	std::unique_lock lock(mutex_, std::defer_lock);
	if (!try_lock_briefly(lock)) {
		return false;
	}
	sort_jobs(queue_, viewers);
	return true;
}

std::vector<std::shared_ptr<TileJob>> TileWorkers::take_finished_jobs() {
	flush_pending();
	std::vector<std::shared_ptr<TileJob>> jobs;
	std::unique_lock lock(mutex_, std::defer_lock);
	if (try_lock_briefly(lock)) {
		jobs.reserve(queue_.size() + workers_.size()); // Reserved for workers; see `flush_pending`.
		jobs.swap(finished_jobs_);
	}
	return jobs;
}

void TileWorkers::free_on_worker(std::shared_ptr<const void> object) {
	if (!on_main_thread_) {
		// A worker frees the object.
		pending_objects_.push_back(std::move(object));
	}
}

void TileWorkers::take_back(std::vector<MeshUpload> &&uploads) {
	if (!on_main_thread_) {
		// A worker frees the buffers or reuses them.
		std::ranges::move(uploads, std::back_inserter(pending_buffers_));
	}
}

std::uint64_t TileWorkers::reused_count() const {
	std::uint64_t sum = 0;
	for (const std::unique_ptr<Worker> &worker : workers_) {
		sum += worker->buffer_pool.reused_count();
	}
	return sum;
}

void TileWorkers::start_workers() {
	if (on_main_thread_) {
		return;
	}
	WorkerThreadPool *pool = WorkerThreadPool::get_singleton();
	std::size_t needed_count = std::max<std::size_t>(waiting_count_, has_much_unneeded_ ? 1 : 0);
	for (const std::unique_ptr<Worker> &worker : workers_) {
		if (needed_count == 0) {
			return;
		}
		// Skips workers that have run out of jobs and are just returning to the pool, because
		// waiting for them could cost the frame milliseconds. Another worker takes the job now, or
		// this one takes it in the next frame.
		if (worker->task >= 0 && !pool->is_task_completed(worker->task)) {
			continue;
		}
		if (worker->task >= 0) {
			pool->wait_for_task_completion(worker->task); // Frees the completed task.
		}
		worker->task = pool->add_native_task(&TileWorkers::run, worker.get(), false, "Thicket tiles");
		--needed_count;
	}
}

void TileWorkers::stop() {
	pending_jobs_.clear();
	pending_objects_.clear();
	pending_buffers_.clear();
	{
		const std::lock_guard lock(mutex_);
		queue_.clear();
		waiting_count_ = 0;
		for (const std::unique_ptr<Worker> &worker : workers_) {
			if (worker->job != nullptr) {
				worker->job->cancelled = true;
			}
		}
	}
	for (const std::unique_ptr<Worker> &worker : workers_) {
		if (worker->task >= 0) {
			WorkerThreadPool::get_singleton()->wait_for_task_completion(worker->task);
			worker->task = -1;
		}
	}
	finished_jobs_.clear();
	unneeded_objects_.clear();
	uploaded_buffers_.clear();
}

void TileWorkers::work_until(std::chrono::steady_clock::time_point deadline) {
	if (!on_main_thread_) {
		return;
	}
	Worker &worker = *workers_.front();
	while (process_next_job(worker) && std::chrono::steady_clock::now() < deadline) {}
	const std::lock_guard lock(mutex_);
	return_result(worker);
}

/// Moves a worker's result to the finished jobs. The caller must hold the lock.
void TileWorkers::return_result(Worker &worker) {
	if (worker.job != nullptr) {
		finished_jobs_.push_back(std::move(worker.job)); // Does not allocate; see `flush_pending`.
		worker.job = nullptr;
	}
}

/// Adds the worker's last result to the finished jobs, then removes and returns the next job; null if
/// the queue is empty. Also frees unneeded objects, and keeps uploaded buffers for reuse.
std::shared_ptr<TileJob> TileWorkers::take_next_job(Worker &worker) {
	std::vector<std::shared_ptr<const void>> unneeded_objects; // Freed after the lock is released.
	std::vector<MeshUpload> uploaded_buffers;
	std::shared_ptr<TileJob> job;
	{
		const std::lock_guard lock(mutex_);
		unneeded_objects.swap(unneeded_objects_);
		uploaded_buffers.swap(uploaded_buffers_);
		has_much_unneeded_ = false;
		return_result(worker);
		if (!queue_.empty()) {
			job = std::move(queue_.front());
			queue_.pop_front();
			waiting_count_ = queue_.size();
			worker.job = job;
		}
	}
	freed_count_.fetch_add(unneeded_objects.size() + uploaded_buffers.size(), std::memory_order_relaxed);
	worker.buffer_pool.keep(std::move(uploaded_buffers));
	return job;
}

void TileWorkers::run(void *p_worker) {
	Worker &worker = *static_cast<Worker *>(p_worker);
	do {
		std::this_thread::yield(); // The main thread may be waiting for this core.
	} while (worker.owner->process_next_job(worker));
}

/// Processes the next job as far as possible without the main thread. Returns false if there is
/// none.
bool TileWorkers::process_next_job(Worker &worker) {
	const std::shared_ptr<TileJob> job = take_next_job(worker);
	if (job == nullptr) {
		return false;
	}
	if (job->cancelled) {
		// The tile is no longer needed.
		job->status.code = ErrorCode::cancelled;
		job->step = TileJob::Step::done;
		return true;
	}
	const auto start = std::chrono::steady_clock::now();
	const Rect &rect = job->request.space;
	const Status status = guarded("tile", std::max(rect.size().x, rect.size().y), [&] { advance(worker, *job); });
	if (!status.ok()) {
		job->status = status;
		job->uploads = {};
		finish(worker, *job);
	}
	const auto time = std::chrono::steady_clock::now() - start;
	job->microseconds +=
			static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::microseconds>(time).count());
	return true;
}

/// Processes a job until it is finished or needs the main thread.
void TileWorkers::advance(Worker &worker, TileJob &job) {
	const LayerSettings &settings = *job.layer->settings;
	TileBuilder &builder = worker.builder;
	if (job.terrain != nullptr && !needs_main_thread(settings)) {
		job.status = builder.build(settings, *job.terrain, job.request.space, worker.tile, &job.cancelled);
		job.points_computed += builder.sample_stats().computed;
		finish(worker, job);
		return;
	}
	// Without a thread-safe ground and rules, a job gets here at least twice and computes its points each
	// time. Computing them twice costs less than the script calls in between and frees the workspace
	// while the job waits for the main thread.
	const Surface *surface = job.terrain != nullptr ? job.terrain->surface() : nullptr;
	job.status = builder.find_points(settings, job.request.space, &job.cancelled, nullptr, surface);
	job.points_computed += builder.sample_stats().computed;
	if (job.step == TileJob::Step::has_ground) {
		job.earlier_ground.push_back(std::move(job.ground));
	}
	for (const std::vector<Ground> &ground : job.earlier_ground) {
		if (job.status.ok() && builder.is_complete()) {
			job.status = builder.place(ground, worker.tile, &job.cancelled);
			finish(worker, job);
			return;
		}
		if (job.status.ok()) {
			job.status = builder.find_further(ground, &job.cancelled);
			job.points_computed += builder.sample_stats().computed;
		}
	}
	if (job.status.ok()) {
		job.status = prepare_queries(builder, job);
	}
	if (!job.status.ok()) {
		finish(worker, job);
	}
}

/// Prepares the work of the main thread on a job. Samples the ground here if it is thread-safe.
Status TileWorkers::prepare_queries(const TileBuilder &builder, TileJob &job) {
	job.answered_count = 0;
	job.parts.clear();
	job.positions.assign(builder.positions().begin(), builder.positions().end());
	job.ground.assign(job.positions.size(), Ground{});
	for (const GroundQuery &query : builder.queries()) {
		const std::span<const std::int32_t> textures = query.needs.textures;
		const std::span<const SharedDensityRule> rules = query.density.rules;
		job.parts.push_back({query.first + query.count, {textures.begin(), textures.end()}, query.needs.normals,
				{rules.begin(), rules.end()}, {{}, query.density.sides, query.density.planet}});
	}
	job.step = TileJob::Step::needs_ground;
	return job.terrain != nullptr
			? query_terrain(*job.terrain, job.positions, builder.queries(), job.ground, &job.cancelled)
			: Status();
}

/// Ends a job: frees its intermediate data and, unless it failed, prepares the tile for upload.
void TileWorkers::finish(Worker &worker, TileJob &job) {
	job.step = TileJob::Step::done;
	job.positions = {};
	job.parts = {};
	job.ground = {};
	job.earlier_ground = {};
	if (!job.status.ok()) {
		return;
	}
	if (!job.for_query) {
		job.probes.assign(worker.builder.probes().begin(), worker.builder.probes().end());
	}
	for (std::size_t mesh = 0; !job.for_query && mesh < worker.tile.meshes.size(); ++mesh) {
		job.uploads.push_back(
				to_upload(worker.tile.meshes[mesh], job.layer->drawing.reach_of(mesh), worker.buffer_pool));
	}
	job.tile = std::make_shared<const CompactTile>(worker.tile, job.layer->settings);
}

} // namespace thicket
