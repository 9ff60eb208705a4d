#pragma once

// Script queries, as answered by a TerrainScatter3D and its snapshots. An `Asker` has
//   static std::string name_of(method);                                   // `Class.method`, for errors
//   glm::dvec3 world_offset() const;
//   SharedLayers prepare(method);                                         // null, with an error, if there is nothing to query
//   String find_queried(layers, std::vector<std::uint32_t> &r_indices);   // as find_layers
//   bool ask(method, query);                                              // calls query(const InstanceQuery &); false, with an error
//   Variant get_instance_data(int64_t id) const;
// Predicates are scripts, which may do anything, so the caller must keep an asker alive during its calls.

#include "nodes/common/convert.hpp"
#include "nodes/gameplay/instance_answers.hpp"
#include "nodes/gameplay/scatter_instances.hpp"
#include "nodes/layer/layer_reference.hpp"

#include <godot_cpp/core/error_macros.hpp>
#include <godot_cpp/variant/callable.hpp>
#include <godot_cpp/variant/rect2.hpp>

#include <glm/geometric.hpp>

#include <string>
#include <utility>
#include <vector>

namespace thicket {

/// The parameters of a query, apart from a position.
struct QueryWish {
	const char *method;
	const godot::Variant &layers;
	const godot::Callable &predicate;
};

/// Finds the layers and creates the filter of a query. Returns the layers that the indices of the answer refer to. If
/// the query is refused, prints an error and returns null.
template <class Asker>
SharedLayers open_query(Asker &asker, const QueryWish &wish, QueryFilter &r_filter) {
	const glm::dvec3 offset = asker.world_offset();
	const SharedLayers layers = asker.prepare(wish.method);
	if (layers == nullptr) {
		return nullptr;
	}
	if (const godot::String problem = asker.find_queried(wish.layers, r_filter.layers); !problem.is_empty()) {
		ERR_PRINT(godot::String(asker.name_of(wish.method).c_str()) + godot::String(": ") + problem);
		return nullptr;
	}
	r_filter.accepts = to_predicate(asker.name_of(wish.method), wish.predicate, offset, layers);
	return layers;
}

/// The instances that a query has found, and the layers that their indices refer to.
struct AnsweredInstances {
	FoundInstances found;
	SharedLayers layers;
};

template <class Asker>
godot::Ref<ScatterInstances> answer_rect(Asker &asker, const QueryWish &wish, const godot::Rect2 &p_rect) {
	const glm::dvec3 offset = asker.world_offset();
	QueryFilter filter;
	FoundInstances found;
	SharedLayers layers = open_query(asker, wish, filter);
	if (layers != nullptr) {
		asker.ask(wish.method,
				[&](const InstanceQuery &query) { return query.in_rect(to_world(p_rect, offset), filter, found); });
	}
	return ScatterInstances::of(std::move(found), offset, std::move(layers));
}

template <class Asker>
AnsweredInstances find_in_sphere(Asker &asker, const QueryWish &wish, const godot::Vector3 &p_center, double p_radius) {
	const glm::dvec3 center = to_world(p_center, asker.world_offset());
	QueryFilter filter;
	AnsweredInstances answer;
	answer.layers = open_query(asker, wish, filter);
	if (answer.layers != nullptr) {
		asker.ask(wish.method,
				[&](const InstanceQuery &query) { return query.in_sphere(center, p_radius, filter, answer.found); });
	}
	return answer;
}

template <class Asker>
godot::Ref<ScatterInstances> answer_sphere(
		Asker &asker, const QueryWish &wish, const godot::Vector3 &p_center, double p_radius) {
	const glm::dvec3 offset = asker.world_offset();
	AnsweredInstances answer = find_in_sphere(asker, wish, p_center, p_radius);
	return ScatterInstances::of(std::move(answer.found), offset, std::move(answer.layers));
}

template <class Asker>
godot::Ref<ScatterInstance> answer_ray(
		Asker &asker, const QueryWish &wish, const godot::Vector3 &p_from, const godot::Vector3 &p_to) {
	const glm::dvec3 offset = asker.world_offset();
	const glm::dvec3 from = to_world(p_from, offset);
	const glm::dvec3 to = to_world(p_to, offset);
	QueryFilter filter;
	std::vector<RayHit> hits;
	const SharedLayers layers = open_query(asker, wish, filter);
	if (layers != nullptr) {
		asker.ask(wish.method, [&](const InstanceQuery &query) { return query.on_ray(from, to, filter, hits); });
	}
	if (hits.empty()) {
		return {};
	}
	const RayHit &hit = hits.front();
	const double length = glm::length(to - from);
	const double share = length > 0.0 ? hit.distance / length : 0.0;
	return ScatterInstance::of(hit.instance, offset, layers->at(hit.instance.layer),
			asker.get_instance_data(script_id(hit.instance.id)), hit.distance, from + share * (to - from));
}

template <class Asker>
godot::Ref<ScatterInstance> answer_nearest(
		Asker &asker, const QueryWish &wish, const godot::Vector3 &p_position, double p_max_distance) {
	const glm::dvec3 offset = asker.world_offset();
	const glm::dvec3 position = to_world(p_position, offset);
	QueryFilter filter;
	std::vector<NearestInstance> found;
	const SharedLayers layers = open_query(asker, wish, filter);
	if (layers != nullptr) {
		asker.ask(wish.method,
				[&](const InstanceQuery &query) { return query.nearest(position, p_max_distance, filter, found); });
	}
	if (found.empty()) {
		return {};
	}
	const PlacedInstance &instance = found.front().instance;
	return ScatterInstance::of(instance, offset, layers->at(instance.layer),
			asker.get_instance_data(script_id(instance.id)), found.front().distance);
}

/// Null for an instance that does not exist.
template <class Asker>
godot::Ref<ScatterInstance> answer_id(Asker &asker, const char *method, int64_t p_id) {
	const glm::dvec3 offset = asker.world_offset();
	std::vector<PlacedInstance> found;
	const SharedLayers layers = asker.prepare(method);
	if (layers != nullptr) {
		asker.ask(method, [&](const InstanceQuery &query) { return query.by_id(core_id(p_id), found); });
	}
	return found.empty() ? godot::Ref<ScatterInstance>()
						 : ScatterInstance::of(found.front(), offset, layers->at(found.front().layer),
								   asker.get_instance_data(p_id));
}

} // namespace thicket
