// This file does the work of a frame in small steps of several kinds, which take turns until the
// time is spent.

#include "nodes/scatter/scatter_stream.hpp"

#include <algorithm>
#include <optional>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// The number of positions per call to a density rule on the main thread, if workers sample the
/// ground. GDScript needs about 0.1 ms for such a call.
constexpr std::size_t density_rule_slice = 128;

/// While tiles wait to be uploaded, the stream takes one division step per this many uploads. A
/// delayed division does not change the image; it only means that more triangles are drawn.
constexpr std::uint32_t uploads_per_divide = 32;

/// While tiles wait to be uploaded, the stream takes one step for LOD fades per this many uploads.
/// Until a fade is prepared, its LODs switch abruptly.
constexpr std::uint32_t uploads_per_fade = 8;

/// Updates the average time of a step. Caps outliers; otherwise a single step during which the
/// thread was preempted would delay the stream for many frames.
std::chrono::steady_clock::duration smoothed(
		std::chrono::steady_clock::duration average, std::chrono::steady_clock::duration step) {
	const auto capped_step = std::min(step, 4 * average + std::chrono::microseconds(1));
	return average + (capped_step - average) / 8;
}

} // namespace

/// Samples the ground and the density rules of the first waiting tile at up to `max_count` positions.
/// Returns the number of positions; at least 1 if a tile was processed. Returns 0 if no tile waits, or
/// if a script has changed the stream.
std::size_t ScatterStream::ground_step(std::size_t max_count) {
	if (ground_jobs_.empty() || max_count == 0) {
		return 0;
	}
	const std::shared_ptr<TileJob> job = ground_jobs_.front();
	const auto part = std::find_if(job->parts.begin(), job->parts.end(),
			[&job](const TileJob::Part &candidate) { return candidate.end > job->answered_count; });
	const std::size_t count = part != job->parts.end() ? std::min(max_count, part->end - job->answered_count) : 0;
	Status status;
	if (count > 0) {
		const std::weak_ptr<const void> lifetime = life_;
		const auto is_interrupted = [&] { // True if a script has freed or changed this stream.
			return lifetime.expired() || ground_jobs_.empty() || ground_jobs_.front() != job;
		};
		const auto positions = std::span<const glm::dvec2>(job->positions).subspan(job->answered_count, count);
		const auto ground = std::span(job->ground).subspan(job->answered_count, count);
		if (job->terrain == nullptr) {
			status = ground_.source.sample_now(positions, {part->textures, part->normals}, ground);
			if (is_interrupted()) {
				return 0;
			}
		}
		if (status.ok()) {
			status = part->query_density(positions, ground);
			if (is_interrupted()) {
				return 0;
			}
		}
	}
	job->answered_count += count;
	if (!status.ok()) {
		ground_jobs_.pop_front();
		job->status = status;
		job->step = TileJob::Step::done;
		process_result(job);
	} else if (job->answered_count == job->positions.size()) {
		ground_jobs_.pop_front();
		job->step = TileJob::Step::has_ground;
		workers_.push(job);
	}
	return std::max<std::size_t>(count, 1);
}

/// Returns the number of positions at which the ground may be sampled now. Returns 0 if the ground
/// must be sampled in physics frames and `in_physics_frame` is false, or the reverse.
std::size_t ScatterStream::max_positions(bool in_physics_frame) const {
	const Ref<ScatterGround> &ground = ground_.source.ground;
	if (ground_.terrain != nullptr) {
		return in_physics_frame ? 0 : density_rule_slice;
	}
	return ground.is_valid() && ground->needs_physics_frames() == in_physics_frame ? ground->max_positions_per_call()
																				   : 0;
}

void ScatterStream::physics_frame() {
	std::size_t remaining_count = max_positions(true);
	if (remaining_count > 0) {
		remaining_count -= recheck_heights(std::max<std::size_t>(remaining_count / 16, 1)); // Rays run no script.
	}
	while (remaining_count > 0) {
		const std::size_t sampled_count = ground_step(remaining_count);
		remaining_count = sampled_count > 0 ? remaining_count - sampled_count : 0;
	}
}

