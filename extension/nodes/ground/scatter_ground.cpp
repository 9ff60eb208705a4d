#include "nodes/ground/scatter_ground.hpp"

#include "core/terrain/slope_stencil.hpp"
#include "nodes/common/convert.hpp"
#include "nodes/ground/given_normal.hpp"

#include <godot_cpp/classes/engine.hpp>
#include <godot_cpp/classes/ref.hpp>
#include <godot_cpp/core/class_db.hpp>
#include <godot_cpp/core/error_macros.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

/// The number of positions per script call on the main thread. GDScript needs about 0.1 ms for such
/// a call, including the neighbors for slopes.
constexpr std::size_t script_slice = 32;

constexpr ScriptMethod heights_method{"_get_heights", "_get_heights() result", "array of numbers from _get_heights()",
		"a PackedFloat32Array with a height in meters for each position, NAN for no ground", Variant::FLOAT};
constexpr ScriptMethod normals_method{"_get_normals", "_get_normals() result", "array of Vector3 from _get_normals()",
		"a PackedVector3Array with a normal for each position", Variant::VECTOR3};
constexpr ScriptMethod weights_method{"_get_weights", "_get_weights() result", "array of numbers from _get_weights()",
		"a PackedFloat32Array with a weight from 0 to 1 for each position", Variant::FLOAT};

std::int64_t count_of(std::span<const glm::dvec2> positions) { return static_cast<std::int64_t>(positions.size()); }

/// Returns the indices of the positions that have ground.
std::vector<std::size_t> indices_with_ground(std::span<const Ground> ground) {
	std::vector<std::size_t> indices;
	for (std::size_t i = 0; i < ground.size(); ++i) {
		if (std::isfinite(ground[i].height)) {
			indices.push_back(i);
		}
	}
	return indices;
}

std::vector<glm::dvec2> positions_at(std::span<const glm::dvec2> positions, std::span<const std::size_t> indices) {
	std::vector<glm::dvec2> result;
	for (const std::size_t i : indices) {
		result.push_back(positions[i]);
	}
	return result;
}

} // namespace

/// Ground from a script. Used on worker threads only if the script declares itself thread-safe.
class ScriptGround : public Terrain {
public:
	explicit ScriptGround(const Ref<ScatterGround> &p_script) : script_(p_script) {}

	std::uint64_t version() const override { return 0; }

