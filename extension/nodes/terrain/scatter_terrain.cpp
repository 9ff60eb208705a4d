#include "nodes/terrain/scatter_terrain.hpp"

#include "core/terrain/slope_stencil.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/terrain/given_normal.hpp"

#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/error_macros.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

using namespace godot;

namespace thicket {

namespace {

constexpr const char *class_name = "ScatterTerrain";

/// Places that a script on the main thread is asked for at a time: some 0.1 ms of GDScript, neighbors for slopes
/// included.
constexpr std::size_t script_slice = 32;

/// A script that says that it may be called from worker threads.
class ScriptGround : public Terrain {
public:
	explicit ScriptGround(const Ref<ScatterTerrain> &p_script) : script_(p_script) {}

	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override {
		return script_->ask(positions, {}, r_ground);
	}

	Status weigh(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
			std::span<Ground> r_ground) const override {
		return script_->ask_weights(positions, textures, r_ground);
	}

private:
	Ref<ScatterTerrain> script_;
};

Status wrong_size(const char *property, int64_t size) {
	return {ErrorCode::wrong_size, property, static_cast<double>(size)};
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
	return "ScatterTerrain gives no ground by itself: use one of the classes that inherit from it, or extend it "
		   "with a script (a @tool script to see it in the editor) that has _get_heights().";
}

bool ScatterTerrain::has_textures() const {
	return GDVIRTUAL_IS_OVERRIDDEN(_get_heights) && GDVIRTUAL_IS_OVERRIDDEN(_get_weights);
}

bool ScatterTerrain::main_thread_only() const {
	bool thread_safe = false;
	GDVIRTUAL_CALL(_is_thread_safe, thread_safe);
	return !thread_safe && GDVIRTUAL_IS_OVERRIDDEN(_get_heights);
}

std::size_t ScatterTerrain::places_at_once() const { return script_slice; }

Status ScatterTerrain::ask(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
		std::span<Ground> r_ground) const {
	const PackedVector2Array where = packed_vectors(positions);
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
	const Status status = GDVIRTUAL_IS_OVERRIDDEN(_get_normals) ? ask_normals(where, r_ground)
																: difference_normals(positions, r_ground);
	return status.ok() && !textures.empty() ? ask_weights(positions, textures, r_ground) : status;
}

Status ScatterTerrain::ask_weights(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
		std::span<Ground> r_ground) const {
	if (!GDVIRTUAL_IS_OVERRIDDEN(_get_weights)) {
		return {};
	}
	PackedFloat32Array weights;
	GDVIRTUAL_CALL(_get_weights, packed_vectors(positions), packed_integers(textures), weights);
	if (weights.size() != static_cast<int64_t>(positions.size())) {
		return wrong_size("_get_weights() result", weights.size());
	}
	const float *weight = weights.ptr();
	for (Ground &ground : r_ground) {
		ground.weight = std::isfinite(*weight) ? std::clamp(*weight, 0.0F, 1.0F) : 0.0F;
		++weight;
	}
	return {};
}

Status ScatterTerrain::ask_normals(const PackedVector2Array &p_positions, std::span<Ground> r_ground) const {
	PackedVector3Array normals;
	GDVIRTUAL_CALL(_get_normals, p_positions, normals);
	if (normals.size() != p_positions.size()) {
		return wrong_size("_get_normals() result", normals.size());
	}
	const Vector3 *given = normals.ptr();
	for (Ground &ground : r_ground) {
		take_normal(*given++, ground);
	}
	return {};
}

Status ScatterTerrain::difference_normals(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const {
	std::vector<glm::dvec2> around;
	around.reserve(4 * positions.size());
	for (const glm::dvec2 &position : positions) {
		const SlopeStencil stencil(position);
		around.insert(around.end(), stencil.places().begin(), stencil.places().end());
	}
	PackedFloat32Array heights;
	GDVIRTUAL_CALL(_get_heights, packed_vectors(around), heights);
	if (heights.size() != static_cast<int64_t>(around.size())) {
		return wrong_size("_get_heights() result", heights.size());
	}
	const float *height = heights.ptr();
	for (std::size_t i = 0; i < positions.size(); ++i) {
		r_ground[i].normal =
				SlopeStencil(positions[i]).normal(r_ground[i].height, std::span<const float, 4>(height + 4 * i, 4));
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
			terrain ? terrain->sample({&position, 1}, {&ground, 1}) : ask({&position, 1}, {}, {&ground, 1});
	if (!status.ok()) {
		ERR_PRINT(String((std::string(class_name) + ": " + describe(status)).c_str()));
	}
	if (!status.ok() || !std::isfinite(ground.height)) {
		return {std::numeric_limits<float>::quiet_NaN(), glm::vec3{0.0F}};
	}
	return ground;
}

void ScatterTerrain::set_world_offset(glm::dvec3 offset) {
	if (world_offset_ != offset) {
		world_offset_ = offset;
		offset_changed();
	}
}

void ScatterTerrain::enter(Node3D *p_host) {
	hosts_.push_back(p_host);
	if (hosts_.size() == 1) {
		host_changed();
	}
}

void ScatterTerrain::leave(Node3D *p_host) {
	const Node3D *before = host();
	const auto found = std::find(hosts_.begin(), hosts_.end(), p_host);
	if (found != hosts_.end()) {
		hosts_.erase(found);
	}
	if (host() == before) {
		return;
	}
	host_changed();
	if (host() != nullptr) {
		emit_changed();
	}
}

void ScatterTerrain::emit_terrain_changed(const Rect2 &p_rect) { emit_signal("terrain_changed", p_rect); }

double ScatterTerrain::get_height(const Vector3 &p_global_position) { return ground_at(p_global_position).height; }

Vector3 ScatterTerrain::get_normal(const Vector3 &p_global_position) {
	return to_engine(ground_at(p_global_position).normal);
}

void ScatterTerrain::_bind_methods() {
	ClassDB::bind_method(D_METHOD("get_height", "global_position"), &ScatterTerrain::get_height);
	ClassDB::bind_method(D_METHOD("get_normal", "global_position"), &ScatterTerrain::get_normal);
	GDVIRTUAL_BIND(_get_heights, "positions");
	GDVIRTUAL_BIND(_get_normals, "positions");
	GDVIRTUAL_BIND(_get_weights, "positions", "textures");
	GDVIRTUAL_BIND(_is_thread_safe);
	ADD_SIGNAL(MethodInfo("terrain_changed", PropertyInfo(Variant::RECT2, "rect")));
}

} // namespace thicket
