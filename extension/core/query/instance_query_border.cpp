// This file contains the public functions of InstanceQuery. If memory runs out, they return an
// empty result and a status that names the request.

#include "core/base/guard.hpp"
#include "core/query/instance_query.hpp"
#include "core/query/tile_window.hpp"

#include <algorithm>
#include <cmath>

namespace thicket {

namespace {

/// Converts the results to complete instances. Throws std::bad_alloc.
template <class Find>
Status read(const Find &find, std::vector<PlacedInstance> &r_found) {
	FoundInstances found;
	const Status status = find(found);
	found.read_all(r_found);
	return status;
}

} // namespace

Status InstanceQuery::in_rect(const TileSpace &rect, const QueryFilter &filter, FoundInstances &r_found) const {
	return guarded_answer("rect", std::max(rect.size().x, rect.size().y), r_found,
			[&] { return find_in_rect(rect, filter, r_found); });
}

Status InstanceQuery::in_rect(
		const TileSpace &rect, const QueryFilter &filter, std::vector<PlacedInstance> &r_found) const {
	return guarded_answer("rect", std::max(rect.size().x, rect.size().y), r_found,
			[&] { return read([&](FoundInstances &found) { return find_in_rect(rect, filter, found); }, r_found); });
}

Status InstanceQuery::in_sphere(
		glm::dvec3 center, double radius, const QueryFilter &filter, FoundInstances &r_found) const {
	return guarded_answer("radius", radius, r_found, [&] { return find_in_sphere(center, radius, filter, r_found); });
}

Status InstanceQuery::in_sphere(
		glm::dvec3 center, double radius, const QueryFilter &filter, std::vector<PlacedInstance> &r_found) const {
	return guarded_answer("radius", radius, r_found, [&] {
		return read([&](FoundInstances &found) { return find_in_sphere(center, radius, filter, found); }, r_found);
	});
}

Status InstanceQuery::on_ray(
		glm::dvec3 from, glm::dvec3 to, const QueryFilter &filter, std::vector<RayHit> &r_hit) const {
	return guarded_answer(
			"to", std::sqrt(squared_length(to - from)), r_hit, [&] { return find_on_ray(from, to, filter, r_hit); });
}

Status InstanceQuery::nearest(glm::dvec3 position, double max_distance, const QueryFilter &filter,
		std::vector<NearestInstance> &r_found) const {
	return guarded_answer("max_distance", max_distance, r_found,
			[&] { return find_nearest(position, max_distance, filter, r_found); });
}

Status InstanceQuery::by_id(std::uint64_t id, std::vector<PlacedInstance> &r_found) const {
	if (state != nullptr && !is_added(id) && state->removed(id)) {
		r_found.clear();
		return {};
	}
	return by_id_even_removed(id, r_found);
}

Status InstanceQuery::by_id_even_removed(std::uint64_t id, std::vector<PlacedInstance> &r_found) const {
	return guarded_answer("id", static_cast<double>(id), r_found, [&] { return find_by_id(id, r_found); });
}

Status InstanceQuery::tiles_in_rect(
		const TileSpace &rect, const QueryFilter &filter, std::vector<Tile> &r_tiles) const {
	return guarded_answer("rect", std::max(rect.size().x, rect.size().y), r_tiles,
			[&] { return find_tiles_in_rect(rect, filter, r_tiles); });
}

Status InstanceQuery::tiles_in_sphere(
		glm::dvec3 center, double radius, const QueryFilter &filter, std::vector<Tile> &r_tiles) const {
	return guarded_answer(
			"radius", radius, r_tiles, [&] { return find_tiles_in_sphere(center, radius, filter, r_tiles); });
}

} // namespace thicket