	Status sample(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override {
		const Status status = sample_heights(positions, r_ground);
		return status.ok() ? script_->query_slopes(positions, r_ground) : status;
	}

	Status sample_heights(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) const override {
		return script_->query_heights(positions, r_ground);
	}

	Status weigh(std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures,
			std::span<Ground> r_ground) const override {
		return script_->query_weights(positions, textures, r_ground);
	}

private:
	Ref<ScatterGround> script_;
};

std::shared_ptr<const Terrain> ScatterGround::snapshot(std::uint64_t host) {
	const Ref<ScatterGround> keep_alive(this);
	return make_snapshot(find_host(host));
}

String ScatterGround::problem() {
	const Ref<ScatterGround> keep_alive(this);
	return find_problem();
}

String ScatterGround::remark() {
	const Ref<ScatterGround> keep_alive(this);
	return find_remark();
}

String ScatterGround::export_problem() {
	const Ref<ScatterGround> keep_alive(this);
	return find_export_problem();
}

bool ScatterGround::is_main_thread_only() {
	const Ref<ScatterGround> keep_alive(this);
	return only_on_main_thread();
}

Status ScatterGround::sample_now(std::uint64_t host, std::span<const glm::dvec2> positions, const GroundNeeds &needs,
		std::span<Ground> r_ground) {
	const Ref<ScatterGround> keep_alive(this);
	return sample_for(find_host(host), positions, needs, r_ground);
}

std::shared_ptr<const Terrain> ScatterGround::make_snapshot(const GroundHost &) {
	if (!GDVIRTUAL_IS_OVERRIDDEN(_get_heights) || only_on_main_thread()) {
		return nullptr;
	}
	return std::make_shared<ScriptGround>(Ref<ScatterGround>(this));
}

String ScatterGround::find_problem() {
	if (GDVIRTUAL_IS_OVERRIDDEN(_get_heights)) {
		return {};
	}
	return "ScatterGround provides no ground: use one of the classes that inherit from it, or extend it "
		   "with a script (a @tool script to see it in the editor) that has _get_heights().";
}

bool ScatterGround::has_textures() const {
	return GDVIRTUAL_IS_OVERRIDDEN(_get_heights) && GDVIRTUAL_IS_OVERRIDDEN(_get_weights);
}

bool ScatterGround::only_on_main_thread() {
	bool thread_safe = false;
	GDVIRTUAL_CALL(_is_thread_safe, thread_safe);
	return !thread_safe && GDVIRTUAL_IS_OVERRIDDEN(_get_heights);
}

std::size_t ScatterGround::max_positions_per_call() const { return script_slice; }

Status ScatterGround::sample_for(const GroundHost &, std::span<const glm::dvec2> positions, const GroundNeeds &needs,
		std::span<Ground> r_ground) {
	return ScriptGround(Ref<ScatterGround>(this)).query(positions, needs, r_ground);
}

Status ScatterGround::query_heights(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) {
	PackedFloat32Array heights;
	const Status status =
			answers_.call(this, heights_method, count_of(positions), heights, Variant(packed_vectors(positions)));
	if (!status.ok()) {
		return status;
	}
	const float *height = heights.ptr();
	for (Ground &ground : r_ground) {
		ground.height = *height++;
		ground.normal = {0.0F, 1.0F, 0.0F};
	}
	return {};
}

Status ScatterGround::query_slopes(std::span<const glm::dvec2> positions, std::span<Ground> r_ground) {
	const std::vector<std::size_t> indices = indices_with_ground(r_ground);
	if (indices.empty()) {
		return {};
	}
	return GDVIRTUAL_IS_OVERRIDDEN(_get_normals) ? query_normals(positions, indices, r_ground)
												 : difference_normals(positions, indices, r_ground);
}

Status ScatterGround::query_weights(
		std::span<const glm::dvec2> positions, std::span<const std::int32_t> textures, std::span<Ground> r_ground) {
	const std::vector<std::size_t> indices = indices_with_ground(r_ground);
	if (indices.empty() || !GDVIRTUAL_IS_OVERRIDDEN(_get_weights)) {
		return {};
	}
	PackedFloat32Array weights;
	const std::vector<glm::dvec2> ground_positions = positions_at(positions, indices);
	const Status status = answers_.call(this, weights_method, count_of(ground_positions), weights,
			Variant(packed_vectors(ground_positions)), Variant(packed_integers(textures)));
	if (!status.ok()) {
		return status;
	}
	const float *weight = weights.ptr();
	for (const std::size_t i : indices) {
		r_ground[i].weight = std::isfinite(*weight) ? std::clamp(*weight, 0.0F, 1.0F) : 0.0F;
		++weight;
	}
	return {};
}

Status ScatterGround::query_normals(
		std::span<const glm::dvec2> positions, std::span<const std::size_t> indices, std::span<Ground> r_ground) {
	PackedVector3Array normals;
	const std::vector<glm::dvec2> ground_positions = positions_at(positions, indices);
	const Status status = answers_.call(
			this, normals_method, count_of(ground_positions), normals, Variant(packed_vectors(ground_positions)));
	if (!status.ok()) {
		return status;
	}
	const Vector3 *normal = normals.ptr();
	for (const std::size_t i : indices) {
		set_normal(*normal++, r_ground[i]);
	}
	return {};
}

/// Computes normals from the heights of four neighbors of each position, queried in one call.
Status ScatterGround::difference_normals(
		std::span<const glm::dvec2> positions, std::span<const std::size_t> indices, std::span<Ground> r_ground) {
	std::vector<glm::dvec2> neighbors;
	neighbors.reserve(4 * indices.size());
	for (const std::size_t i : indices) {
		const SlopeStencil stencil(positions[i]);
		neighbors.insert(neighbors.end(), stencil.positions().begin(), stencil.positions().end());
	}
	PackedFloat32Array heights;
	const Status status =
			answers_.call(this, heights_method, count_of(neighbors), heights, Variant(packed_vectors(neighbors)));
	if (!status.ok()) {
		return status;
	}
	const float *height = heights.ptr();
	for (const std::size_t i : indices) {
		r_ground[i].normal =
				SlopeStencil(positions[i]).normal(r_ground[i].height, std::span<const float, 4>(height, 4));
		height += 4;
	}
	return {};
}

bool ScatterGround::can_change_unreported() const { return GDVIRTUAL_IS_OVERRIDDEN(_get_heights); }

Status ScatterGround::recheck_now(
		std::uint64_t host, std::span<const glm::dvec2> positions, std::span<std::optional<float>> r_heights) {
	const Ref<ScatterGround> keep_alive(this);
	return recheck_for(find_host(host), positions, r_heights);
}

Status ScatterGround::recheck_for(
		const GroundHost &host, std::span<const glm::dvec2> positions, std::span<std::optional<float>> r_heights) {
	std::vector<Ground> ground(positions.size());
	const Status status = sample_for(host, positions, {.textures = {}, .normals = false}, ground);
	std::ranges::transform(ground, r_heights.begin(), &Ground::height);
	return status;
}

/// Hides `recheck_enabled` for ground that emits signals for all changes, because it has no effect
/// there.
void ScatterGround::_validate_property(PropertyInfo &p_property) const {
	if (p_property.name == StringName("recheck_enabled") && !can_change_unreported()) {
		p_property.usage = PROPERTY_USAGE_STORAGE;
	}
}

GroundHost ScatterGround::find_host(std::uint64_t id) const {
	const auto host = std::ranges::find(hosts_, id, &GroundHost::id);
	return host != hosts_.end() ? *host : hosts_.empty() ? GroundHost{} : hosts_.front();
}

Ground ScatterGround::ground_at(const Vector3 &p_global_position, bool normal) {
	const Ref<ScatterGround> keep_alive(this); // A script may release the ground.
	const glm::dvec2 position{p_global_position.x, p_global_position.z};
	const Ground no_ground{std::numeric_limits<float>::quiet_NaN(), glm::vec3{0.0F}};
	Ground ground = no_ground;
	finish_reading();
	const std::shared_ptr<const Terrain> terrain = snapshot(0);
	if (terrain == nullptr && !is_main_thread_only()) {
		return no_ground;
	}
	const GroundNeeds needs{.textures = {}, .normals = normal};
	const Status status = terrain ? terrain->query({&position, 1}, needs, {&ground, 1})
								  : sample_now(0, {&position, 1}, needs, {&ground, 1});
	if (!status.ok()) {
		ERR_PRINT(String((std::string(class_name) + ": " + describe(status)).c_str()));
	}
	return status.ok() && std::isfinite(ground.height) ? ground : no_ground;
}

void ScatterGround::enter(Node3D *p_host, const WorldFrame &frame) {
	hosts_.push_back({p_host, p_host->get_instance_id(), frame.local ? glm::dvec3(0.0) : frame.offset, frame.local});
	hosts_changed(hosts_.size() == 1);
}

void ScatterGround::leave(Node3D *p_host) {
	const Node3D *first = first_node();
	const auto host = std::ranges::find(hosts_, p_host, &GroundHost::node);
	if (host != hosts_.end()) {
		hosts_.erase(host);
	}
	const bool first_changed = first_node() != first;
	hosts_changed(first_changed);
	if (first_changed && first_node() != nullptr) {
		emit_changed();
	}
}

void ScatterGround::set_world_frame(const Node3D *p_host, const WorldFrame &frame) {
	const auto entry = std::ranges::find(hosts_, p_host, &GroundHost::node);
	const glm::dvec3 offset = frame.local ? glm::dvec3(0.0) : frame.offset;
	const bool moves_among_others = frame.local && is_shared();
	if (entry != hosts_.end() && (entry->offset != offset || entry->local != frame.local || moves_among_others)) {
		entry->offset = offset;
		entry->local = frame.local;
		const GroundHost host = *entry;
		offset_changed(host);
	}
}

void ScatterGround::follow_scene(std::chrono::steady_clock::time_point deadline) {
	const std::uint64_t frame = Engine::get_singleton()->get_process_frames();
	if (std::exchange(followed_frame_, frame) == frame) {
		// Another host has already called this in the current frame.
		return;
	}
	const Ref<ScatterGround> keep_alive(this);
	deadline_ = deadline;
	follow();
}

bool ScatterGround::reread() {
	const Ref<ScatterGround> keep_alive(this);
	return start_rereading();
}

void ScatterGround::update_warnings() {
	for (const GroundHost &host : hosts_) {
		host.node->call_deferred("update_configuration_warnings");
	}
}

void ScatterGround::emit_ground_changed(const Rect2 &p_rect) { emit_signal("ground_changed", p_rect); }

double ScatterGround::get_height(const Vector3 &p_global_position) {
	return ground_at(p_global_position, false).height;
}

Vector3 ScatterGround::get_normal(const Vector3 &p_global_position) {
	return to_engine(ground_at(p_global_position, true).normal);
}

void ScatterGround::_bind_methods() {
	bind_guarded<&ScatterGround::get_height>(ThreadUse::main, D_METHOD("get_height", "global_position"));
	bind_guarded<&ScatterGround::get_normal>(ThreadUse::main, D_METHOD("get_normal", "global_position"));
	bind_guarded<&ScatterGround::set_recheck_enabled>(D_METHOD("set_recheck_enabled", "enabled"));
	bind_guarded<&ScatterGround::is_recheck_enabled>(D_METHOD("is_recheck_enabled"));
	ADD_PROPERTY(PropertyInfo(Variant::BOOL, "recheck_enabled"), "set_recheck_enabled", "is_recheck_enabled");
	GDVIRTUAL_BIND(_get_heights, "positions");
	GDVIRTUAL_BIND(_get_normals, "positions");
	GDVIRTUAL_BIND(_get_weights, "positions", "textures");
	GDVIRTUAL_BIND(_is_thread_safe);
	ADD_SIGNAL(MethodInfo("ground_changed", PropertyInfo(Variant::RECT2, "rect")));
}

} // namespace thicket
