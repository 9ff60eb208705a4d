#include "nodes/ground/ground_copy.hpp"

#include "nodes/ground/post_grid_area.hpp"
#include "nodes/ground/terrain_map.hpp"

#include <godot_cpp/classes/object.hpp>

using namespace godot;

namespace thicket {

namespace {

std::uint64_t id_of(const Variant &p_object) {
	const Object *object = p_object.get_validated_object();
	return object != nullptr ? object->get_instance_id() : 0;
}

Variant property_of(const Variant &p_object, const StringName &p_name) {
	const Object *object = p_object.get_validated_object();
	return object != nullptr ? object->get(p_name) : Variant();
}

} // namespace

const char *name_of(GroundPlugin plugin) {
	switch (plugin) {
		case GroundPlugin::terrain3d: return "Terrain3D";
		case GroundPlugin::hterrain: return "HTerrain";
		case GroundPlugin::terrabrush: return "TerraBrush";
		default: return "";
	}
}

void GroundChanges::add(const GroundChanges &other) {
	whole_ground = whole_ground || other.whole_ground;
	areas.insert(areas.end(), other.areas.begin(), other.areas.end());
}

CopyAttempt copy_ground(const Variant &p_node, const GroundCopy *before) {
	CopyAttempt attempt = copy_terrain3d(p_node, before);
	for (const auto &copy : {copy_hterrain, copy_terrabrush}) {
		attempt = attempt.plugin != GroundPlugin::none ? attempt : copy(p_node, before);
	}
	return attempt;
}

GroundFingerprint fingerprint_of(const Variant &p_node, bool deep) {
	GroundFingerprint fingerprint;
	fingerprint.node = id_of(p_node);
	fingerprint.extent = is_post_grid(p_node) ? PostGridArea::of(p_node).rect : Rect2();
	if (fingerprint.node == 0 || !deep) {
		return fingerprint;
	}
	if (has_method(p_node, "get_data") && has_method(p_node, "get_internal_transform")) {
		fingerprint.data = id_of(result_of(p_node, "get_data"));
		fingerprint.has_indexed_textures = uses_indexed_textures(p_node);
	} else if (has_method(p_node, "get_terrainZones")) {
		fingerprint.data = id_of(result_of(p_node, "get_terrainZones"));
	} else {
		fingerprint.data = id_of(property_of(p_node, "data"));
		const Variant spacing = property_of(p_node, "vertex_spacing");
		fingerprint.spacing = is_number(spacing) ? static_cast<double>(spacing) : 0.0;
	}
	return fingerprint;
}

} // namespace thicket
