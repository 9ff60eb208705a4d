#include "nodes/scatter/scatter_stream.hpp"

#include "core/base/tile_grid.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/common/threads.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <new>
#include <optional>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// The number of tiles in progress per worker is chosen, within the limits below, so that a worker
/// needs this long for them. More tiles would delay the nearest ones after a viewer turns or a
/// setting changes. Fewer could leave workers idle between two frames.
constexpr std::uint64_t worker_lead_microseconds = 30'000;
constexpr std::size_t min_jobs_per_worker = 8;
constexpr std::size_t max_jobs_per_worker = 64;

/// The distance in meters that a viewer may move before waiting jobs are sorted again.
constexpr double sort_distance = 4.0;

/// Returns true if two versions of a layer have the same points and meshes. A tile of the old
/// version may then stay visible until the new one is ready.
bool are_interchangeable(const SharedSnapshot &a, const SharedSnapshot &b) {
	if (a == nullptr || b == nullptr) {
		return a == b;
	}
	return a->settings->set == b->settings->set && a->drawing.same_meshes(b->drawing);
}

/// Returns the tile size and view distance of a layer. An empty layer gets huge tiles and no view
/// distance, so that it requests almost no tiles.
StreamLayer range_of(const SharedSnapshot &layer) { return layer != nullptr ? layer->range : StreamLayer{1e6, 0.0}; }

WorldTile world_tile(const TileKey &key) { return {key.layer, key.tile, key.slab}; }

bool is_for_query(const std::shared_ptr<TileJob> &job) { return job->for_query; }

} // namespace

ScatterStream::ScatterStream(InstanceWorld &world) : world_(world), workers_(spare_thread_count()) {}

/// Marks jobs whose input or tile size has changed since they were started. Queries cannot use
/// their results.
void ScatterStream::mark_stale(std::span<const SharedSnapshot> layers, std::span<const EditedArea> outdated_areas) {
	for (const std::shared_ptr<TileJob> &job : jobs_) {
		const std::uint32_t layer = job->request.key.layer;
		job->is_stale = job->is_stale || layer >= layers.size() || layer >= outdated_areas.size() ||
				range_of(layers[layer]).tile_size != range_of(layers_[layer]).tile_size ||
				range_of(layers[layer]).in_space() != range_of(layers_[layer]).in_space() ||
				outdated_areas[layer].touches(job->request.space);
	}
}

void ScatterStream::set_layers(const std::vector<SharedSnapshot> &layers, std::span<const EditedArea> outdated_areas,
		const StreamGround &ground) {
	std::vector<StreamLayer> ranges;
	for (const SharedSnapshot &layer : layers) {
		ranges.push_back(range_of(layer));
	}
	// Allocate before changing the streamer. If this runs out of memory, the stream and the
	// streamer both keep the old layers.
	std::vector<SharedSnapshot> new_layers = layers;
	failures_.reserve(layers.size());
	const Status status = streamer_.set_layers(ranges);
	report("TerrainScatter3D", status);
	if (!status.ok()) {
		return;
	}
	forget_failure(recheck_failure_);
	failures_changed_ = failures_changed_ || failures_.size() > layers.size();
	failures_.resize(layers.size());
	for (std::uint32_t layer = 0; layer < layers.size(); ++layer) {
		const SharedSnapshot before = layer < layers_.size() ? layers_[layer] : nullptr;
		if (layer < layers_.size() && !are_interchangeable(before, layers[layer])) {
			streamer_.cancel(layer);
		}
		if (before == nullptr || layers[layer] == nullptr || before->settings != layers[layer]->settings ||
				!outdated_areas[layer].empty()) {
			forget_failure(failures_[layer]);
		}
	}
	mark_stale(layers, outdated_areas);
	layers_.swap(new_layers);
	ground_ = ground;
	display_.set_layers(layers);
	for (std::uint32_t layer = 0; layer < outdated_areas.size(); ++layer) {
		if (outdated_areas[layer].everywhere) {
			constexpr double infinity = std::numeric_limits<double>::infinity();
			recheck_.suspend(layer, {glm::dvec2(-infinity), glm::dvec2(infinity)});
			streamer_.invalidate(layer);
			continue;
		}
		for (const Rect &area : outdated_areas[layer].areas) {
			recheck_.suspend(layer, area);
			streamer_.invalidate(layer, area);
		}
	}
}

/// Completes a request without replacing the visible tile, because its content has not changed.
void ScatterStream::keep_displayed(const TileRequest &request) {
	streamer_.finish(request);
	recheck_.keep(request.key);
}

bool ScatterStream::frame(std::span<const Viewer> viewers, std::uint64_t budget) {
	const std::weak_ptr<const void> lifetime = life_; // A script may free this object during the frame.
	try {
		return work_in_frame(viewers, budget);
	} catch (const std::bad_alloc &) {
		if (!lifetime.expired()) {
			start_over();
		}
		throw;
	}
}

