// How instances stand on their points: the properties of the group Placement.

#include "nodes/layer/scatter_layer_properties.hpp"

using namespace godot;

namespace thicket {

namespace {

using Number = NumberProperty<LayerNumbers, double>;

constexpr Number min_yaw_degrees{
		"min_yaw_degrees", &LayerNumbers::min_yaw_degrees, -360.0, 360.0, PROPERTY_HINT_RANGE, "-360,360,0.1,degrees"};
constexpr Number max_yaw_degrees{
		"max_yaw_degrees", &LayerNumbers::max_yaw_degrees, -360.0, 360.0, PROPERTY_HINT_RANGE, "-360,360,0.1,degrees"};
constexpr Number min_tilt_degrees{
		"min_tilt_degrees", &LayerNumbers::min_tilt_degrees, 0.0, 90.0, PROPERTY_HINT_RANGE, "0,90,0.1,degrees"};
constexpr Number max_tilt_degrees{
		"max_tilt_degrees", &LayerNumbers::max_tilt_degrees, 0.0, 90.0, PROPERTY_HINT_RANGE, "0,90,0.1,degrees"};
constexpr Number min_scale{
		"min_scale", &LayerNumbers::min_scale, 1e-4, 1e4, PROPERTY_HINT_RANGE, "0.01,10,0.001,or_less,or_greater,exp"};
constexpr Number max_scale{
		"max_scale", &LayerNumbers::max_scale, 1e-4, 1e4, PROPERTY_HINT_RANGE, "0.01,10,0.001,or_less,or_greater,exp"};
constexpr Number align_to_normal{
		"align_to_normal", &LayerNumbers::align_to_normal, 0.0, 1.0, PROPERTY_HINT_RANGE, "0,1,0.01"};
constexpr Number height_offset{"height_offset", &LayerNumbers::height_offset, -1e4, 1e4, PROPERTY_HINT_RANGE,
		"-10,10,0.001,or_less,or_greater,suffix:m"};
constexpr Number offset_along_normal{"offset_along_normal", &LayerNumbers::offset_along_normal, -max_height_offset,
		max_height_offset, PROPERTY_HINT_RANGE, "-10,10,0.001,or_less,or_greater,suffix:m"};

constexpr ResourceProperty<Curve> scale_curve{
		"scale_curve", "Curve", &LayerResources::scale_curve, LayerSource::scale_curve};

} // namespace

void ScatterLayer::bind_placement() {
	ADD_GROUP("Placement", "");
	bind_number<min_scale>();
	bind_number<max_scale>();
	bind_resource<Curve, scale_curve>();
	bind_number<min_yaw_degrees>();
	bind_number<max_yaw_degrees>();
	bind_number<min_tilt_degrees>();
	bind_number<max_tilt_degrees>();
	bind_number<align_to_normal>();
	bind_number<height_offset>();
	bind_number<offset_along_normal>();
}

} // namespace thicket
