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
	return status.ok() && alive() ? listed_ : nullptr;
}

bool ScatterGameplay::answer(const char *p_method, const AskedQuery &query) {
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

/// Finds the instance with an ID. If `even_removed` is true, also finds removed instances, with
/// their last placement. Returns an empty list if there is none.
std::vector<PlacedInstance> ScatterGameplay::find_by_id(const char *p_method, int64_t p_id, bool even_removed) {
	std::vector<PlacedInstance> found;
	if (prepare(p_method) != nullptr) {
		answer(p_method, [&](const InstanceQuery &query) {
			return even_removed ? query.by_id_even_removed(core_id(p_id), found) : query.by_id(core_id(p_id), found);
		});
	}
	return found;
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

Ref<ScatterRequest> ScatterGameplay::request(Wanted wanted) {
	const Ref<ScatterRequest> request = wanted.request;
	if (on_main_thread()) {
		const std::shared_ptr<ScatterGameplay> self = shared_from_this();
		open_request(wanted);
	} else {
		if (wanted.layers.get_type() == Variant::ARRAY) {
			// Scripts share arrays by reference and may change this one later.
			wanted.layers = copied(wanted.layers);
		}
		const std::lock_guard lock(wanted_mutex_);
		wanted_.push_back(std::move(wanted));
	}
	return request;
}

void ScatterGameplay::open_request(const Wanted &wanted) {
	QueryFilter filter;
	std::int64_t number = 0;
	if (open_query(*this, {wanted.method, wanted.layers, Callable()}, filter) != nullptr) {
		std::variant<Rect, QueryRequests::Sphere> area;
		if (const Rect2 *rect = std::get_if<Rect2>(&wanted.area)) {
			area = to_world(*rect, world_frame());
		} else {
			const auto &sphere = std::get<SphereInScene>(wanted.area);
			area = QueryRequests::Sphere{to_world(sphere.center, world_frame()), sphere.radius};
		}
		report_query(wanted.method, requests_.add(world_, area, filter, number));
	}
	if (number == 0) {
		wanted.request->give_up();
	} else {
		open_[number] = {wanted.method, wanted.predicate, wanted.request};
	}
}

/// Updates the layer indices of open requests to a new list, so that they keep their layers.
void ScatterGameplay::renumber_requests(const ListedLayers &listed) {
	std::vector<std::uint32_t> current;
	bool same = true;
	for (std::uint32_t index = 0; index < static_cast<std::uint32_t>(listed_->size()); ++index) {
		const Ref<ScatterLayer> layer = listed_->at(index);
		current.push_back(layer.is_null() || layer == listed.at(index) ? index : listed.find(layer));
		same = same && current.back() == index;
	}
	if (!same) {
		requests_.renumber(current);
	}
}

void ScatterGameplay::take_requests() {
	std::vector<Wanted> taken;
	{
		const std::lock_guard lock(wanted_mutex_);
		taken.swap(wanted_);
	}
	for (const Wanted &wanted : taken) {
		if (!wanted.request->is_canceled()) {
			open_request(wanted);
		}
	}
}

void ScatterGameplay::answer_requests() {
	std::erase_if(open_, [this](const auto &open) {
		const bool canceled = open.second.request->is_canceled();
		return canceled && requests_.cancel(open.first);
	});
	for (QueryRequests::Answer &answer : requests_.frame(world_)) {
		if (auto open = open_.extract(answer.request)) {
			answered_.push_back({open.mapped(), std::move(answer.found), listed_});
		}
	}
}

void ScatterGameplay::complete_requests() {
	const WorldFrame frame = world_frame(); // A predicate may free the node.
	for (auto &[open, found, layers] : std::exchange(answered_, {})) {
		if (const auto accepts = to_predicate(name_of(open.method), open.predicate, frame, layers)) {
			found.keep_from(0, accepts);
		}
		open.request->complete(ScatterInstances::of(std::move(found), frame, layers));
	}
}

void ScatterGameplay::give_up_requests() {
	requests_.clear();
	std::vector<Wanted> unopened;
	{
		const std::lock_guard lock(wanted_mutex_);
		unopened.swap(wanted_);
	}
	for (const Wanted &wanted : unopened) {
		wanted.request->give_up();
	}
	for (const auto &[number, open] : std::exchange(open_, {})) {
		open.request->give_up();
	}
	for (const Answered &answered : std::exchange(answered_, {})) {
		answered.open.request->give_up();
	}
}

} // namespace thicket
