#pragma once

#include "core/rows/row_set.hpp"
#include "nodes/common/guard.hpp"

#include <godot_cpp/classes/resource.hpp>
#include <godot_cpp/variant/packed_float32_array.hpp>
#include <godot_cpp/variant/string_name.hpp>

namespace thicket {

/// The yaw of instances relative to the direction of their row, in degrees.
struct RowYaw {
	double degrees = 0.0; ///< -180 to 180.
	double jitter = 0.0;  ///< Largest random deviation, 0 to 180.
};

/// The arrangement of a layer's instances in rows along the Path3D nodes of a group, or over the areas
/// that these enclose. Layers may share a resource. Emits `changed` when a property is set.
class ScatterRows : public godot::Resource, public ThreadGuarded {
	GDCLASS(ScatterRows, godot::Resource)
	THICKET_GUARDED_METHODS(owner)

public:
	/// Sets the name of the group that contains the paths. If it is empty, there are no rows.
	void set_path_group(const godot::StringName &p_group);
	godot::StringName get_path_group() const { return path_group_; }

	// These setters reject values that `validate` rejects for RowSettings, print an error, and keep the
	// last valid value.
	void set_step(double p_step);
	double get_step() const { return rows_.step; }
	void set_offsets(const godot::PackedFloat32Array &p_offsets);
	godot::PackedFloat32Array get_offsets() const;
	void set_jitter_along(double p_jitter);
	double get_jitter_along() const { return rows_.jitter_along; }
	void set_jitter_across(double p_jitter);
	double get_jitter_across() const { return rows_.jitter_across; }
	void set_crossing_gap(double p_gap);
	double get_crossing_gap() const { return rows_.crossing_gap; }
	void set_fill_area(bool p_fill);
	bool is_filling_area() const { return rows_.fills_areas; }
	void set_row_distance(double p_distance);
	double get_row_distance() const { return rows_.row_distance; }
	void set_row_angle_degrees(double p_degrees);
	double get_row_angle_degrees() const { return rows_.row_angle_degrees; }

	/// If true, the yaw of instances is relative to the direction of their row.
	void set_align_to_rows(bool p_align);
	bool is_aligning_to_rows() const { return rows_.turns_instances; }
	void set_yaw_degrees(double p_degrees);
	double get_yaw_degrees() const { return yaw_.degrees; }
	void set_yaw_jitter_degrees(double p_degrees);
	double get_yaw_jitter_degrees() const { return yaw_.jitter; }

	const RowSettings &rows() const { return rows_; }
	const RowYaw &yaw() const { return yaw_; }

	static constexpr const char *class_name = "ScatterRows";

protected:
	static void _bind_methods();
	void _validate_property(godot::PropertyInfo &p_property) const;

private:
	void set_number(const char *p_property, double p_value, double p_min, double p_max, double &r_value);
	void set_switch(bool p_value, bool &r_value);

	godot::StringName path_group_;
	RowSettings rows_;
	RowYaw yaw_;
};

} // namespace thicket
