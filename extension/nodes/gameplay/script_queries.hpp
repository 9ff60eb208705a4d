#pragma once

// Script queries, as answered by a TerrainScatter3D and its snapshots. An `Asker` has
//   glm::dvec3 world_offset() const;
//   bool find_filter(method, layers, predicate, QueryFilter &r_filter);   // false, with an error, for what is refused
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

/// The implementation of an asker's `find_filter`, for `method` (`Class.method`). `layers` are passed to find_layers.
template <class Layers>
bool make_filter(const std::string &method, const Layers &layers, const godot::Variant &p_layers,
		const godot::Callable &p_predicate, glm::dvec3 offset, QueryFilter &r_filter) {
	if (const godot::String problem = find_layers(layers, p_layers, r_filter.layers); !problem.is_empty()) {
		ERR_PRINT(godot::String(method.c_str()) + godot::String(": ") + problem);
		return false;
	}
	r_filter.accepts = to_predicate(method, p_predicate, offset);
	return true;
}

template <class Asker>
godot::Ref<ScatterInstances> answer_rect(Asker &asker, const QueryWish &wish, const godot::Rect2 &p_rect) {
	const glm::dvec3 offset = asker.world_offset();
	QueryFilter filter;
	FoundInstances found;
	if (asker.find_filter(wish.method, wish.layers, wish.predicate, filter)) {
		asker.ask(wish.method,
				[&](const InstanceQuery &query) { return query.in_rect(to_world(p_rect, offset), filter, found); });
	}
	return ScatterInstances::of(std::move(found), offset);
}

template <class Asker>
FoundInstances find_in_sphere(Asker &asker, const QueryWish &wish, const godot::Vector3 &p_center, double p_radius) {
	const glm::dvec3 center = to_world(p_center, asker.world_offset());
	QueryFilter filter;
	FoundInstances found;
	if (asker.find_filter(wish.method, wish.layers, wish.predicate, filter)) {
		asker.ask(wish.method,
				[&](const InstanceQuery &query) { return query.in_sphere(center, p_radius, filter, found); });
	}
	return found;
}

template <class Asker>
godot::Ref<ScatterInstances> answer_sphere(
		Asker &asker, const QueryWish &wish, const godot::Vector3 &p_center, double p_radius) {
	const glm::dvec3 offset = asker.world_offset();
	return ScatterInstances::of(find_in_sphere(asker, wish, p_center, p_radius), offset);
}

template <class Asker>
godot::Ref<ScatterInstance> answer_ray(
		Asker &asker, const QueryWish &wish, const godot::Vector3 &p_from, const godot::Vector3 &p_to) {
	const glm::dvec3 offset = asker.world_offset();
	const glm::dvec3 from = to_world(p_from, offset);
	const glm::dvec3 to = to_world(p_to, offset);
	QueryFilter filter;
	std::vector<RayHit> hits;
	if (asker.find_filter(wish.method, wish.layers, wish.predicate, filter)) {
		asker.ask(wish.method, [&](const InstanceQuery &query) { return query.on_ray(from, to, filter, hits); });
	}
	if (hits.empty()) {
		return {};
	}
	const RayHit &hit = hits.front();
	const double length = glm::length(to - from);
	const double share = length > 0.0 ? hit.distance / length : 0.0;
	return ScatterInstance::of(hit.instance, offset, asker.get_instance_data(script_id(hit.instance.id)), hit.distance,
			from + share * (to - from));
}

template <class Asker>
godot::Ref<ScatterInstance> answer_nearest(
		Asker &asker, const QueryWish &wish, const godot::Vector3 &p_position, double p_max_distance) {
	const glm::dvec3 offset = asker.world_offset();
	const glm::dvec3 position = to_world(p_position, offset);
	QueryFilter filter;
	std::vector<NearestInstance> found;
	if (asker.find_filter(wish.method, wish.layers, wish.predicate, filter)) {
		asker.ask(wish.method,
				[&](const InstanceQuery &query) { return query.nearest(position, p_max_distance, filter, found); });
	}
	if (found.empty()) {
		return {};
	}
	const PlacedInstance &instance = found.front().instance;
	return ScatterInstance::of(
			instance, offset, asker.get_instance_data(script_id(instance.id)), found.front().distance);
}

/// Null for an instance that does not exist.
template <class Asker>
godot::Ref<ScatterInstance> answer_id(Asker &asker, const char *method, int64_t p_id) {
	const glm::dvec3 offset = asker.world_offset();
	std::vector<PlacedInstance> found;
	asker.ask(method, [&](const InstanceQuery &query) { return query.by_id(core_id(p_id), found); });
	return found.empty() ? godot::Ref<ScatterInstance>()
						 : ScatterInstance::of(found.front(), offset, asker.get_instance_data(p_id));
}

} // namespace thicket
