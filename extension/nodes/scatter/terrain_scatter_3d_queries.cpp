// What a TerrainScatter3D answers: what stands where, on loaded places and on all others.

#include "core/base/tile_grid.hpp"
#include "nodes/gameplay/instance_answers.hpp"
#include "nodes/scatter/build_at_once.hpp"
#include "nodes/scatter/terrain_scatter_3d.hpp"

#include <godot_cpp/core/class_db.hpp>

#include <glm/geometric.hpp>

#include <string>
#include <utility>
#include <vector>

using namespace godot;

namespace thicket {

namespace {

void report_query(const char *p_method, const Status &status) {
	report((std::string("TerrainScatter3D.") + p_method).c_str(), status);
}

} // namespace

/// Settings that were changed in this frame count. False, with an error, where there is nothing to ask.
bool TerrainScatter3D::prepare_query(const char *p_method) {
	notice_layers();
	if (dirty_) {
		refresh();
	}
	if (layer_list_.snapshots().empty()) {
		report_query(p_method, {ErrorCode::missing, terrain_.is_null() ? "terrain" : "layers", 0.0});
		return false;
	}
	return true;
}

/// A tile for somebody who cannot wait. By value: what a script does while it is asked for the ground is of no consequence.
TileMaker TerrainScatter3D::tile_maker() const {
	return [layers = layer_list_.snapshots(), ground = ground_, terrain = terrain_](
				   std::uint32_t layer, glm::ivec2 tile, std::shared_ptr<const TileInstances> &r_tile) -> Status {
		if (layer >= layers.size() || layers[layer] == nullptr || !terrain->ready()) {
			return {};
		}
		TileInstances made;
		const Rect rect = tile_rect(layers[layer]->range.tile_size, tile);
		const Status status = build_at_once(*layers[layer]->settings, ground.get(), *terrain.ptr(), rect, made);
		if (status.ok()) {
			r_tile = std::make_shared<const TileInstances>(std::move(made));
		}
		return status;
	};
}

void TerrainScatter3D::update_world(const std::vector<EditedArea> &outdated) {
	std::vector<QueryLayer> layers;
	std::vector<CollisionLayer> colliding;
	for (const SharedSnapshot &layer : layer_list_.snapshots()) {
		layers.push_back(query_layer(layer.get()));
		colliding.push_back(collision_of(layer.get()));
	}
	world_->set_layers(std::move(layers));
	collision_.set_layers(std::move(colliding));
	for (std::uint32_t layer = 0; layer < outdated.size(); ++layer) {
		world_->invalidate(layer, outdated[layer]);
	}
	world_->set_maker(tile_maker());
	claim_layers();
}

/// Asks what is known and what has to be made for it. Holds what the query needs meanwhile: a script that is asked for the ground
/// may do anything.
template <class Query>
void TerrainScatter3D::ask(const char *p_method, Query &&query) {
	if (prepare_query(p_method)) {
		const std::shared_ptr<InstanceWorld> world = world_;
		const Ref<ScatterState> state = state_;
		report_query(p_method, world->ask(query));
	}
}

Dictionary TerrainScatter3D::query_rect(
		const Rect2 &p_rect, const PackedInt32Array &p_layers, const Callable &p_predicate) {
	const glm::dvec3 offset = world_offset_;
	const QueryFilter filter = to_filter("query_rect", p_layers, p_predicate, offset);
	std::vector<PlacedInstance> found;
	ask("query_rect",
			[&](const InstanceQuery &query) { return query.in_rect(to_world(p_rect, offset), filter, found); });
	return to_arrays(found, offset);
}

Dictionary TerrainScatter3D::query_sphere(
		const Vector3 &p_center, double p_radius, const PackedInt32Array &p_layers, const Callable &p_predicate) {
	const glm::dvec3 offset = world_offset_;
	return to_arrays(find_in_sphere("query_sphere", p_center, p_radius, p_layers, p_predicate), offset);
}

std::vector<PlacedInstance> TerrainScatter3D::find_in_sphere(const char *p_method, const Vector3 &p_center,
		double p_radius, const PackedInt32Array &p_layers, const Callable &p_predicate) {
	const glm::dvec3 center = to_world(p_center, world_offset_);
	const QueryFilter filter = to_filter(p_method, p_layers, p_predicate, world_offset_);
	std::vector<PlacedInstance> found;
	ask(p_method, [&](const InstanceQuery &query) { return query.in_sphere(center, p_radius, filter, found); });
	return found;
}

Dictionary TerrainScatter3D::query_ray(
		const Vector3 &p_from, const Vector3 &p_to, const PackedInt32Array &p_layers, const Callable &p_predicate) {
	const glm::dvec3 offset = world_offset_;
	const QueryFilter filter = to_filter("query_ray", p_layers, p_predicate, offset);
	const glm::dvec3 from = to_world(p_from, offset);
	const glm::dvec3 to = to_world(p_to, offset);
	std::vector<RayHit> hits;
	ask("query_ray", [&](const InstanceQuery &query) { return query.on_ray(from, to, filter, hits); });
	Dictionary result;
	if (!hits.empty()) {
		const double length = glm::length(to - from);
		result = to_dictionary(hits.front().instance, offset);
		result["distance"] = hits.front().distance;
		const double share = length > 0.0 ? hits.front().distance / length : 0.0;
		result["position"] = to_engine(from + share * (to - from), offset);
	}
	return result;
}

Dictionary TerrainScatter3D::query_nearest(const Vector3 &p_position, double p_max_distance,
		const PackedInt32Array &p_layers, const Callable &p_predicate) {
	const glm::dvec3 offset = world_offset_;
	const QueryFilter filter = to_filter("query_nearest", p_layers, p_predicate, offset);
	const glm::dvec3 position = to_world(p_position, offset);
	std::vector<NearestInstance> found;
	ask("query_nearest",
			[&](const InstanceQuery &query) { return query.nearest(position, p_max_distance, filter, found); });
	Dictionary result;
	if (!found.empty()) {
		result = to_dictionary(found.front().instance, offset);
		result["distance"] = found.front().distance;
	}
	return result;
}

/// The instance of an id, or, if `even_removed`, where it would stand. Empty for none.
std::vector<PlacedInstance> TerrainScatter3D::find_by_id(const char *p_method, int64_t p_id, bool even_removed) {
	std::vector<PlacedInstance> found;
	ask(p_method, [&](const InstanceQuery &query) {
		return even_removed ? query.by_id_even_removed(core_id(p_id), found) : query.by_id(core_id(p_id), found);
	});
	return found;
}

Dictionary TerrainScatter3D::get_instance(int64_t p_id) {
	const glm::dvec3 offset = world_offset_;
	const std::vector<PlacedInstance> found = find_by_id("get_instance", p_id, false);
	Dictionary result;
	if (!found.empty()) {
		result = to_dictionary(found.front(), offset);
		result["data"] = get_instance_data(p_id);
		result["added"] = is_added(core_id(p_id));
	}
	return result;
}

bool TerrainScatter3D::has_instance(int64_t p_id) { return !find_by_id("has_instance", p_id, false).empty(); }

int64_t TerrainScatter3D::request(const char *p_method, const std::variant<Rect, QueryRequests::Sphere> &place,
		const PackedInt32Array &p_layers) {
	std::int64_t number = 0;
	if (prepare_query(p_method)) {
		const QueryFilter filter = to_filter(p_method, p_layers, {}, world_offset_);
		report_query(p_method, requests_.add(*world_, place, filter, number));
	}
	return number;
}

int64_t TerrainScatter3D::get_body_instance(const RID &p_body) const {
	return script_id(collision_.instance_of(p_body));
}

int64_t TerrainScatter3D::request_rect(const Rect2 &p_rect, const PackedInt32Array &p_layers) {
	return request("request_rect", to_world(p_rect, world_offset_), p_layers);
}

int64_t TerrainScatter3D::request_sphere(const Vector3 &p_center, double p_radius, const PackedInt32Array &p_layers) {
	return request("request_sphere", QueryRequests::Sphere{to_world(p_center, world_offset_), p_radius}, p_layers);
}

bool TerrainScatter3D::cancel_request(int64_t p_request) { return requests_.cancel(p_request); }

void TerrainScatter3D::answer_requests() {
	for (const QueryRequests::Answer &answer : requests_.frame(*world_)) {
		answers_.emplace_back(answer.request, to_arrays(answer.found, world_offset_));
	}
}

void TerrainScatter3D::bind_queries() {
	using Self = TerrainScatter3D;
	ClassDB::bind_method(D_METHOD("query_rect", "rect", "layers", "predicate"), &Self::query_rect,
			DEFVAL(PackedInt32Array()), DEFVAL(Callable()));
	ClassDB::bind_method(D_METHOD("query_sphere", "center", "radius", "layers", "predicate"), &Self::query_sphere,
			DEFVAL(PackedInt32Array()), DEFVAL(Callable()));
	ClassDB::bind_method(D_METHOD("query_ray", "from", "to", "layers", "predicate"), &Self::query_ray,
			DEFVAL(PackedInt32Array()), DEFVAL(Callable()));
	ClassDB::bind_method(D_METHOD("query_nearest", "position", "max_distance", "layers", "predicate"),
			&Self::query_nearest, DEFVAL(PackedInt32Array()), DEFVAL(Callable()));
	ClassDB::bind_method(D_METHOD("get_instance", "id"), &Self::get_instance);
	ClassDB::bind_method(D_METHOD("has_instance", "id"), &Self::has_instance);
	ClassDB::bind_method(D_METHOD("get_body_instance", "body"), &Self::get_body_instance);
	ClassDB::bind_method(D_METHOD("request_rect", "rect", "layers"), &Self::request_rect, DEFVAL(PackedInt32Array()));
	ClassDB::bind_method(D_METHOD("request_sphere", "center", "radius", "layers"), &Self::request_sphere,
			DEFVAL(PackedInt32Array()));
	ClassDB::bind_method(D_METHOD("cancel_request", "request"), &Self::cancel_request);
	ADD_SIGNAL(MethodInfo(
			"query_finished", PropertyInfo(Variant::INT, "request"), PropertyInfo(Variant::DICTIONARY, "result")));
}

} // namespace thicket
