// This file contains ScatterLayer.rows, the rows that contain a layer's instances.

#include "nodes/common/watch.hpp"
#include "nodes/layer/scatter_layer_properties.hpp"

using namespace godot;

namespace thicket {

void ScatterLayer::set_rows(const Ref<ScatterRows> &p_rows) {
	if (rows_ == p_rows) {
		return;
	}
	watch(rows_.ptr(), "changed", this, "_rows_changed", false);
	rows_ = p_rows;
	watch(rows_.ptr(), "changed", this, "_rows_changed", true);
	mark_changed();
}

/// Returns the layer's point set, without its seed and layer ID.
PointSet ScatterLayer::point_set() const {
	PointSet set = settings_.set;
	if (rows_.is_valid()) {
		set.in_rows = true;
		set.radius = equivalent_radius(rows_->rows());
		set.levels = 1;
	}
	return set;
}

void ScatterLayer::add_row_problems(PackedStringArray &r_problems) const {
	if (rows_.is_null()) {
		return;
	}
	if (String(rows_->get_path_group()).is_empty()) {
		r_problems.push_back(
				"Nothing is placed: ScatterRows.path_group is empty. Set it to a group with Path3D nodes.");
	}
	if (!rows_->is_filling_area() && rows_->rows().offsets.empty()) {
		r_problems.push_back("Nothing is placed: ScatterRows.offsets is empty. Add 0 for a row on the path itself.");
	}
	if (links_.spacing_fills) {
		r_problems.push_back("ScatterLayer.spacing_fills has no effect while rows is set: rows cannot fill gaps. "
							 "Disable it, or clear rows.");
	}
}

void ScatterLayer::bind_rows() {
	bind_guarded<&ScatterLayer::set_rows>(D_METHOD("set_rows", "rows"));
	bind_guarded<&ScatterLayer::get_rows>(D_METHOD("get_rows"));
	bind_guarded<&ScatterLayer::mark_changed>(ThreadUse::relayed, D_METHOD("_rows_changed"));
	add_layer_property(PropertyUse::placement,
			PropertyInfo(Variant::OBJECT, "rows", PROPERTY_HINT_RESOURCE_TYPE, ScatterRows::class_name), "set_rows",
			"get_rows");
}

} // namespace thicket
