#include "nodes/layer/scatter_rows.hpp"

#include "nodes/common/engine_arrays.hpp"
#include "nodes/common/property_check.hpp"

#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/object.hpp>

#include <algorithm>
#include <utility>
#include <vector>

using namespace godot;

namespace thicket {

void ScatterRows::set_number(const char *p_property, double p_value, double p_min, double p_max, double &r_value) {
	if (accept_number(class_name, p_property, p_value, p_min, p_max) && r_value != p_value) {
		r_value = p_value;
		emit_changed();
	}
}

void ScatterRows::set_switch(bool p_value, bool &r_value) {
	if (std::exchange(r_value, p_value) != p_value) {
		notify_property_list_changed();
		emit_changed();
	}
}

void ScatterRows::set_path_group(const StringName &p_group) {
	if (!(path_group_ == p_group)) {
		path_group_ = p_group;
		emit_changed();
	}
}

void ScatterRows::set_step(double p_step) { set_number("step", p_step, min_row_step, max_row_step, rows_.step); }

void ScatterRows::set_offsets(const PackedFloat32Array &p_offsets) {
	RowSettings next = rows_;
	next.offsets.assign(p_offsets.ptr(), p_offsets.ptr() + p_offsets.size());
	const Status status = validate(next);
	report(class_name, status);
	if (status.ok() && next != rows_) {
		rows_ = std::move(next);
		emit_changed();
	}
}

PackedFloat32Array ScatterRows::get_offsets() const {
	PackedFloat32Array result;
	const auto offsets = resize(result, static_cast<std::int64_t>(rows_.offsets.size()));
	std::ranges::transform(rows_.offsets, offsets.begin(), [](double offset) { return static_cast<float>(offset); });
	return result;
}

void ScatterRows::set_jitter_along(double p_jitter) {
	set_number("jitter_along", p_jitter, 0.0, max_row_jitter, rows_.jitter_along);
}

void ScatterRows::set_jitter_across(double p_jitter) {
	set_number("jitter_across", p_jitter, 0.0, max_row_jitter, rows_.jitter_across);
}

void ScatterRows::set_crossing_gap(double p_gap) {
	set_number("crossing_gap", p_gap, 0.0, max_crossing_gap, rows_.crossing_gap);
}

void ScatterRows::set_fill_area(bool p_fill) { set_switch(p_fill, rows_.fills_areas); }

void ScatterRows::set_row_distance(double p_distance) {
	set_number("row_distance", p_distance, min_row_step, max_row_step, rows_.row_distance);
}

void ScatterRows::set_row_angle_degrees(double p_degrees) {
	set_number("row_angle_degrees", p_degrees, -360.0, 360.0, rows_.row_angle_degrees);
}

void ScatterRows::set_align_to_rows(bool p_align) { set_switch(p_align, rows_.turns_instances); }

void ScatterRows::set_yaw_degrees(double p_degrees) {
	set_number("yaw_degrees", p_degrees, -180.0, 180.0, yaw_.degrees);
}

void ScatterRows::set_yaw_jitter_degrees(double p_degrees) {
	set_number("yaw_jitter_degrees", p_degrees, 0.0, 180.0, yaw_.jitter);
}

/// Hides properties that do not apply.
void ScatterRows::_validate_property(PropertyInfo &p_property) const {
	const auto show = [&p_property](const char *p_name, bool p_shown) {
		if (!p_shown && p_property.name == StringName(p_name)) {
			p_property.usage &= ~static_cast<std::uint32_t>(PROPERTY_USAGE_EDITOR);
		}
	};
	show("offsets", !rows_.fills_areas);
	show("crossing_gap", !rows_.fills_areas);
	show("row_distance", rows_.fills_areas);
	show("row_angle_degrees", rows_.fills_areas);
	show("yaw_degrees", rows_.turns_instances);
	show("yaw_jitter_degrees", rows_.turns_instances);
}

void ScatterRows::_bind_methods() {
	using Self = ScatterRows;
	constexpr const char *lengths = "0.05,50,0.01,or_greater,exp,suffix:m";
	constexpr const char *jitters = "0,10,0.01,or_greater,suffix:m";
	bind_guarded<&Self::set_path_group>(D_METHOD("set_path_group", "group"));
	bind_guarded<&Self::get_path_group>(D_METHOD("get_path_group"));
	bind_guarded<&Self::set_step>(D_METHOD("set_step", "step"));
	bind_guarded<&Self::get_step>(D_METHOD("get_step"));
	bind_guarded<&Self::set_offsets>(D_METHOD("set_offsets", "offsets"));
	bind_guarded<&Self::get_offsets>(D_METHOD("get_offsets"));
	bind_guarded<&Self::set_jitter_along>(D_METHOD("set_jitter_along", "jitter"));
	bind_guarded<&Self::get_jitter_along>(D_METHOD("get_jitter_along"));
	bind_guarded<&Self::set_jitter_across>(D_METHOD("set_jitter_across", "jitter"));
	bind_guarded<&Self::get_jitter_across>(D_METHOD("get_jitter_across"));
	bind_guarded<&Self::set_crossing_gap>(D_METHOD("set_crossing_gap", "gap"));
	bind_guarded<&Self::get_crossing_gap>(D_METHOD("get_crossing_gap"));
	bind_guarded<&Self::set_fill_area>(D_METHOD("set_fill_area", "fill"));
	bind_guarded<&Self::is_filling_area>(D_METHOD("is_filling_area"));
	bind_guarded<&Self::set_row_distance>(D_METHOD("set_row_distance", "distance"));
	bind_guarded<&Self::get_row_distance>(D_METHOD("get_row_distance"));
	bind_guarded<&Self::set_row_angle_degrees>(D_METHOD("set_row_angle_degrees", "degrees"));
	bind_guarded<&Self::get_row_angle_degrees>(D_METHOD("get_row_angle_degrees"));
	bind_guarded<&Self::set_align_to_rows>(D_METHOD("set_align_to_rows", "align"));
	bind_guarded<&Self::is_aligning_to_rows>(D_METHOD("is_aligning_to_rows"));
	bind_guarded<&Self::set_yaw_degrees>(D_METHOD("set_yaw_degrees", "degrees"));
	bind_guarded<&Self::get_yaw_degrees>(D_METHOD("get_yaw_degrees"));
	bind_guarded<&Self::set_yaw_jitter_degrees>(D_METHOD("set_yaw_jitter_degrees", "degrees"));
	bind_guarded<&Self::get_yaw_jitter_degrees>(D_METHOD("get_yaw_jitter_degrees"));
	ADD_PROPERTY(PropertyInfo(Variant::STRING_NAME, "path_group"), "set_path_group", "get_path_group");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "step", PROPERTY_HINT_RANGE, lengths), "set_step", "get_step");
	ADD_PROPERTY(PropertyInfo(Variant::PACKED_FLOAT32_ARRAY, "offsets"), "set_offsets", "get_offsets");
	ADD_PROPERTY(PropertyInfo(Variant::BOOL, "fill_area"), "set_fill_area", "is_filling_area");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "row_distance", PROPERTY_HINT_RANGE, lengths), "set_row_distance",
			"get_row_distance");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "row_angle_degrees", PROPERTY_HINT_RANGE, "-180,180,0.1,degrees"),
			"set_row_angle_degrees", "get_row_angle_degrees");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "crossing_gap", PROPERTY_HINT_RANGE, "0,50,0.01,or_greater,suffix:m"),
			"set_crossing_gap", "get_crossing_gap");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "jitter_along", PROPERTY_HINT_RANGE, jitters), "set_jitter_along",
			"get_jitter_along");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "jitter_across", PROPERTY_HINT_RANGE, jitters), "set_jitter_across",
			"get_jitter_across");
	ADD_PROPERTY(PropertyInfo(Variant::BOOL, "align_to_rows"), "set_align_to_rows", "is_aligning_to_rows");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "yaw_degrees", PROPERTY_HINT_RANGE, "-180,180,0.1,degrees"),
			"set_yaw_degrees", "get_yaw_degrees");
	ADD_PROPERTY(PropertyInfo(Variant::FLOAT, "yaw_jitter_degrees", PROPERTY_HINT_RANGE, "0,180,0.1,degrees"),
			"set_yaw_jitter_degrees", "get_yaw_jitter_degrees");
}

} // namespace thicket
