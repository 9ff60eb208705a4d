// This file contains the query methods of ScatterGameplay. They find instances in loaded tiles and
// generate the other tiles that they need.

#include "nodes/gameplay/scatter_gameplay.hpp"

#include "nodes/common/engine_arrays.hpp"
#include "nodes/common/property_check.hpp"
#include "nodes/common/threads.hpp"
#include "nodes/gameplay/script_queries.hpp"

#include <godot_cpp/core/memory.hpp>

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

void report_query(const char *p_method, const Status &status) {
	if (!status.ok()) {
		report(ScatterGameplay::name_of(p_method).c_str(), status);
	}
}

} // namespace

SharedLayers ScatterGameplay::prepare(const char *p_method) {
	const Status status = alive() ? host_->prepare() : Status{ErrorCode::cancelled};
	report_query(p_method, status);
	return status.ok() && alive() ? listed_layers_ : nullptr;
}

bool ScatterGameplay::answer(const char *p_method, const PreparedQuery &query) {
	const Ref<ScatterState> state = state_;
	const Status status = world_.answer(query);
	report_query(p_method, status);
	return status.ok();
}

Ref<ScatterInstances> ScatterGameplay::query_rect(
		const Rect2 &p_rect, const Variant &p_layers, const Callable &p_predicate) {
	return answer_rect(*this, {"query_rect", p_layers, p_predicate}, p_rect);
}

Ref<ScatterInstances> ScatterGameplay::query_sphere(
		const Vector3 &p_center, double p_radius, const Variant &p_layers, const Callable &p_predicate) {
	return answer_sphere(*this, {"query_sphere", p_layers, p_predicate}, p_center, p_radius);
}

Ref<ScatterInstance> ScatterGameplay::query_ray(
		const Vector3 &p_from, const Vector3 &p_to, const Variant &p_layers, const Callable &p_predicate) {
	return answer_ray(*this, {"query_ray", p_layers, p_predicate}, p_from, p_to);
}

Ref<ScatterInstance> ScatterGameplay::query_nearest(
		const Vector3 &p_position, double p_max_distance, const Variant &p_layers, const Callable &p_predicate) {
	return answer_nearest(*this, {"query_nearest", p_layers, p_predicate}, p_position, p_max_distance);
}

Ref<ScatterSnapshot> ScatterGameplay::make_snapshot() {
	const SharedLayers layers = prepare("make_snapshot");
	if (layers == nullptr) {
		return ScatterSnapshot::make_empty();
	}
	std::optional<InstanceState> state;
	if (state_.is_valid()) {
		state = state_->share();
	}
	return ScatterSnapshot::of(
			std::make_shared<const InstanceSnapshot>(world_, std::move(state), host_->make_worker_maker()), layers,
			world_frame());
}

/// Finds the instance with an ID. If `include_removed` is true, also finds removed instances, with
/// their last placement. Returns an empty list if there is none.
std::vector<PlacedInstance> ScatterGameplay::find_by_id(const char *p_method, int64_t p_id, bool include_removed) {
	std::vector<PlacedInstance> matches;
	if (prepare(p_method) != nullptr) {
		answer(p_method, [&](const InstanceQuery &query) {
			return include_removed ? query.by_id_even_removed(core_id(p_id), matches)
								   : query.by_id(core_id(p_id), matches);
		});
	}
	return matches;
}

Ref<ScatterInstance> ScatterGameplay::get_instance(int64_t p_id) { return answer_id(*this, "get_instance", p_id); }

bool ScatterGameplay::has_instance(int64_t p_id) { return !find_by_id("has_instance", p_id, false).empty(); }

Ref<ScatterRequest> ScatterGameplay::request_rect(
		const Rect2 &p_rect, const Variant &p_layers, const Callable &p_predicate) {
	return request({"request_rect", p_rect, p_layers, p_predicate, memnew(ScatterRequest)});
}

Ref<ScatterRequest> ScatterGameplay::request_sphere(
		const Vector3 &p_center, double p_radius, const Variant &p_layers, const Callable &p_predicate) {
	return request(
			{"request_sphere", SphereInScene{p_center, p_radius}, p_layers, p_predicate, memnew(ScatterRequest)});
}

