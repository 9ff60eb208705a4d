// This file contains the properties of ScatterLayer in the group Placement, which determine the
// transforms of instances.

#include "nodes/layer/scatter_layer_properties.hpp"

using namespace godot;

namespace thicket {

namespace {

constexpr NumberProperty min_yaw_degrees{
		"min_yaw_degrees", &Placement::min_yaw_degrees, -360.0, 360.0, PROPERTY_HINT_RANGE, "-360,360,0.1,degrees"};
constexpr NumberProperty max_yaw_degrees{
		"max_yaw_degrees", &Placement::max_yaw_degrees, -360.0, 360.0, PROPERTY_HINT_RANGE, "-360,360,0.1,degrees"};
constexpr NumberProperty min_tilt_degrees{
		"min_tilt_degrees", &Placement::min_tilt_degrees, 0.0, 90.0, PROPERTY_HINT_RANGE, "0,90,0.1,degrees"};
constexpr NumberProperty max_tilt_degrees{
		"max_tilt_degrees", &Placement::max_tilt_degrees, 0.0, 90.0, PROPERTY_HINT_RANGE, "0,90,0.1,degrees"};
constexpr NumberProperty min_scale{
		"min_scale", &Placement::min_scale, 1e-4, 1e4, PROPERTY_HINT_RANGE, "0.01,10,0.001,or_less,or_greater,exp"};
constexpr NumberProperty max_scale{
		"max_scale", &Placement::max_scale, 1e-4, 1e4, PROPERTY_HINT_RANGE, "0.01,10,0.001,or_less,or_greater,exp"};
constexpr NumberProperty align_to_normal{
		"align_to_normal", &Placement::align_to_normal, 0.0, 1.0, PROPERTY_HINT_RANGE, "0,1,0.01"};
constexpr NumberProperty height_offset{"height_offset", &Placement::height_offset, -1e4, 1e4, PROPERTY_HINT_RANGE,
		"-10,10,0.001,or_less,or_greater,suffix:m"};
constexpr NumberProperty offset_along_normal{"offset_along_normal", &Placement::offset_along_normal, -max_height_offset,
		max_height_offset, PROPERTY_HINT_RANGE, "-10,10,0.001,or_less,or_greater,suffix:m"};

constexpr ResourceProperty scale_curve{"scale_curve", &Placement::scale_curve, curve_table};

} // namespace

void ScatterLayer::bind_placement() {
	ADD_GROUP("Placement", "");
	bind_number<min_scale>();
	bind_number<max_scale>();
	bind_resource<scale_curve>();
	bind_scale_value();
	bind_number<min_yaw_degrees>();
	bind_number<max_yaw_degrees>();
	bind_number<min_tilt_degrees>();
	bind_number<max_tilt_degrees>();
	bind_number<align_to_normal>();
	bind_number<height_offset>();
	bind_number<offset_along_normal>();
	bind_rows();
}

} // namespace thicket
