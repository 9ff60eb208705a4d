#include "nodes/scatter/scatter_stream.hpp"

#include "core/base/tile_grid.hpp"
#include "nodes/common/property_check.hpp"

#include <godot_cpp/core/error_macros.hpp>

#include <algorithm>
#include <optional>
#include <string>
#include <thread>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Tiles under way for each worker: enough that none runs dry between two frames, few enough that the nearest tiles
/// still come first after a turn or a change: as many as take a worker this long, within limits.
constexpr std::uint64_t worker_lead_microseconds = 30'000;
constexpr std::size_t min_jobs_per_worker = 8;
constexpr std::size_t max_jobs_per_worker = 64;

/// Meters that a viewer may move before the work that waits is sorted anew.
constexpr double sort_distance = 4.0;

std::size_t worker_count() {
	const std::size_t cores = std::thread::hardware_concurrency();
	return std::clamp<std::size_t>(cores, 2, 9) - 1; // One core stays with the main thread.
}

/// The usual time of a step, after another one. A step in which the machine did something else counts as a slow one
/// only, or a single such would hold up the stream for many frames.
std::chrono::steady_clock::duration smoothed(
		std::chrono::steady_clock::duration usual, std::chrono::steady_clock::duration step) {
	const auto believed = std::min(step, 4 * usual + std::chrono::microseconds(1));
	return usual + (believed - usual) / 8;
}

/// True if a tile made for one layer may be shown for the other until its own is there: the same points and meshes.
bool interchangeable(const StreamedLayer &a, const StreamedLayer &b) {
	return a.plan->wanted == b.plan->wanted && a.plan->settings->set == b.plan->settings->set &&
			a.look.meshes == b.look.meshes && a.look.lod_meshes == b.look.lod_meshes;
}

bool is_unseen(const std::shared_ptr<TileJob> &job) { return job->unseen; }

void report_tile(const TileKey &key, const Status &status) {
	const std::string tile = std::to_string(key.tile.x) + ", " + std::to_string(key.tile.y);
	const std::string text =
			"TerrainScatter3D, layer " + std::to_string(key.layer) + ", tile (" + tile + "): " + describe(status);
	ERR_PRINT(String(text.c_str()));
}

} // namespace

ScatterStream::ScatterStream(InstanceWorld &world) : world_(world), workers_(worker_count()) {}

/// What is under way and shows something that has changed since, or a tile of another size, is of no use to those who ask.
void ScatterStream::mark_stale(std::span<const StreamedLayer> next, std::span<const EditedArea> outdated) {
	for (const std::shared_ptr<TileJob> &job : jobs_) {
		const std::uint32_t layer = job->request.key.layer;
		job->stale = job->stale || layer >= next.size() || layer >= outdated.size() ||
				next[layer].range.tile_size != layers_[layer].range.tile_size ||
				outdated[layer].touches(job->request.rect);
	}
}

void ScatterStream::set_layers(
		std::vector<StreamedLayer> layers, std::span<const EditedArea> outdated, const HostedTerrain &script) {
	std::vector<StreamLayer> ranges;
	std::vector<LayerLook> looks;
	for (const StreamedLayer &layer : layers) {
		ranges.push_back(layer.range);
		looks.push_back(layer.look);
	}
	const Status status = streamer_.set_layers(ranges);
	report("TerrainScatter3D", status);
	if (!status.ok()) {
		return;
	}
	for (std::uint32_t layer = 0; layer < std::min(layers.size(), layers_.size()); ++layer) {
		if (!interchangeable(layers_[layer], layers[layer])) {
			streamer_.cancel(layer);
		}
	}
	mark_stale(layers, outdated);
	layers_ = std::move(layers);
	script_ = script;
	stage_.set_looks(std::move(looks));
	for (std::uint32_t layer = 0; layer < outdated.size(); ++layer) {
		if (outdated[layer].everywhere) {
			streamer_.invalidate(layer);
			continue;
		}
		for (const Rect &area : outdated[layer].areas) {
			streamer_.invalidate(layer, area);
		}
	}
}

void ScatterStream::frame(std::span<const Viewer> viewers, std::uint64_t budget) {
	const Clock::time_point deadline = Clock::now() + std::chrono::microseconds(budget);
	take_finished();
	if (!viewers.empty()) {
		request_tiles(viewers);
		stage_.look_around(viewers);
	}
	start_missing();
	work_until(deadline);
}

std::size_t ScatterStream::jobs_per_worker() const {
	if (!ask_ground_.empty()) {
		return min_jobs_per_worker; // What takes the time is not the workers.
	}
	const std::uint64_t fitting = worker_lead_microseconds / std::max<std::uint64_t>(usual_job_microseconds_, 1);
	return std::clamp<std::uint64_t>(fitting, min_jobs_per_worker, max_jobs_per_worker);
}

