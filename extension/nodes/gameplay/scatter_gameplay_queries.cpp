// What a ScatterGameplay answers: what stands where, in loaded tiles and in all others.

#include "nodes/gameplay/scatter_gameplay.hpp"

#include "nodes/common/property_check.hpp"
#include "nodes/gameplay/instance_answers.hpp"
#include "nodes/layer/layer_reference.hpp"

#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/core/memory.hpp>

#include <glm/geometric.hpp>

#include <string>
#include <utility>

using namespace godot;

namespace thicket {

namespace {

std::string name_of(const char *p_method) { return std::string("TerrainScatter3D.") + p_method; }

void report_query(const char *p_method, const Status &status) {
	if (!status.ok()) {
		report(name_of(p_method).c_str(), status);
	}
}

} // namespace

/// False, with an error, where there is nothing to ask, and for a node that is gone by now.
bool ScatterGameplay::prepare(const char *p_method) {
	const Status status = alive() ? host_->prepare() : Status{ErrorCode::cancelled};
	report_query(p_method, status);
	return status.ok() && alive();
}

/// Asks what is known, and has made for it what is not. Holds the state meanwhile.
template <class Query>
bool ScatterGameplay::ask(const char *p_method, const Query &query) {
	if (!prepare(p_method)) {
		return false;
	}
	const Ref<ScatterState> state = state_;
	const Status status = world_.ask(query);
	report_query(p_method, status);
	return status.ok();
}

bool ScatterGameplay::find_filter(
		const char *p_method, const Variant &p_layers, const Callable &p_predicate, QueryFilter &r_filter) const {
	if (!alive()) {
		return false;
	}
	if (const String problem = find_layers(host_->layers(), p_layers, r_filter.layers); !problem.is_empty()) {
		ERR_PRINT(String(name_of(p_method).c_str()) + String(": ") + problem);
		return false;
	}
	r_filter.accepts = to_predicate(p_method, p_predicate, offset_);
	return true;
}

Ref<ScatterInstances> ScatterGameplay::query_rect(
		const Rect2 &p_rect, const Variant &p_layers, const Callable &p_predicate) {
	const glm::dvec3 offset = offset_;
	QueryFilter filter;
	FoundInstances found;
	if (find_filter("query_rect", p_layers, p_predicate, filter)) {
		ask("query_rect",
				[&](const InstanceQuery &query) { return query.in_rect(to_world(p_rect, offset), filter, found); });
	}
	return ScatterInstances::of(std::move(found), offset);
}

Ref<ScatterInstances> ScatterGameplay::query_sphere(
		const Vector3 &p_center, double p_radius, const Variant &p_layers, const Callable &p_predicate) {
	const glm::dvec3 offset = offset_;
	return ScatterInstances::of(find_in_sphere("query_sphere", p_center, p_radius, p_layers, p_predicate), offset);
}

FoundInstances ScatterGameplay::find_in_sphere(const char *p_method, const Vector3 &p_center, double p_radius,
		const Variant &p_layers, const Callable &p_predicate) {
	const glm::dvec3 center = to_world(p_center, offset_);
	QueryFilter filter;
	FoundInstances found;
	if (find_filter(p_method, p_layers, p_predicate, filter)) {
		ask(p_method, [&](const InstanceQuery &query) { return query.in_sphere(center, p_radius, filter, found); });
	}
	return found;
}

Dictionary ScatterGameplay::query_ray(
		const Vector3 &p_from, const Vector3 &p_to, const Variant &p_layers, const Callable &p_predicate) {
	const glm::dvec3 offset = offset_;
	const glm::dvec3 from = to_world(p_from, offset);
	const glm::dvec3 to = to_world(p_to, offset);
	QueryFilter filter;
	std::vector<RayHit> hits;
	if (find_filter("query_ray", p_layers, p_predicate, filter)) {
		ask("query_ray", [&](const InstanceQuery &query) { return query.on_ray(from, to, filter, hits); });
	}
	Dictionary result;
	if (!hits.empty()) {
		const PlacedInstance &instance = hits.front().instance;
		const double length = glm::length(to - from);
		const double share = length > 0.0 ? hits.front().distance / length : 0.0;
		result["id"] = script_id(instance.id);
		result["layer"] = static_cast<int64_t>(instance.layer);
		result["mesh"] = static_cast<int64_t>(instance.mesh);
		result["transform"] = to_engine(instance, offset);
		result["distance"] = hits.front().distance;
		result["position"] = to_engine(from + share * (to - from), offset);
	}
	return result;
}

Ref<ScatterInstance> ScatterGameplay::query_nearest(
		const Vector3 &p_position, double p_max_distance, const Variant &p_layers, const Callable &p_predicate) {
	const glm::dvec3 offset = offset_;
	const glm::dvec3 position = to_world(p_position, offset);
	QueryFilter filter;
	std::vector<NearestInstance> found;
	if (find_filter("query_nearest", p_layers, p_predicate, filter)) {
		ask("query_nearest",
				[&](const InstanceQuery &query) { return query.nearest(position, p_max_distance, filter, found); });
	}
	if (found.empty()) {
		return {};
	}
	const PlacedInstance &instance = found.front().instance;
	return ScatterInstance::of(instance, offset, get_instance_data(script_id(instance.id)), found.front().distance);
}

/// The instance of an id, or, if `even_removed`, where it would stand. Empty for none.
std::vector<PlacedInstance> ScatterGameplay::find_by_id(const char *p_method, int64_t p_id, bool even_removed) {
	std::vector<PlacedInstance> found;
	ask(p_method, [&](const InstanceQuery &query) {
		return even_removed ? query.by_id_even_removed(core_id(p_id), found) : query.by_id(core_id(p_id), found);
	});
	return found;
}

Ref<ScatterInstance> ScatterGameplay::get_instance(int64_t p_id) {
	const glm::dvec3 offset = offset_;
	const std::vector<PlacedInstance> found = find_by_id("get_instance", p_id, false);
	return found.empty() ? Ref<ScatterInstance>() : ScatterInstance::of(found.front(), offset, get_instance_data(p_id));
}

bool ScatterGameplay::has_instance(int64_t p_id) { return !find_by_id("has_instance", p_id, false).empty(); }

Ref<ScatterRequest> ScatterGameplay::request_rect(const Rect2 &p_rect, const Variant &p_layers) {
	return request("request_rect", to_world(p_rect, offset_), p_layers);
}

Ref<ScatterRequest> ScatterGameplay::request_sphere(const Vector3 &p_center, double p_radius, const Variant &p_layers) {
	return request("request_sphere", QueryRequests::Sphere{to_world(p_center, offset_), p_radius}, p_layers);
}

Ref<ScatterRequest> ScatterGameplay::request(const char *p_method, const Area &area, const Variant &p_layers) {
	const Ref<ScatterRequest> request(memnew(ScatterRequest));
	QueryFilter filter;
	std::int64_t number = 0;
	if (find_filter(p_method, p_layers, {}, filter) && prepare(p_method)) {
		report_query(p_method, requests_.add(world_, area, filter, number));
	}
	if (number == 0) {
		request->give_up();
		return request;
	}
	open_[number] = request;
	request->begin([weak = weak_from_this(), number] {
		if (const std::shared_ptr<ScatterGameplay> gameplay = weak.lock()) {
			gameplay->requests_.cancel(number);
			gameplay->open_.erase(number);
		}
	});
	return request;
}

void ScatterGameplay::answer_requests() {
	for (QueryRequests::Answer &answer : requests_.frame(world_)) {
		if (auto open = open_.extract(answer.request)) {
			answered_.emplace_back(open.mapped(), ScatterInstances::of(std::move(answer.found), offset_));
		}
	}
}

void ScatterGameplay::complete_requests() {
	for (const auto &[request, result] : std::exchange(answered_, {})) {
		request->complete(result);
	}
}

void ScatterGameplay::give_up_requests() {
	requests_.clear();
	for (const auto &[number, request] : std::exchange(open_, {})) {
		request->give_up();
	}
	for (const auto &[request, result] : std::exchange(answered_, {})) {
		request->give_up();
	}
}

} // namespace thicket