/// Uploads a part of the next tile and shows the tile after its last part. Tiles are completed one
/// by one, so that no far tile appears before a near one.
bool ScatterStream::upload_step() {
	if (uploads_.state() == UploadQueue::State::idle) {
		const std::optional<TileRequest> request = streamer_.next_ready();
		if (!request || !uploads_.choose(request->ticket)) {
			return false;
		}
	}
	if (uploads_.state() == UploadQueue::State::uploading) {
		display_.upload_some(uploads_.current(), uploads_.size() > 1);
		uploads_.part_uploaded();
		++uploads_since_divide_;
		++uploads_since_fade_;
	}
	if (uploads_.state() == UploadQueue::State::complete) {
		finish_upload();
	}
	return true;
}

/// Shows an uploaded tile, or discards it if it is no longer needed.
void ScatterStream::finish_upload() {
	const std::shared_ptr<TileJob> job = uploads_.current().job;
	if (!streamer_.may_show(job->request)) {
		uploads_.put_back(); // A viewer has moved since the tile was chosen.
		return;
	}
	std::erase(jobs_, job);
	if (streamer_.finish(job->request)) {
		if (rechecks()) {
			recheck_.show(job->request.key, job->request.space, std::move(job->probes), job->is_stale);
		}
		display_.show(uploads_.take());
		events_.push_back({true, job->request.key.layer, job->request.key.tile});
	} else {
		display_.discard(uploads_.take());
	}
	// The renderer has copied the buffers. A worker frees them, because freeing them here could
	// take a millisecond.
	workers_.take_back(std::move(job->uploads));
}

/// Does one step of work for each ring. Returns false if there was none.
bool ScatterStream::ring_step() {
	bool has_worked = false;
	for (NearRing *ring : rings_) {
		has_worked = ring->step() || has_worked;
	}
	return has_worked;
}

void ScatterStream::dissolve_until(Clock::time_point deadline) {
	bool has_work = true;
	while (has_work) {
		has_work = ring_step();
		has_work = display_.free_step() || has_work;
		has_work = has_work && Clock::now() < deadline;
	}
}

bool ScatterStream::may_divide() const {
	return display_.has_divisions() && (uploads_.size() == 0 || uploads_since_divide_ >= uploads_per_divide);
}

bool ScatterStream::may_fade() const {
	return display_.has_fades() && (uploads_.size() == 0 || uploads_since_fade_ >= uploads_per_fade);
}

ScatterStream::Step ScatterStream::following_step(Step step) {
	return static_cast<Step>((static_cast<std::size_t>(step) + 1) % step_kinds);
}

FramePart ScatterStream::part_of(Step step) {
	return static_cast<FramePart>(static_cast<std::size_t>(FramePart::query_ground) + static_cast<std::size_t>(step));
}

/// Does one step of a kind of work. Returns false if there was none.
bool ScatterStream::do_step(Step step) {
	switch (step) {
		case Step::query_ground: return ground_step(max_positions(false)) > 0;
		case Step::upload: return upload_step();
		case Step::free: return display_.free_step();
		case Step::lod: return display_.lod_step();
		case Step::divide: uploads_since_divide_ = 0; return display_.divide_step();
		case Step::fade: uploads_since_fade_ = 0; return display_.fade_step();
		case Step::rings: return ring_step();
		case Step::recheck: return recheck_step();
	}
	return false;
}

/// Runs steps of all kinds in turn until the deadline or until no kind has work. If too little time
/// is left for a step, the next frame starts with it. Returns false if a script has freed the stream.
bool ScatterStream::work_until(Clock::time_point deadline) {
	const std::weak_ptr<const void> lifetime = life_;
	bool is_first_step = true;
	std::size_t idle_steps = 0; // The number of consecutive steps that found no work.
	Clock::time_point step_start = Clock::now();
	while (idle_steps < step_kinds) {
		const bool is_deferred =
				(next_step_ == Step::divide && !may_divide()) || (next_step_ == Step::fade && !may_fade());
		if (is_deferred) { // Skipped regardless of the time left.
			next_step_ = following_step(next_step_);
			++idle_steps;
			continue;
		}
		Clock::duration &average = average_step_times_[static_cast<std::size_t>(next_step_)];
		if (!is_first_step && step_start + average > deadline) {
			return true;
		}
		const bool has_worked = do_step(next_step_);
		if (lifetime.expired()) {
			return false;
		}
		times_.add_time(part_of(next_step_));
		next_step_ = following_step(next_step_);
		idle_steps = has_worked ? 0 : idle_steps + 1;
		if (has_worked) {
			const Clock::time_point now = Clock::now();
			average = smoothed(average, now - step_start);
			step_start = now;
			is_first_step = false;
		}
	}
	return true;
}

} // namespace thicket