Ref<ScatterRequest> ScatterGameplay::request(PendingRequest pending) {
	const Ref<ScatterRequest> request = pending.request;
	if (on_main_thread()) {
		const std::shared_ptr<ScatterGameplay> self = shared_from_this();
		open_request(pending);
	} else {
		if (pending.layers.get_type() == Variant::ARRAY) {
			// Scripts share arrays by reference and may change this one later.
			pending.layers = copied(pending.layers);
		}
		const std::lock_guard lock(pending_mutex_);
		pending_.push_back(std::move(pending));
	}
	return request;
}

void ScatterGameplay::open_request(const PendingRequest &pending) {
	QueryFilter filter;
	std::int64_t request_number = 0;
	if (open_query(*this, {pending.method, pending.layers, Callable()}, filter) != nullptr) {
		std::variant<Rect, QueryRequests::Sphere> area;
		if (const Rect2 *rect = std::get_if<Rect2>(&pending.area)) {
			area = to_world(*rect, world_frame());
		} else {
			const auto &sphere = std::get<SphereInScene>(pending.area);
			area = QueryRequests::Sphere{to_world(sphere.center, world_frame()), sphere.radius};
		}
		report_query(pending.method, requests_.add(world_, area, filter, request_number));
	}
	if (request_number == 0) {
		pending.request->abandon();
	} else {
		open_requests_[request_number] = {pending.method, pending.predicate, pending.request};
	}
}

/// Updates the layer indices of open requests to a new list, so that they keep their layers.
void ScatterGameplay::renumber_requests(const ListedLayers &new_layers) {
	std::vector<std::uint32_t> new_indices;
	bool is_unchanged = true;
	for (std::uint32_t index = 0; index < static_cast<std::uint32_t>(listed_layers_->size()); ++index) {
		const Ref<ScatterLayer> layer = listed_layers_->at(index);
		new_indices.push_back(layer.is_null() || layer == new_layers.at(index) ? index : new_layers.find(layer));
		is_unchanged = is_unchanged && new_indices.back() == index;
	}
	if (!is_unchanged) {
		requests_.renumber(new_indices);
	}
}

void ScatterGameplay::take_requests() {
	std::vector<PendingRequest> requests;
	{
		const std::lock_guard lock(pending_mutex_);
		requests.swap(pending_);
	}
	for (const PendingRequest &pending : requests) {
		if (!pending.request->is_canceled()) {
			open_request(pending);
		}
	}
}

void ScatterGameplay::answer_requests() {
	std::erase_if(open_requests_, [this](const auto &entry) {
		const bool is_canceled = entry.second.request->is_canceled();
		return is_canceled && requests_.cancel(entry.first);
	});
	for (QueryRequests::Answer &answer : requests_.frame(world_)) {
		if (auto entry = open_requests_.extract(answer.request)) {
			answered_requests_.push_back({entry.mapped(), std::move(answer.found), listed_layers_});
		}
	}
}

void ScatterGameplay::complete_requests() {
	const WorldFrame frame = world_frame(); // A predicate may free the node.
	for (auto &[request, instances, layers] : std::exchange(answered_requests_, {})) {
		if (const auto accepts = to_predicate(name_of(request.method), request.predicate, frame, layers)) {
			instances.keep_from(0, accepts);
		}
		request.request->complete(ScatterInstances::of(std::move(instances), frame, layers));
	}
}

void ScatterGameplay::abandon_requests() {
	requests_.clear();
	std::vector<PendingRequest> unopened;
	{
		const std::lock_guard lock(pending_mutex_);
		unopened.swap(pending_);
	}
	for (const PendingRequest &pending : unopened) {
		pending.request->abandon();
	}
	for (const auto &[request_number, request] : std::exchange(open_requests_, {})) {
		request.request->abandon();
	}
	for (const AnsweredRequest &answered : std::exchange(answered_requests_, {})) {
		answered.request.request->abandon();
	}
}

} // namespace thicket