void ScatterStream::request_tiles(std::span<const Viewer> viewers) {
	const Status status = streamer_.update(viewers, jobs_per_worker() * workers_.threads(), changes_);
	if (!status.ok()) {
		if (viewer_status_.code != status.code) {
			report("TerrainScatter3D", status);
		}
		viewer_status_ = status;
		return;
	}
	viewer_status_ = status;
	for (const TileRequest &request : changes_.cancel) {
		cancel(request.ticket);
	}
	for (const TileKey &key : changes_.drop) {
		if (stage_.drop(key)) {
			events_.push_back({false, key.layer, key.tile});
		}
	}
	for (const TileRequest &request : changes_.request) {
		start(request);
	}
	sort_work(viewers);
}

/// Once viewers have moved on, what waits is worked on in another order.
void ScatterStream::sort_work(std::span<const Viewer> viewers) {
	const bool same = std::ranges::equal(viewers, sorted_for_, [](const Viewer &now, const Viewer &then) {
		const glm::dvec2 way = now.position - then.position;
		return way.x * way.x + way.y * way.y < sort_distance * sort_distance;
	});
	if (same) {
		return;
	}
	sorted_for_.assign(viewers.begin(), viewers.end());
	workers_.sort(viewers);
	sort_jobs(ask_ground_, viewers);
}

void ScatterStream::start(const TileRequest &request) {
	const std::shared_ptr<const LayerPlan> &plan = layers_[request.key.layer].plan;
	if (!plan->wanted || !script_.is_available()) {
		streamer_.finish(request); // What stands there stays.
		return;
	}
	const auto job = std::make_shared<TileJob>();
	job->request = request;
	job->plan = plan;
	jobs_.push_back(job);
	workers_.push(job);
}

/// Has tiles made that somebody has asked for, for nobody to see. What there is no room for is missed again in the next frame.
void ScatterStream::start_missing() {
	const std::size_t room = min_jobs_per_worker * workers_.threads();
	auto under_way = static_cast<std::size_t>(std::ranges::count_if(jobs_, is_unseen));
	for (const WorldTile &tile : world_.take_missing()) {
		const auto makes = [&tile](const std::shared_ptr<TileJob> &job) {
			return job->request.key.layer == tile.layer && job->request.key.tile == tile.tile && !job->stale;
		};
		if (under_way == room || !script_.is_available()) {
			return;
		}
		if (tile.layer >= layers_.size() || std::ranges::any_of(jobs_, makes)) {
			continue;
		}
		const auto job = std::make_shared<TileJob>();
		job->request.key = {tile.layer, 0, tile.tile};
		job->request.rect = tile_rect(layers_[tile.layer].range.tile_size, tile.tile);
		job->plan = layers_[tile.layer].plan;
		job->unseen = true;
		jobs_.push_back(job);
		workers_.push(job);
		++under_way;
	}
}

void ScatterStream::cancel(std::uint64_t ticket) {
	const auto has_ticket = [ticket](const std::shared_ptr<TileJob> &job) {
		return job->request.ticket == ticket;
	};
	const auto found = std::find_if(jobs_.begin(), jobs_.end(), has_ticket);
	if (found != jobs_.end()) {
		(*found)->cancelled = true;
		jobs_.erase(found);
	}
	std::erase_if(ask_ground_, has_ticket);
	stage_.forget(ticket);
}

void ScatterStream::take_finished() {
	for (const std::shared_ptr<TileJob> &job : workers_.take_finished()) {
		if (!job->cancelled) {
			settle(job);
		}
	}
}

void ScatterStream::settle(const std::shared_ptr<TileJob> &job) {
	if (job->step == TileJob::Step::needs_ground) {
		ask_ground_.push_back(job);
		return;
	}
	const std::uint32_t index = job->request.key.layer;
	if (!job->status.ok() && script_.is_available() && index < layers_.size() && layers_[index].plan == job->plan &&
			!std::exchange(layers_[index].error_reported, true)) {
		report_tile(job->request.key, job->status);
	}
	if (job->status.ok() && !job->stale) {
		world_.keep(index, job->request.key.tile, job->tile);
	}
	if (job->unseen) {
		settle_unseen(job);
		return;
	}
	if (!job->status.ok() && stage_.holds(job->request.key)) {
		std::erase(jobs_, job);
		streamer_.finish(job->request);
		return;
	}
	if (!streamer_.ready(job->request)) {
		std::erase(jobs_, job);
		return;
	}
	++figures_.tiles_made;
	figures_.points_sampled += job->tile != nullptr ? job->tile->counts.sampled : 0;
	figures_.worker_microseconds += job->microseconds;
	usual_job_microseconds_ = (7 * usual_job_microseconds_ + job->microseconds) / 8;
	stage_.push(job);
}

void ScatterStream::settle_unseen(const std::shared_ptr<TileJob> &job) {
	std::erase(jobs_, job);
	if (!job->status.ok() && !job->stale && script_.is_available()) {
		// Nothing stands where a tile cannot be made; an edit makes it missing again.
		world_.keep(job->request.key.layer, job->request.key.tile, std::make_shared<const TileInstances>());
	}
}