/// Does the work of `frame`. May throw std::bad_alloc.
bool ScatterStream::work_in_frame(std::span<const Viewer> viewers, std::uint64_t budget) {
	const Clock::time_point deadline = Clock::now() + std::chrono::microseconds(budget);
	allow_recheck(std::chrono::microseconds(budget));
	take_finished_jobs();
	times_.add_time(FramePart::finished_tiles);
	accept_viewers(viewers);
	if (!viewers_.empty()) {
		request_tiles();
		display_.set_viewers(viewers_);
	}
	start_query_jobs();
	times_.add_time(FramePart::tile_requests);
	workers_.work_until(deadline);
	return work_until(deadline);
}

std::size_t ScatterStream::jobs_per_worker() const {
	if (!ground_jobs_.empty()) {
		return min_jobs_per_worker; // The main thread is the bottleneck.
	}
	const std::uint64_t job_count = worker_lead_microseconds / std::max<std::uint64_t>(average_job_microseconds_, 1);
	return static_cast<std::size_t>(std::clamp<std::uint64_t>(job_count, min_jobs_per_worker, max_jobs_per_worker));
}

/// Accepts the viewers that are in range, so that tiles are still streamed around them. Skips the
/// others and reports the first error once.
void ScatterStream::accept_viewers(std::span<const Viewer> viewers) {
	const Status before = std::exchange(viewer_status_, Status());
	viewers_.clear();
	for (const Viewer &viewer : viewers) {
		const Status status = streamer_.check(viewer);
		if (status.ok()) {
			viewers_.push_back(viewer);
		} else if (viewer_status_.ok()) {
			viewer_status_ = status;
		}
	}
	if (viewer_status_.code != before.code) {
		report("TerrainScatter3D", viewer_status_);
	}
}

/// Requests the tiles that the viewers need, and cancels and hides those that they no longer need.
void ScatterStream::request_tiles() {
	const Status status = streamer_.update(viewers_, jobs_per_worker() * workers_.threads(), changes_);
	if (!status.ok()) {
		if (update_status_.code != status.code) {
			report("TerrainScatter3D", status);
		}
		update_status_ = status;
		return;
	}
	update_status_ = status;
	for (const TileRequest &request : changes_.cancel) {
		cancel(request.ticket);
	}
	for (const TileKey &key : changes_.drop) {
		recheck_.hide(key);
		if (display_.drop(key) && display_.find(key.layer, key.tile) == nullptr) {
			events_.push_back({false, key.layer, key.tile});
		}
	}
	for (const TileRequest &request : changes_.request) {
		start(request);
	}
	sort_work();
}

/// Sorts waiting jobs again once a viewer has moved far enough. The order does not affect the
/// content of the tiles.
void ScatterStream::sort_work() {
	const bool is_still_sorted =
			std::ranges::equal(viewers_, sorted_viewers_, [](const Viewer &current, const Viewer &sorted) {
				const glm::dvec2 offset = current.position - sorted.position;
				const double height_difference = current.height - sorted.height;
				return offset.x * offset.x + offset.y * offset.y + height_difference * height_difference <
						sort_distance * sort_distance;
			});
	if (is_still_sorted) {
		// No viewer has moved far enough to make sorting worthwhile.
		return;
	}
	if (!workers_.sort(viewers_)) {
		return;
	}
	sorted_viewers_ = viewers_;
	sort_jobs(ground_jobs_, viewers_);
}

/// Starts a job for a requested tile. Without a layer or a ground, keeps the visible tile.
void ScatterStream::start(const TileRequest &request) {
	const SharedSnapshot &layer = layers_[request.key.layer];
	if (layer == nullptr || !ground_.source.is_available()) {
		keep_displayed(request);
		return;
	}
	const auto job = std::make_shared<TileJob>();
	job->request = request;
	job->layer = layer;
	job->terrain = ground_.terrain;
	jobs_.push_back(job);
	workers_.push(job);
}

/// Starts jobs for tiles that queries need and that are not displayed. Tiles beyond the limit are
/// requested again in the next frame.
void ScatterStream::start_query_jobs() {
	const std::size_t max_jobs = min_jobs_per_worker * workers_.threads();
	auto query_job_count = static_cast<std::size_t>(std::ranges::count_if(jobs_, is_for_query));
	for (const WorldTile &tile : world_.take_missing()) {
		const auto generates_tile = [&tile](const std::shared_ptr<TileJob> &job) {
			return world_tile(job->request.key) == tile && !job->is_stale;
		};
		if (query_job_count == max_jobs || !ground_.source.is_available()) {
			return;
		}
		if (tile.layer >= layers_.size() || layers_[tile.layer] == nullptr) {
			continue;
		}
		if (std::ranges::any_of(jobs_, generates_tile)) {
			// The tile is already in progress.
			continue;
		}
		const auto job = std::make_shared<TileJob>();
		job->request.key = {tile.layer, 0, tile.tile, tile.slab};
		job->request.space = tile_space(layers_[tile.layer]->range.tile_size, tile.tile, tile.slab);
		job->layer = layers_[tile.layer];
		job->terrain = ground_.terrain;
		job->for_query = true;
		jobs_.push_back(job);
		workers_.push(job);
		++query_job_count;
	}
}

