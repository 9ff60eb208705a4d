#include "nodes/terrain/scatter_terrain_flat.hpp"

#include "core/terrain/flat_terrain.hpp"
#include "nodes/common/property_check.hpp"

#include <godot_cpp/core/class_db.hpp>

using namespace godot;

namespace thicket {

std::shared_ptr<const Terrain> ScatterTerrainFlat::make_snapshot(const GroundHost &) {
	return std::make_shared<FlatTerrain>(static_cast<float>(height_));
}

String ScatterTerrainFlat::find_problem() { return {}; }

void ScatterTerrainFlat::set_height(double p_height) {
	if (accept_number("ScatterTerrainFlat", "height", p_height, -height_limit, height_limit)) {
		height_ = p_height;
		emit_changed();
	}
}

double ScatterTerrainFlat::get_level() const { return height_; }

void ScatterTerrainFlat::_bind_methods() {
	bind_guarded<&ScatterTerrainFlat::set_height>(D_METHOD("set_height", "height"));
	bind_guarded<&ScatterTerrainFlat::get_level>(D_METHOD("get_level"));
	ADD_PROPERTY(
			PropertyInfo(Variant::FLOAT, "height", PROPERTY_HINT_RANGE, "-1000,9000,0.01,or_less,or_greater,suffix:m"),
			"set_height", "get_level");
}

} // namespace thicket
