// This file validates layers and contains the properties at the top and at the end of a layer's
// inspector.

#include "core/base/check.hpp"
#include "core/placement/instance_rows.hpp"
#include "core/state/instance_state.hpp"
#include "nodes/common/renames.hpp"
#include "nodes/layer/scatter_layer_properties.hpp"

#include <cmath>

using namespace godot;

namespace thicket {

namespace {

constexpr NumberProperty radius{"radius", &PointSet::radius, min_radius, max_radius, PROPERTY_HINT_RANGE,
		"0.05,50,0.001,or_less,or_greater,exp,suffix:m"};
constexpr NumberProperty density{"density", &Rules::density, 0.0, 1.0, PROPERTY_HINT_RANGE, "0,1,0.001"};
constexpr NumberProperty tile_size{"tile_size", &StreamLayer::tile_size, 0.1, 1e5, PROPERTY_HINT_RANGE,
		"8,512,0.1,or_less,or_greater,exp,suffix:m"};
constexpr NumberProperty progressive_levels{
		"progressive_levels", &PointSet::levels, 1, max_levels, PROPERTY_HINT_RANGE, "1,8,1"};
constexpr NumberProperty layer_id{
		"layer_id", &LayerIdentity::layer_id, -1, max_state_layer, PROPERTY_HINT_RANGE, "-1,32767,1"};

} // namespace

ScatterLayer::ScatterLayer() {
	settings_.set.radius = 2.0;
	links_.proximity_distance = 5.0;
}

Status ScatterLayer::check() {
	refresh();
	const LayerSettings full_settings = settings(0, 0);
	Status status = validate(full_settings);
	if (status.ok()) {
		status = tables_.image_status;
	}
	if (status.ok()) {
		status = validate(lod_);
	}
	if (!status.ok()) {
		return status;
	}
	static_assert(max_tile_points == 4e6, "the messages below contain this number");
	const double largest = std::sqrt(max_tile_points / point_density(full_settings.set));
	const Status size_status = rows_.is_valid()
			? check_range("tile_size", range_.tile_size, at_most(largest, "4 million points per tile in these rows"),
					  "Lower tile_size or raise ScatterRows.step")
			: check_range("tile_size", range_.tile_size, at_most(largest, "4 million points per tile at this radius"),
					  "Lower tile_size or raise radius");
	return first_failure(size_status, validate(range_));
}

/// Sets properties by the names that release 0.2 saved.
bool ScatterLayer::_set(const StringName &p_name, const Variant &p_value) {
	if (!former_lods_.set(p_name, p_value) && !former_visibility_.set(p_name, p_value) &&
			!set_former_value(p_name, p_value)) {
		return set_renamed(this, p_name, p_value);
	}
	convert_former_lods(false);
	mark_changed();
	return true;
}

void ScatterLayer::take_id(std::int64_t p_id) {
	identity_.layer_id = p_id;
	mark_changed();
}

bool ScatterLayer::affects_placement(const StringName &p_property) const {
	return layer_property_use(p_property) == PropertyUse::placement;
}

Dictionary ScatterLayer::get_row_columns() const {
	Dictionary result;
	for (const RowColumn &column : row_columns(settings_.instance_data)) {
		result[String(column.name)] = String(column.type);
	}
	return result;
}

double ScatterLayer::get_point_density() const { return point_density(point_set()); }

void ScatterLayer::bind_basics() {
	bind_meshes();
	bind_number<radius>();
	bind_number<density>();
}

void ScatterLayer::bind_advanced() {
	ADD_GROUP("Advanced", "");
	bind_integer<progressive_levels>();
	bind_number<tile_size>();
	bind_integer<layer_id>();
	bind_guarded<&ScatterLayer::affects_placement>(D_METHOD("affects_placement", "property"));
	bind_guarded<&ScatterLayer::get_point_density>(D_METHOD("get_point_density"));
	bind_guarded<&ScatterLayer::get_row_columns>(D_METHOD("get_row_columns"));
	bind_export();
}

void ScatterLayer::add_used(SceneUse::List &r_used) const {
	r_used.add(mask_);
	r_used.add(rows_);
	r_used.add(color_value_);
	r_used.add(variation_value_);
	r_used.add(scale_value_);
	for (std::size_t entry = 0; entry < meshes_.size(); ++entry) {
		if (const Ref<ScatterModel> model = meshes_.model(entry); model.is_valid()) {
			r_used.add(model);
			model->add_used(r_used);
		}
	}
}

// Binds all properties, in the order of the inspector.
void ScatterLayer::_bind_methods() {
	bind_basics();
	bind_placement();
	bind_rules();
	bind_neighbors();
	bind_drawing();
	bind_lod();
	bind_gameplay();
	bind_advanced();
	ADD_SIGNAL(MethodInfo("area_changed", PropertyInfo(Variant::RECT2, "rect")));
}

} // namespace thicket
