// This file contains the methods of ScatterState that deal with diffs from peers. They inspect,
// limit and merge diffs, and find missing ones.

#include "core/base/split_mix.hpp"
#include "core/state/diff_summary.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/gameplay/scatter_state.hpp"
#include "nodes/gameplay/state_refusal.hpp"

#include <godot_cpp/variant/rect2.hpp>

#include <atomic>
#include <cstdint>
#include <random>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// Returns a nonzero number that no other state has, in this or any other run. It is a hash of a
/// random number per run and a counter.
std::uint64_t new_origin() {
	static const std::uint64_t run_seed = [] {
		std::random_device device;
		const std::uint64_t high = device();
		return high << 32 | device();
	}();
	static std::atomic<std::uint64_t> count{0};
	const std::uint64_t origin =
			split_mix(run_seed + split_mix_gamma * (count.fetch_add(1, std::memory_order_relaxed) + 1));
	return origin != 0 ? origin : 1;
}

Variant to_variant(std::uint64_t value) { return static_cast<int64_t>(value); }

Dictionary dictionary_of(const DiffSummary::Layer &layer) {
	Dictionary result;
	result["removed"] = to_variant(layer.removed);
	result["restored"] = to_variant(layer.present);
	result["added"] = to_variant(layer.added);
	result["taken_away"] = to_variant(layer.removed_placed);
	result["with_data"] = to_variant(layer.with_data);
	result["data_bytes"] = to_variant(layer.data_bytes);
	if (layer.has_bounds) {
		const glm::dvec2 size = layer.bounds.size();
		result["bounds"] = Rect2(static_cast<real_t>(layer.bounds.min.x), static_cast<real_t>(layer.bounds.min.y),
				static_cast<real_t>(size.x), static_cast<real_t>(size.y));
	}
	result["bounds_are_complete"] = layer.has_all_bounds;
	return result;
}

} // namespace

ScatterState::ScatterState() { state_.set_origin(new_origin()); }

Error ScatterState::merge_diff(const PackedByteArray &p_diff) {
	wait_for_diffs();
	std::vector<InstanceChange> changes;
	const Error error = report_outcome("merge_diff", state_.merge_diff(span_of(p_diff), changes, limits()));
	notify(std::move(changes));
	return error;
}

void ScatterState::set_diff_limits(const Ref<ScatterDiffLimits> &p_limits) { diff_limits_ = p_limits; }

Dictionary ScatterState::inspect_diff(const PackedByteArray &p_diff) const {
	DiffSummary summary;
	const Status status = state_.inspect(span_of(p_diff), summary, limits());
	Array layers;
	for (const auto &[layer_id, content] : summary.layers) {
		Dictionary layer = dictionary_of(content);
		layer["layer"] = layer_with_id(layer_id);
		layer["layer_id"] = to_variant(layer_id);
		append(layers, layer);
	}
	Dictionary result;
	result["error"] = static_cast<int64_t>(error_of(status));
	result["message"] = status.ok() ? String() : String(describe(status).c_str());
	result["replaces_everything"] = summary.replaces_everything;
	result["origin"] = to_variant(summary.origin.name);
	result["base_revision"] = to_variant(summary.origin.base);
	result["revision"] = to_variant(summary.origin.end);
	result["time"] = summary.time;
	result["changes"] = to_variant(summary.changes);
	result["layers"] = layers;
	return result;
}

int64_t ScatterState::get_origin() const { return static_cast<int64_t>(state_.origin()); }

int64_t ScatterState::get_known_revision(int64_t p_origin) const {
	return static_cast<int64_t>(state_.known_revision(static_cast<std::uint64_t>(p_origin)));
}

int64_t ScatterState::get_missing_since(const PackedByteArray &p_diff) const {
	bool is_missing = false;
	std::uint64_t since = 0;
	const Error error = report_outcome("get_missing_since", state_.missing_before(span_of(p_diff), is_missing, since));
	return error == OK && is_missing ? static_cast<int64_t>(since) : -1;
}

} // namespace thicket
