// This file contains the methods of ScatterBiomeMap for planets.

#include "core/rules/planet_positions.hpp"
#include "core/rules/sphere_image.hpp"
#include "nodes/biome/scatter_biome_map.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/common/property_check.hpp"

#include <godot_cpp/core/class_db.hpp>

#include <cstdint>
#include <vector>

using namespace godot;

namespace thicket {

Ref<ScatterBiome> ScatterBiomeMap::get_biome_on_planet(double p_planet_radius, const Vector3 &p_from_center) {
	const glm::dvec3 from_center = to_core(p_from_center);
	const Status status = check_direction(p_planet_radius, from_center);
	report(class_name, status);
	if (!status.ok()) {
		return {};
	}
	const std::uint8_t index = map()->dominant_toward(p_planet_radius, from_center);
	return index < biome_count() ? Ref<ScatterBiome>(biomes_[index]) : Ref<ScatterBiome>();
}

PackedFloat32Array ScatterBiomeMap::get_weights_on_planet(double p_planet_radius, const Vector3 &p_from_center) {
	const glm::dvec3 from_center = to_core(p_from_center);
	const Status status = check_direction(p_planet_radius, from_center);
	report(class_name, status);
	if (!status.ok()) {
		return {};
	}
	BiomeTaps taps{};
	map()->taps_toward(p_planet_radius, from_center, taps);
	return weights_of(taps);
}

PackedInt32Array ScatterBiomeMap::planet_disc(
		double p_planet_radius, const Vector3 &p_from_center, double p_radius, const Vector2i &p_size) const {
	std::vector<PixelRect> rows;
	const glm::dvec3 from_center = to_core(p_from_center);
	const Status status = check_direction(p_planet_radius, from_center);
	report(class_name, status);
	if (!status.ok() || p_size.x < 1 || p_size.y < 1) {
		return {};
	}
	find_sphere_disc({p_size.x, p_size.y}, Planet::up(from_center), p_radius / p_planet_radius, rows);
	std::vector<std::int32_t> numbers;
	for (const PixelRect &row : rows) {
		numbers.insert(numbers.end(), {row.min.x, row.min.y, row.size().x});
	}
	return packed_integers(numbers);
}

void ScatterBiomeMap::bind_planets() {
	using Self = ScatterBiomeMap;
	bind_guarded<&Self::get_biome_on_planet>(D_METHOD("get_biome_on_planet", "planet_radius", "from_center"));
	bind_guarded<&Self::get_weights_on_planet>(D_METHOD("get_weights_on_planet", "planet_radius", "from_center"));
	bind_guarded<&Self::planet_disc>(D_METHOD("_planet_disc", "planet_radius", "from_center", "radius", "size"));
}

} // namespace thicket