/// Cancels a request, in whichever state its job is.
void ScatterStream::cancel(std::uint64_t ticket) {
	const auto has_ticket = [ticket](const std::shared_ptr<TileJob> &job) {
		return job->request.ticket == ticket;
	};
	const auto entry = std::find_if(jobs_.begin(), jobs_.end(), has_ticket);
	if (entry != jobs_.end()) {
		(*entry)->cancelled = true;
		jobs_.erase(entry);
	}
	std::erase_if(ground_jobs_, has_ticket);
	if (std::optional<TileUpload> upload = uploads_.remove(ticket)) {
		display_.discard(*std::move(upload));
	}
}

void ScatterStream::take_finished_jobs() {
	for (const std::shared_ptr<TileJob> &job : workers_.take_finished_jobs()) {
		if (!job->cancelled) {
			process_result(job);
		}
	}
	for (std::shared_ptr<const CompactTile> &tile : world_.take_forgotten()) {
		workers_.free_on_worker(std::move(tile));
	}
}

/// Passes a job that a worker has returned to its next step: sampling, uploading or none.
void ScatterStream::process_result(const std::shared_ptr<TileJob> &job) {
	if (job->step == TileJob::Step::needs_ground) {
		ground_jobs_.push_back(job);
		return;
	}
	figures_.points_computed += job->points_computed;
	if (!job->status.ok()) {
		report_once(*job);
	}
	if (job->status.ok() && !job->is_stale) {
		world_.keep(world_tile(job->request.key), job->tile);
	}
	if (job->for_query) {
		process_query_result(job);
		return;
	}
	if (!job->status.ok() && display_.contains(job->request.key)) {
		std::erase(jobs_, job);
		keep_displayed(job->request);
		return;
	}
	if (!streamer_.ready(job->request)) {
		std::erase(jobs_, job);
		return;
	}
	++figures_.tiles_made;
	figures_.points_sampled += job->tile != nullptr ? job->tile->counts.sampled : 0;
	figures_.worker_microseconds += job->microseconds;
	average_job_microseconds_ = (7 * average_job_microseconds_ + job->microseconds) / 8;
	uploads_.push(job);
}

/// Completes a job for a query.
void ScatterStream::process_query_result(const std::shared_ptr<TileJob> &job) {
	std::erase(jobs_, job);
	if (!job->status.ok() && !job->is_stale && ground_.source.is_available()) {
		// A tile that cannot be generated is treated as empty until an edit invalidates it.
		world_.keep(world_tile(job->request.key), std::make_shared<const CompactTile>());
	}
}

/// Cancels all jobs and reports all tiles as hidden.
void ScatterStream::forget_work() {
	while (!jobs_.empty()) {
		cancel(jobs_.front()->request.ticket);
	}
	workers_.stop();
	ground_jobs_.clear();
	for (std::uint32_t layer = 0; layer < layers_.size(); ++layer) {
		for (const glm::ivec2 &tile : display_.tiles(layer)) {
			events_.push_back({false, layer, tile});
		}
	}
	uploads_.clear();
	recheck_.clear();
	streamer_.clear();
	world_.clear();
	figures_ = {};
}

void ScatterStream::stop() {
	forget_work();
	for (NearRing *ring : rings_) {
		ring->clear();
	}
	display_.clear();
}

void ScatterStream::retire() {
	forget_work();
	display_.retire();
}

std::vector<TileEvent> ScatterStream::take_events() { return std::exchange(events_, {}); }

bool ScatterStream::follows(std::span<const Viewer> viewers, const DrawLimits &limits) const {
	std::vector<Viewer> accepted_viewers;
	std::ranges::copy_if(viewers, std::back_inserter(accepted_viewers),
			[this](const Viewer &viewer) { return streamer_.check(viewer).ok(); });
	return accepted_viewers.empty() || (streamer_.follows(accepted_viewers) && display_.limits() == limits);
}

bool ScatterStream::idle() const {
	return streamer_.idle() && display_.settled() && !recheck_.has_changes() &&
			std::ranges::none_of(jobs_, is_for_query) &&
			std::ranges::all_of(rings_, [](const NearRing *ring) { return ring->settled(); });
}

} // namespace thicket
