#pragma once

// This file implements the queries of scripts for a TerrainScatter3D and its snapshots. A
// `QueryHost` provides
//   static std::string name_of(method);  // `Class.method`, for errors
//   const WorldFrame &world_frame() const;
//   SharedLayers prepare(method);        // null, with an error, if there is nothing to query
//   String find_queried_layers(layers, std::vector<std::uint32_t> &r_indices);  // see find_layers
//   bool answer(method, query);  // calls query(const InstanceQuery &); false, with an error
//   Variant get_instance_data(int64_t id) const;
// Predicates are scripts, which may free anything, so the caller must keep the host alive during
// these calls.

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

/// The parameters that all kinds of queries share.
struct QueryParameters {
	const char *method;
	const godot::Variant &layers;
	const godot::Callable &predicate;
};

/// Creates the filter of a query from its layers and predicate. Returns the list that the layer
/// indices of the result refer to. If the query is invalid, prints an error and returns null.
template <class QueryHost>
SharedLayers open_query(QueryHost &host, const QueryParameters &parameters, QueryFilter &r_filter) {
	const WorldFrame frame = host.world_frame();
	const SharedLayers layers = host.prepare(parameters.method);
	if (layers == nullptr) {
		return nullptr;
	}
	if (const godot::String problem = host.find_queried_layers(parameters.layers, r_filter.layers);
			!problem.is_empty()) {
		ERR_PRINT(godot::String(host.name_of(parameters.method).c_str()) + godot::String(": ") + problem);
		return nullptr;
	}
	r_filter.accepts = to_predicate(host.name_of(parameters.method), parameters.predicate, frame, layers);
	return layers;
}

/// The instances that a query has found, and the list that their layer indices refer to.
struct AnsweredInstances {
	FoundInstances instances;
	SharedLayers layers;
};

template <class QueryHost>
godot::Ref<ScatterInstances> answer_rect(
		QueryHost &host, const QueryParameters &parameters, const godot::Rect2 &p_rect) {
	const WorldFrame frame = host.world_frame();
	QueryFilter filter;
	FoundInstances instances;
	SharedLayers layers = open_query(host, parameters, filter);
	if (layers != nullptr) {
		host.answer(parameters.method,
				[&](const InstanceQuery &query) { return query.in_rect(to_world(p_rect, frame), filter, instances); });
	}
	return ScatterInstances::of(std::move(instances), frame, std::move(layers));
}

template <class QueryHost>
AnsweredInstances find_in_sphere(
		QueryHost &host, const QueryParameters &parameters, const godot::Vector3 &p_center, double p_radius) {
	const glm::dvec3 center = to_world(p_center, host.world_frame());
	QueryFilter filter;
	AnsweredInstances answer;
	answer.layers = open_query(host, parameters, filter);
	if (answer.layers != nullptr) {
		host.answer(parameters.method, [&](const InstanceQuery &query) {
			return query.in_sphere(center, p_radius, filter, answer.instances);
		});
	}
	return answer;
}

template <class QueryHost>
godot::Ref<ScatterInstances> answer_sphere(
		QueryHost &host, const QueryParameters &parameters, const godot::Vector3 &p_center, double p_radius) {
	const WorldFrame frame = host.world_frame();
	AnsweredInstances answer = find_in_sphere(host, parameters, p_center, p_radius);
	return ScatterInstances::of(std::move(answer.instances), frame, std::move(answer.layers));
}

template <class QueryHost>
godot::Ref<ScatterInstance> answer_ray(
		QueryHost &host, const QueryParameters &parameters, const godot::Vector3 &p_from, const godot::Vector3 &p_to) {
	const WorldFrame frame = host.world_frame();
	const glm::dvec3 from = to_world(p_from, frame);
	const glm::dvec3 to = to_world(p_to, frame);
	QueryFilter filter;
	std::vector<RayHit> hits;
	const SharedLayers layers = open_query(host, parameters, filter);
	if (layers != nullptr) {
		host.answer(
				parameters.method, [&](const InstanceQuery &query) { return query.on_ray(from, to, filter, hits); });
	}
	if (hits.empty()) {
		return {};
	}
	const RayHit &hit = hits.front();
	const double length = glm::length(to - from);
	const double fraction = length > 0.0 ? hit.distance / length : 0.0;
	return ScatterInstance::of(hit.instance, frame, layers->at(hit.instance.layer),
			host.get_instance_data(script_id(hit.instance.id)), hit.distance, from + fraction * (to - from));
}

template <class QueryHost>
godot::Ref<ScatterInstance> answer_nearest(
		QueryHost &host, const QueryParameters &parameters, const godot::Vector3 &p_position, double p_max_distance) {
	const WorldFrame frame = host.world_frame();
	const glm::dvec3 position = to_world(p_position, frame);
	QueryFilter filter;
	std::vector<NearestInstance> matches;
	const SharedLayers layers = open_query(host, parameters, filter);
	if (layers != nullptr) {
		host.answer(parameters.method,
				[&](const InstanceQuery &query) { return query.nearest(position, p_max_distance, filter, matches); });
	}
	if (matches.empty()) {
		return {};
	}
	const PlacedInstance &instance = matches.front().instance;
	return ScatterInstance::of(instance, frame, layers->at(instance.layer),
			host.get_instance_data(script_id(instance.id)), matches.front().distance);
}

/// Finds an instance by its ID. Returns null if the instance does not exist.
template <class QueryHost>
godot::Ref<ScatterInstance> answer_id(QueryHost &host, const char *method, int64_t p_id) {
	const WorldFrame frame = host.world_frame();
	std::vector<PlacedInstance> matches;
	const SharedLayers layers = host.prepare(method);
	if (layers != nullptr) {
		host.answer(method, [&](const InstanceQuery &query) { return query.by_id(core_id(p_id), matches); });
	}
	return matches.empty() ? godot::Ref<ScatterInstance>()
						   : ScatterInstance::of(matches.front(), frame, layers->at(matches.front().layer),
									 host.get_instance_data(p_id));
}

} // namespace thicket
