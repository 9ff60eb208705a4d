#include "nodes/sampler/script_progress.hpp"

#include "nodes/common/script_call.hpp"

#include <godot_cpp/core/error_macros.hpp>

#include <algorithm>
#include <string>

using namespace godot;

namespace thicket {

namespace {

constexpr std::chrono::milliseconds min_interval{15};

} // namespace

ScriptProgress::ScriptProgress(const char *p_owner, const Callable &p_callable) :
		owner_(p_owner), callable_(p_callable), is_enabled_(!p_callable.is_null()),
		next_report_(Clock::now() + min_interval) {}

Progress ScriptProgress::progress(const std::atomic<bool> *p_cancel) {
	return {p_cancel, [this](double fraction, std::uint64_t points) { update(fraction, points); }};
}

/// Calls the script if the next report is due.
void ScriptProgress::update(double p_fraction, std::uint64_t p_points) {
	if (is_enabled_ && p_fraction < 1.0 && Clock::now() >= next_report_) {
		fraction_ = std::max(fraction_, p_fraction);
		call(fraction_, p_points);
		next_report_ = Clock::now() + min_interval;
	}
}

void ScriptProgress::finish(std::uint64_t p_points) {
	if (is_enabled_) {
		call(1.0, p_points);
	}
}

void ScriptProgress::call(double p_fraction, std::uint64_t p_points) {
	const Variant fraction(p_fraction);
	const Variant points(static_cast<int64_t>(p_points));
	Variant result;
	if (call_script(callable_, "call", result, fraction, points) != GDEXTENSION_CALL_OK) {
		is_enabled_ = false;
		const std::string problem = std::string(owner_) +
				".progress cannot be called with (fraction: float, points: int), or cannot be called anymore";
		ERR_PRINT(String(problem.c_str()));
	}
}

} // namespace thicket
