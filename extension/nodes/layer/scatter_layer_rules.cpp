// What of its set a layer lets stand: the properties of the groups Rules and Other Layers.

#include "nodes/layer/scatter_layer_properties.hpp"

#include <string>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

using Number = NumberProperty<LayerNumbers, double>;

constexpr double min_distance = 1e-3; ///< Meters, between layers.

constexpr Number density{"density", &LayerNumbers::density, 0.0, 1.0, PROPERTY_HINT_RANGE, "0,1,0.001"};
constexpr Number min_slope_degrees{
		"min_slope_degrees", &LayerNumbers::min_slope_degrees, 0.0, 90.0, PROPERTY_HINT_RANGE, "0,90,0.1,degrees"};
constexpr Number max_slope_degrees{
		"max_slope_degrees", &LayerNumbers::max_slope_degrees, 0.0, 90.0, PROPERTY_HINT_RANGE, "0,90,0.1,degrees"};
constexpr Number slope_falloff{
		"slope_falloff", &LayerNumbers::slope_falloff, 0.0, 90.0, PROPERTY_HINT_RANGE, "0,90,0.1,degrees"};
constexpr Number min_height{"min_height", &LayerNumbers::min_height, -unlimited_height, unlimited_height,
		PROPERTY_HINT_RANGE, "-1000,9000,0.1,or_less,or_greater,suffix:m"};
constexpr Number max_height{"max_height", &LayerNumbers::max_height, -unlimited_height, unlimited_height,
		PROPERTY_HINT_RANGE, "-1000,9000,0.1,or_less,or_greater,suffix:m"};
constexpr Number height_falloff{"height_falloff", &LayerNumbers::height_falloff, 0.0, unlimited_height,
		PROPERTY_HINT_RANGE, "0,1000,0.1,or_greater,suffix:m"};
constexpr Number clump_size{"clump_size", &LayerNumbers::clump_size, 0.0, max_clump_size, PROPERTY_HINT_RANGE,
		"0,200,0.1,or_greater,suffix:m", min_clump_size};
constexpr Number clump_coverage{
		"clump_coverage", &LayerNumbers::clump_coverage, 0.0, 1.0, PROPERTY_HINT_RANGE, "0,1,0.001"};
constexpr Number clump_softness{
		"clump_softness", &LayerNumbers::clump_softness, 0.0, 1.0, PROPERTY_HINT_RANGE, "0,1,0.001"};
constexpr Number edge_feather{"edge_feather", &LayerNumbers::edge_feather, 0.0, max_edge_feather, PROPERTY_HINT_RANGE,
		"0,50,0.1,or_greater,suffix:m"};
constexpr Number distance_counted{"proximity_distance", &LayerNumbers::proximity_distance, min_distance,
		max_neighbor_distance, PROPERTY_HINT_RANGE, "0.1,100,0.1,or_less,or_greater,suffix:m"};

constexpr ResourceProperty<Curve> density_over_height{
		"density_over_height", "Curve", &LayerResources::density_over_height, LayerSource::density_over_height};
constexpr ResourceProperty<Curve> density_over_slope{
		"density_over_slope", "Curve", &LayerResources::density_over_slope, LayerSource::density_over_slope};
constexpr ResourceProperty<Noise> noise{"noise", "Noise", &LayerResources::noise, LayerSource::noise};
constexpr ResourceProperty<Curve> noise_curve{
		"noise_curve", "Curve", &LayerResources::noise_curve, LayerSource::noise_curve};
constexpr ResourceProperty<Curve> proximity_curve{
		"proximity_curve", "Curve", &LayerResources::proximity_curve, LayerSource::proximity_curve};

} // namespace

void ScatterLayer::set_ground_textures(const PackedInt32Array &p_textures) {
	if (p_textures.size() > max_texture + 1) {
		report(layer_class_name, {ErrorCode::wrong_size, "ground_textures", static_cast<double>(p_textures.size())});
		return;
	}
	for (const int32_t texture : p_textures) {
		if (!accept_number(layer_class_name, "ground_textures", texture, 0.0, max_texture)) {
			return;
		}
	}
	ground_textures_ = p_textures;
	emit_changed();
}

PackedInt32Array ScatterLayer::get_ground_textures() const { return ground_textures_; }

bool ScatterLayer::accept_spacing(const TypedDictionary<String, double> &p_spacing) const {
	if (p_spacing.size() > static_cast<int64_t>(max_neighbors)) {
		report(layer_class_name, {ErrorCode::wrong_size, "spacing", static_cast<double>(p_spacing.size())});
		return false;
	}
	const Array names = p_spacing.keys();
	for (int64_t i = 0; i < names.size(); ++i) {
		if (!accept_number(layer_class_name, "spacing", p_spacing[names[i]], min_distance, max_neighbor_distance)) {
			return false;
		}
	}
	return true;
}

