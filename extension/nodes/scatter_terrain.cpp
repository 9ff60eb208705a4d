#include "nodes/scatter_terrain.hpp"

#include "nodes/property_check.hpp"

#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/core/class_db.hpp>

#include <glm/geometric.hpp>

#include <cmath>
#include <limits>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

constexpr const char *class_name = "ScatterTerrain";

/// Half the distance in metres over which a slope is measured where a script gives heights only.
constexpr double difference_step = 0.5;

/// A script that says that it may be called from worker threads.
class ScriptGround : public Terrain {
public:
	explicit ScriptGround(const Ref<ScatterTerrain> &p_script) : script_(p_script) {}

	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override {
		return script_->ask_script(positions, r_ground);
	}

private:
	Ref<ScatterTerrain> script_;
};

PackedVector2Array packed(std::span<const glm::dvec2> positions) {
	PackedVector2Array result;
	result.resize(static_cast<int64_t>(positions.size()));
	Vector2 *out = result.ptrw();
	for (const glm::dvec2 &position : positions) {
		*out++ = Vector2(static_cast<real_t>(position.x), static_cast<real_t>(position.y));
	}
	return result;
}

Status wrong_size(const char *property, int64_t size) {
	return {ErrorCode::wrong_size, property, static_cast<double>(size)};
}

/// Rise over run through three heights in a row, one-sided where a neighbour has no ground.
float rise(float before, float here, float after) {
	constexpr auto step = static_cast<float>(difference_step);
	if (std::isfinite(before) && std::isfinite(after)) {
		return (after - before) / (2.0F * step);
	}
	if (std::isfinite(after)) {
		return (after - here) / step;
	}
	return std::isfinite(before) ? (here - before) / step : 0.0F;
}

} // namespace

std::shared_ptr<const Terrain> ScatterTerrain::snapshot() {
	if (!GDVIRTUAL_IS_OVERRIDDEN(_get_heights) || main_thread_only()) {
		return nullptr;
	}
	return std::make_shared<ScriptGround>(Ref<ScatterTerrain>(this));
}

String ScatterTerrain::problem() {
	if (GDVIRTUAL_IS_OVERRIDDEN(_get_heights)) {
		return {};
	}
	return "ScatterTerrain gives no ground by itself: use ScatterTerrainFlat or ScatterTerrainHeightmap, or extend it "
		   "with a script (a @tool script to see it in the editor) that has _get_heights().";
}

bool ScatterTerrain::main_thread_only() const {
	bool thread_safe = false;
	GDVIRTUAL_CALL(_is_thread_safe, thread_safe);
	return !thread_safe && GDVIRTUAL_IS_OVERRIDDEN(_get_heights);
}

Status ScatterTerrain::ask_script(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const {
	const PackedVector2Array where = packed(positions);
	PackedFloat32Array heights;
	GDVIRTUAL_CALL(_get_heights, where, heights);
	if (heights.size() != where.size()) {
		return wrong_size("_get_heights() result", heights.size());
	}
	const float *height = heights.ptr();
	for (Ground &ground : r_ground) {
		ground.height = *height++;
		ground.normal = {0.0F, 1.0F, 0.0F};
	}
	return GDVIRTUAL_IS_OVERRIDDEN(_get_normals) ? ask_normals(where, r_ground)
												 : difference_normals(positions, r_ground);
}

Status ScatterTerrain::ask_normals(const PackedVector2Array &p_positions, std::span<Ground> r_ground) const {
	PackedVector3Array normals;
	GDVIRTUAL_CALL(_get_normals, p_positions, normals);
	if (normals.size() != p_positions.size()) {
		return wrong_size("_get_normals() result", normals.size());
	}
	const Vector3 *given = normals.ptr();
	for (Ground &ground : r_ground) {
		const glm::vec3 normal{given->x, given->y, given->z};
		++given;
		const float length = std::sqrt(glm::dot(normal, normal));
		if (std::isfinite(length) && length > 0.0F) {
			ground.normal = normal / length;
		} else {
			ground.height = std::numeric_limits<float>::quiet_NaN();
		}
	}
	return {};
}

Status ScatterTerrain::difference_normals(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const {
	std::vector<glm::dvec2> around;
	around.reserve(4 * positions.size());
	for (const glm::dvec2 &position : positions) {
		around.push_back(position - glm::dvec2{difference_step, 0.0});
		around.push_back(position + glm::dvec2{difference_step, 0.0});
		around.push_back(position - glm::dvec2{0.0, difference_step});
		around.push_back(position + glm::dvec2{0.0, difference_step});
	}
	PackedFloat32Array heights;
	GDVIRTUAL_CALL(_get_heights, packed(around), heights);
	if (heights.size() != static_cast<int64_t>(around.size())) {
		return wrong_size("_get_heights() result", heights.size());
	}
	const float *height = heights.ptr();
	for (Ground &ground : r_ground) {
		const float x = rise(height[0], ground.height, height[1]);
		const float z = rise(height[2], ground.height, height[3]);
		ground.normal = glm::normalize(glm::vec3{-x, 1.0F, -z});
		height += 4;
	}
	return {};
}

Ground ScatterTerrain::ground_at(const Vector3 &p_global_position) {
	const glm::dvec2 position{p_global_position.x, p_global_position.z};
	Ground ground{std::numeric_limits<float>::quiet_NaN(), glm::vec3{0.0F}};
	const std::shared_ptr<const Terrain> terrain = snapshot();
	if (terrain == nullptr && !main_thread_only()) {
		return ground;
	}
	const Status status =
			terrain ? terrain->sample({&position, 1}, {&ground, 1}) : ask_script({&position, 1}, {&ground, 1});
	report(class_name, status);
	if (!status.ok() || !std::isfinite(ground.height)) {
		return {std::numeric_limits<float>::quiet_NaN(), glm::vec3{0.0F}};
	}
	return ground;
}

double ScatterTerrain::get_height(const Vector3 &p_global_position) { return ground_at(p_global_position).height; }

Vector3 ScatterTerrain::get_normal(const Vector3 &p_global_position) {
	const glm::vec3 normal = ground_at(p_global_position).normal;
	return {normal.x, normal.y, normal.z};
}

void ScatterTerrain::_bind_methods() {
	ClassDB::bind_method(D_METHOD("get_height", "global_position"), &ScatterTerrain::get_height);
	ClassDB::bind_method(D_METHOD("get_normal", "global_position"), &ScatterTerrain::get_normal);
	GDVIRTUAL_BIND(_get_heights, "positions");
	GDVIRTUAL_BIND(_get_normals, "positions");
	GDVIRTUAL_BIND(_is_thread_safe);
}

} // namespace thicket
