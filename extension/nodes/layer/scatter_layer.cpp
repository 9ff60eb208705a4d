// What a layer is made of, as the core takes it, and the properties of its set and tiles.

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

LayerSettings ScatterLayer::settings(std::uint64_t seed, std::size_t place) const {
	LayerSettings result;
	const bool own_id = integers_.layer_id >= 0;
	result.set.seed = seed;
	result.set.radius = numbers_.radius;
	result.set.levels = static_cast<std::uint32_t>(integers_.levels);
	result.set.layer = static_cast<std::uint16_t>(own_id ? static_cast<std::size_t>(integers_.layer_id) : place);
	result.rules = core_rules();
	result.placement = core_placement();
	result.instance_data = instance_data();
	for (int64_t mesh = 0; mesh < meshes_.size(); ++mesh) {
		result.mesh_weights.push_back(mesh < mesh_weights_.size() ? mesh_weights_[mesh] : 1.0F);
	}
	return result;
}

StreamLayer ScatterLayer::streaming() const { return {numbers_.tile_size, numbers_.view_distance}; }

const LayerSnapshots &ScatterLayer::snapshots() const {
	MaskFrame frame;
	frame.area.min = {mask_texture_rect_.position.x, mask_texture_rect_.position.y};
	frame.area.max = frame.area.min + glm::dvec2{mask_texture_rect_.size.x, mask_texture_rect_.size.y};
	frame.channel = static_cast<ImageChannel>(integers_.mask_texture_channel);
	frame.edge = static_cast<MaskEdge>(integers_.mask_texture_edge);
	snapshots_.refresh(resources_, frame, numbers_.proximity_distance);
	return snapshots_;
}

std::shared_ptr<const CurveTable> ScatterLayer::proximity_table() const { return snapshots().proximity_curve; }

Status ScatterLayer::check() const {
	const LayerSettings whole = settings(0, 0);
	Status status = validate(whole);
	if (status.ok()) {
		status = snapshots_.image_status;
	}
	if (status.ok()) {
		status = validate(detail());
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