void ScatterLayer::set_spacing(const TypedDictionary<String, double> &p_spacing) {
	if (!accept_spacing(p_spacing)) {
		return;
	}
	// Nobody may change it behind the checks: scripts share dictionaries.
	spacing_property_ = p_spacing.duplicate();
	spacing_property_.make_read_only();
	spacing_.clear();
	const Array names = spacing_property_.keys();
	for (int64_t i = 0; i < names.size(); ++i) {
		const String name = names[i];
		spacing_[name.utf8().get_data()] = std::as_const(spacing_property_)[names[i]];
	}
	emit_changed();
}

TypedDictionary<String, double> ScatterLayer::get_spacing() const { return spacing_property_; }

void ScatterLayer::set_proximity_layer(const String &p_name) {
	if (proximity_layer_ != p_name) {
		proximity_layer_ = p_name;
		emit_changed();
	}
}

String ScatterLayer::get_proximity_layer() const { return proximity_layer_; }

void ScatterLayer::rename_references(const String &p_from, const String &p_to) {
	if (proximity_layer_ == p_from) {
		set_proximity_layer(p_to);
	}
	if (spacing_.count(p_from.utf8().get_data()) == 0) {
		return;
	}
	// Anew, so that the order in the inspector stays.
	TypedDictionary<String, double> renamed;
	const Array names = spacing_property_.keys();
	for (int64_t i = 0; i < names.size(); ++i) {
		const String name = names[i];
		renamed[name == p_from ? p_to : name] = std::as_const(spacing_property_)[names[i]];
	}
	set_spacing(renamed);
}

void ScatterLayer::bind_rules() {
	ADD_GROUP("Rules", "");
	bind_number<density>();
	ADD_SUBGROUP("Height", "");
	bind_number<min_height>();
	bind_number<max_height>();
	bind_number<height_falloff>();
	bind_resource<Curve, density_over_height>();
	ADD_SUBGROUP("Slope", "");
	bind_number<min_slope_degrees>();
	bind_number<max_slope_degrees>();
	bind_number<slope_falloff>();
	bind_resource<Curve, density_over_slope>();
	ADD_SUBGROUP("Ground", "");
	ClassDB::bind_method(D_METHOD("set_ground_textures", "textures"), &ScatterLayer::set_ground_textures);
	ClassDB::bind_method(D_METHOD("get_ground_textures"), &ScatterLayer::get_ground_textures);
	ADD_PROPERTY(
			PropertyInfo(Variant::PACKED_INT32_ARRAY, "ground_textures"), "set_ground_textures", "get_ground_textures");
	ADD_SUBGROUP("Noise", "");
	bind_resource<Noise, noise>();
	bind_resource<Curve, noise_curve>();
	bind_masks();
	ADD_SUBGROUP("Clumping", "clump_");
	bind_number<clump_size>();
	bind_number<clump_coverage>();
	bind_number<clump_softness>();
	ADD_SUBGROUP("Edge", "edge_");
	bind_number<edge_feather>();
}

void ScatterLayer::bind_neighbors() {
	ADD_GROUP("Other Layers", "");
	ClassDB::bind_method(D_METHOD("set_spacing", "spacing"), &ScatterLayer::set_spacing);
	ClassDB::bind_method(D_METHOD("get_spacing"), &ScatterLayer::get_spacing);
	ADD_PROPERTY(PropertyInfo(Variant::DICTIONARY, "spacing", PROPERTY_HINT_DICTIONARY_TYPE,
						 vformat("%d/%d:;%d/%d:0.1,100,0.1,or_less,or_greater,suffix:m", Variant::STRING,
								 PROPERTY_HINT_NONE, Variant::FLOAT, PROPERTY_HINT_RANGE)),
			"set_spacing", "get_spacing");
	ADD_SUBGROUP("Proximity", "proximity_");
	ClassDB::bind_method(D_METHOD("set_proximity_layer", "name"), &ScatterLayer::set_proximity_layer);
	ClassDB::bind_method(D_METHOD("get_proximity_layer"), &ScatterLayer::get_proximity_layer);
	ADD_PROPERTY(PropertyInfo(Variant::STRING, "proximity_layer"), "set_proximity_layer", "get_proximity_layer");
	bind_number<distance_counted>();
	bind_resource<Curve, proximity_curve>();
}

} // namespace thicket
