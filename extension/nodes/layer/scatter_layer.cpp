// When a layer may be used, and the properties of its set and tiles.

#include "core/state/instance_state.hpp"
#include "nodes/layer/scatter_layer_properties.hpp"

using namespace godot;

namespace thicket {

namespace {

using Number = NumberProperty<LayerNumbers, double>;
using Integer = NumberProperty<LayerIntegers, int64_t>;

constexpr Number radius{"radius", &LayerNumbers::radius, min_radius, max_radius, PROPERTY_HINT_RANGE,
		"0.05,50,0.001,or_less,or_greater,suffix:m"};
constexpr Number tile_size{
		"tile_size", &LayerNumbers::tile_size, 0.1, 1e5, PROPERTY_HINT_RANGE, "8,512,0.1,or_less,or_greater,suffix:m"};
constexpr Number view_distance{"view_distance", &LayerNumbers::view_distance, 0.0, farthest_view, PROPERTY_HINT_RANGE,
		"0,4096,0.1,or_greater,suffix:m"};
constexpr Integer layer_id{
		"layer_id", &LayerIntegers::layer_id, -1, max_state_layer, PROPERTY_HINT_RANGE, "-1,32767,1"};
constexpr Integer levels{"levels", &LayerIntegers::levels, 1, max_levels, PROPERTY_HINT_RANGE, "1,8,1"};

} // namespace

Status ScatterLayer::check() const {
	const LayerSettings whole = settings(0, 0);
	Status status = validate(whole);
	if (status.ok()) {
		status = tables_.image_status;
	}
	if (status.ok()) {
		status = validate(lod());
	}
	if (!status.ok()) {
		return status;
	}
	if (point_density(whole.set) * numbers_.tile_size * numbers_.tile_size > max_tile_points) {
		return {ErrorCode::too_many_points, "tile_size", numbers_.tile_size};
	}
	if (numbers_.view_distance > max_view_tiles * numbers_.tile_size) {
		return {ErrorCode::out_of_range, "view_distance", numbers_.view_distance};
	}
	return {};
}

void ScatterLayer::take_id(std::int64_t p_id) {
	integers_.layer_id = p_id;
	emit_changed();
}

void ScatterLayer::bind_set() {
	bind_number<radius>();
	bind_integer<levels>();
	bind_integer<layer_id>();
	ADD_GROUP("Streaming", "");
	bind_number<tile_size>();
	bind_number<view_distance>();
}

void ScatterLayer::_bind_methods() {
	bind_set();
	bind_rules();
	bind_neighbors();
	bind_placement();
	bind_drawing();
	bind_lod();
	bind_gameplay();
	ADD_SIGNAL(MethodInfo("area_changed", PropertyInfo(Variant::RECT2, "rect")));
}

} // namespace thicket
