#include "nodes/ground/scatter_ground_flat.hpp"

#include "core/terrain/flat_terrain.hpp"
#include "nodes/common/property_check.hpp"

#include <godot_cpp/core/class_db.hpp>

using namespace godot;

namespace thicket {

std::shared_ptr<const Terrain> ScatterGroundFlat::make_snapshot(const GroundHost &) {
	return std::make_shared<FlatTerrain>(static_cast<float>(height_));
}

String ScatterGroundFlat::find_problem() { return {}; }

void ScatterGroundFlat::set_height(double p_height) {
	if (accept_number("ScatterGroundFlat", "height", p_height, -height_limit, height_limit)) {
		height_ = p_height;
		emit_changed();
	}
}

double ScatterGroundFlat::get_level() const { return height_; }

void ScatterGroundFlat::_bind_methods() {
	bind_guarded<&ScatterGroundFlat::set_height>(D_METHOD("set_height", "height"));
	bind_guarded<&ScatterGroundFlat::get_level>(D_METHOD("get_level"));
	ADD_PROPERTY(
			PropertyInfo(Variant::FLOAT, "height", PROPERTY_HINT_RANGE, "-1000,9000,0.01,or_less,or_greater,suffix:m"),
			"set_height", "get_level");
}

} // namespace thicket
