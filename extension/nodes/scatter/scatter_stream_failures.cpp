// This file handles errors that keep tiles from being generated. Each error is printed once per
// layer and kept for the node's configuration warnings.

#include "nodes/layer/scatter_rule.hpp"
#include "nodes/scatter/scatter_stream.hpp"

#include <godot_cpp/core/error_macros.hpp>

#include <algorithm>
#include <string>

using namespace godot;

namespace thicket {

/// Prints the error of a tile unless its layer or ground is outdated or the layer already has an
/// error.
void ScatterStream::report_once(const TileJob &job) {
	const std::uint32_t index = job.request.key.layer;
	const bool is_current = index < layers_.size() && layers_[index] != nullptr &&
			layers_[index]->settings == job.layer->settings && ground_.terrain == job.terrain;
	if (is_current && !job.is_stale && ground_.source.is_available() && failures_[index].message.is_empty()) {
		const glm::ivec2 tile = job.request.key.tile;
		failures_[index] = print_failure("layer " + std::to_string(index) + ", tile (" + std::to_string(tile.x) + ", " +
						std::to_string(tile.y) + ")",
				job.status, density_rule_problem(*job.layer->settings, job.status));
	}
}

/// Requests all tiles in progress again and regenerates the visible ones. Call it after a frame
/// that ran out of memory, which may have lost any tile in progress.
void ScatterStream::start_over() {
	const auto is_for_display = [](const std::shared_ptr<TileJob> &job) {
		return !job->for_query;
	};
	for (const std::shared_ptr<TileJob> &job : jobs_) {
		job->cancelled = job->cancelled || is_for_display(job);
	}
	std::erase_if(jobs_, is_for_display);
	std::erase_if(ground_jobs_, is_for_display);
	uploads_.clear();
	for (std::uint32_t layer = 0; layer < layers_.size(); ++layer) {
		streamer_.cancel(layer);
		streamer_.invalidate(layer);
	}
}

/// Records an error from a re-check of the ground. Prints it only if no layer has already reported
/// an error.
void ScatterStream::report_recheck(const Status &status) {
	const auto has_failed = [](const LayerFailure &failure) {
		return !failure.message.is_empty();
	};
	const auto first = std::ranges::find_if(failures_, has_failed);
	recheck_failure_ = first != failures_.end() ? *first : print_failure("re-check of the ground", status);
}

/// Prints an error. `rule_problem` is the message of the density rule that caused it, or empty.
LayerFailure ScatterStream::print_failure(
		const std::string &location, const Status &status, const std::string &rule_problem) {
	failures_changed_ = true;
	const String text = String::utf8((location + ": " + describe(status) + ".").c_str());
	if (!rule_problem.empty()) {
		const String message = String::utf8(rule_problem.c_str());
		ERR_PRINT(String("TerrainScatter3D, ") + text + String(" ") + message);
		return {message, false};
	}
	const Ref<ScatterGround> &ground = ground_.source.ground;
	const String script_problem = ground.is_valid() ? ground->script_problem(status) : String();
	ERR_PRINT(String("TerrainScatter3D, ") + text +
			(script_problem.is_empty() ? script_problem : String(" ") + script_problem));
	return {script_problem.is_empty() ? String("Not all tiles could be generated: ") + text : script_problem,
			!script_problem.is_empty()};
}

void ScatterStream::forget_failure(LayerFailure &r_failure) {
	failures_changed_ = failures_changed_ || !r_failure.message.is_empty();
	r_failure = {};
}

PackedStringArray ScatterStream::failures() const {
	PackedStringArray result;
	bool has_script_failure = false; // A failing script affects all layers, so report it once.
	const auto add = [&](const LayerFailure &failure) {
		if (!failure.message.is_empty() && !(failure.by_script && has_script_failure)) {
			has_script_failure = has_script_failure || failure.by_script;
			result.push_back(failure.message);
		}
	};
	std::ranges::for_each(failures_, add);
	if (result.size() == 0) {
		add(recheck_failure_);
	}
	return result;
}

} // namespace thicket