std::size_t ScatterStream::ground_step(std::size_t most) {
	if (ask_ground_.empty()) {
		return 0;
	}
	const std::shared_ptr<TileJob> job = ask_ground_.front();
	const auto part = std::find_if(job->parts.begin(), job->parts.end(),
			[&job](const TileJob::Part &candidate) { return candidate.end > job->answered; });
	const std::size_t count = part != job->parts.end() ? std::min(most, part->end - job->answered) : 0;
	Status status;
	if (count > 0) {
		status = script_.sample_now(std::span<const glm::dvec2>(job->positions).subspan(job->answered, count),
				part->textures, std::span(job->ground).subspan(job->answered, count));
		if (ask_ground_.empty() || ask_ground_.front() != job) {
			return 0; // A script has changed the stream that asked it.
		}
	}
	job->answered += count;
	if (!status.ok()) {
		ask_ground_.pop_front();
		job->status = status;
		job->step = TileJob::Step::done;
		settle(job);
	} else if (job->answered == job->positions.size()) {
		ask_ground_.pop_front();
		job->step = TileJob::Step::has_ground;
		workers_.push(job);
	}
	return std::max<std::size_t>(count, 1);
}

bool ScatterStream::ground_step_in_frame() {
	const Ref<ScatterTerrain> &terrain = script_.terrain;
	return terrain.is_valid() && !terrain->needs_physics_frames() && ground_step(terrain->max_positions_per_call()) > 0;
}

void ScatterStream::physics_frame() {
	const Ref<ScatterTerrain> &terrain = script_.terrain;
	std::size_t left = terrain.is_valid() && terrain->needs_physics_frames() ? terrain->max_positions_per_call() : 0;
	while (left > 0) {
		const std::size_t asked = ground_step(left);
		left = asked > 0 ? left - asked : 0;
	}
}

/// Uploads a part of the tile whose turn it is, and shows the tile with its last part: no far tile before a near one.
bool ScatterStream::show_step() {
	if (!stage_.is_uploading()) {
		const std::optional<TileRequest> next = streamer_.next_ready();
		if (!next || !stage_.choose(next->ticket)) {
			return false;
		}
	}
	(void)stage_.upload_step();
	if (const TileJob *job = stage_.completed()) {
		const TileRequest request = job->request;
		if (!streamer_.may_show(request)) {
			stage_.set_aside(); // The viewer has moved since it was chosen.
			return true;
		}
		std::erase_if(jobs_, [job](const std::shared_ptr<TileJob> &other) { return other.get() == job; });
		if (streamer_.finish(request)) {
			stage_.present();
			events_.push_back({true, request.key.layer, request.key.tile});
		} else {
			stage_.reject();
		}
	}
	return true;
}

bool ScatterStream::ring_step() {
	bool moved = false;
	for (NearRing *ring : rings_) {
		moved = ring->step() || moved;
	}
	return moved;
}

bool ScatterStream::step(std::size_t kind) {
	switch (kind) {
		case 0: return ground_step_in_frame();
		case 1: return show_step();
		case 2: return stage_.free_step();
		case 3: return stage_.detail_step();
		default: return ring_step();
	}
}

/// Steps of all kinds in turn. One for which too little time is left comes first in the next frame.
void ScatterStream::work_until(Clock::time_point deadline) {
	bool first = true;
	std::size_t in_vain = 0; // So many kinds in a row had nothing to do.
	Clock::time_point before = Clock::now();
	while (in_vain < usual_step_.size()) {
		Clock::duration &usual = usual_step_[step_turn_];
		if (!first && before + usual > deadline) {
			return;
		}
		const bool done = step(step_turn_);
		step_turn_ = (step_turn_ + 1) % usual_step_.size();
		in_vain = done ? 0 : in_vain + 1;
		if (done) {
			const Clock::time_point now = Clock::now();
			usual = smoothed(usual, now - before);
			before = now;
			first = false;
		}
	}
}

void ScatterStream::stop() {
	for (const std::shared_ptr<TileJob> &job : jobs_) {
		job->cancelled = true;
	}
	workers_.stop();
	jobs_.clear();
	ask_ground_.clear();
	for (std::uint32_t layer = 0; layer < layers_.size(); ++layer) {
		for (const glm::ivec2 &tile : stage_.tiles(layer)) {
			events_.push_back({false, layer, tile});
		}
	}
	for (NearRing *ring : rings_) {
		ring->clear();
	}
	stage_.clear();
	streamer_.clear();
	world_.clear();
	figures_ = {};
}

std::vector<TileEvent> ScatterStream::take_events() { return std::exchange(events_, {}); }

bool ScatterStream::idle() const {
	return streamer_.idle() && stage_.settled() && std::ranges::none_of(jobs_, is_unseen) &&
			std::ranges::all_of(rings_, [](const NearRing *ring) { return ring->settled(); });
}

} // namespace thicket
