#include "nodes/gameplay/scatter_diff_limits.hpp"

#include "core/base/check.hpp"
#include "core/state/instance_state.hpp"
#include "nodes/common/property_check.hpp"

#include <godot_cpp/core/class_db.hpp>

using namespace godot;

namespace thicket {

void ScatterDiffLimits::set_count(const char *p_property, int64_t p_count, int64_t p_max, std::uint64_t &r_limit) {
	const auto count = static_cast<std::uint64_t>(p_count);
	if (accept_number(class_name, p_property, static_cast<double>(p_count), 0.0, static_cast<double>(p_max)) &&
			r_limit != count) {
		r_limit = count;
		emit_changed();
	}
}

void ScatterDiffLimits::set_max_changes(int64_t p_count) {
	set_count("max_changes", p_count, max_count, limits_.max_changes);
}

void ScatterDiffLimits::set_max_total_changes(int64_t p_count) {
	set_count("max_total_changes", p_count, max_count, limits_.max_total_changes);
}

void ScatterDiffLimits::set_max_added(int64_t p_count) {
	set_count("max_added", p_count, max_count, limits_.max_added);
}

void ScatterDiffLimits::set_max_data_size(int64_t p_bytes) {
	set_count("max_data_size", p_bytes, static_cast<int64_t>(max_instance_data), limits_.max_data_size);
}

void ScatterDiffLimits::set_area(const Rect2 &p_area) {
	const glm::dvec2 corner(p_area.position.x, p_area.position.y);
	const Rect area{corner, corner + glm::dvec2(p_area.size.x, p_area.size.y)};
	Status status;
	for (const double coordinate : {area.min.x, area.min.y, area.max.x, area.max.y}) {
		status = first_failure(status, check_range("area", coordinate, -max_added_coordinate, max_added_coordinate));
	}
	for (const double side : {area.size().x, area.size().y}) {
		status = first_failure(status, check_range("area.size", side, at_least(0), negative_size));
	}
	if (!status.ok()) {
		report(class_name, status);
	} else if (!(area_ == p_area)) {
		area_ = p_area;
		limits_.area = area;
		emit_changed();
	}
}

void ScatterDiffLimits::set_allow_replacement(bool p_allow) {
	if (limits_.allow_replacement != p_allow) {
		limits_.allow_replacement = p_allow;
		emit_changed();
	}
}

void ScatterDiffLimits::set_max_clock_advance(double p_seconds) {
	if (accept_number(class_name, "max_clock_advance", p_seconds, 0.0, max_state_time) &&
			limits_.max_clock_advance != p_seconds) {
		limits_.max_clock_advance = p_seconds;
		emit_changed();
	}
}

void ScatterDiffLimits::_bind_methods() {
	using Self = ScatterDiffLimits;
	bind_guarded<&Self::set_max_changes>(D_METHOD("set_max_changes", "count"));
	bind_guarded<&Self::get_max_changes>(D_METHOD("get_max_changes"));
	bind_guarded<&Self::set_max_total_changes>(D_METHOD("set_max_total_changes", "count"));
	bind_guarded<&Self::get_max_total_changes>(D_METHOD("get_max_total_changes"));
	bind_guarded<&Self::set_max_added>(D_METHOD("set_max_added", "count"));
	bind_guarded<&Self::get_max_added>(D_METHOD("get_max_added"));
	bind_guarded<&Self::set_max_data_size>(D_METHOD("set_max_data_size", "bytes"));
	bind_guarded<&Self::get_max_data_size>(D_METHOD("get_max_data_size"));
	bind_guarded<&Self::set_area>(D_METHOD("set_area", "area"));
	bind_guarded<&Self::get_area>(D_METHOD("get_area"));
	bind_guarded<&Self::set_allow_replacement>(D_METHOD("set_allow_replacement", "allow"));
	bind_guarded<&Self::is_replacement_allowed>(D_METHOD("is_replacement_allowed"));
	bind_guarded<&Self::set_max_clock_advance>(D_METHOD("set_max_clock_advance", "seconds"));
	bind_guarded<&Self::get_max_clock_advance>(D_METHOD("get_max_clock_advance"));
	constexpr const char *counts = "0,1000000,1,or_greater";
	ADD_PROPERTY(PropertyInfo(Variant::INT, "max_changes", PROPERTY_HINT_RANGE, counts), "set_max_changes",
			"get_max_changes");
	ADD_PROPERTY(PropertyInfo(Variant::INT, "max_total_changes", PROPERTY_HINT_RANGE, counts), "set_max_total_changes",
			"get_max_total_changes");
	ADD_PROPERTY(
			PropertyInfo(Variant::INT, "max_added", PROPERTY_HINT_RANGE, counts), "set_max_added", "get_max_added");
	ADD_PROPERTY(PropertyInfo(Variant::INT, "max_data_size", PROPERTY_HINT_RANGE, "0,65536,1,suffix:B"),
			"set_max_data_size", "get_max_data_size");
	ADD_PROPERTY(PropertyInfo(Variant::RECT2, "area", PROPERTY_HINT_NONE, "suffix:m"), "set_area", "get_area");
	ADD_PROPERTY(PropertyInfo(Variant::BOOL, "allow_replacement"), "set_allow_replacement", "is_replacement_allowed");
	ADD_PROPERTY(
			PropertyInfo(Variant::FLOAT, "max_clock_advance", PROPERTY_HINT_RANGE, "0,3600,0.1,or_greater,suffix:s"),
			"set_max_clock_advance", "get_max_clock_advance");
}

} // namespace thicket
