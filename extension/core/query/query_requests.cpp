#include "core/query/query_requests.hpp"

#include <algorithm>
#include <utility>

namespace thicket {

Status QueryRequests::tiles_of(
		const InstanceQuery &query, const OpenRequest &entry, std::vector<InstanceQuery::Tile> &r_tiles) {
	if (const Rect *rect = std::get_if<Rect>(&entry.area)) {
		return query.tiles_in_rect(*rect, entry.filter, r_tiles);
	}
	const Sphere &sphere = std::get<Sphere>(entry.area);
	return query.tiles_in_sphere(sphere.center, sphere.radius, entry.filter, r_tiles);
}

Status QueryRequests::add(const InstanceWorld &world, const std::variant<Rect, Sphere> &area, const QueryFilter &filter,
		std::int64_t &r_request) {
	OpenRequest entry{last_ + 1, area, filter, {}};
	std::vector<InstanceQuery::Tile> tiles;
	const Status status = world.query_known([&](const InstanceQuery &query) { return tiles_of(query, entry, tiles); });
	if (status.ok()) {
		r_request = ++last_;
		open_.push_back(std::move(entry));
	}
	return status;
}

bool QueryRequests::cancel(std::int64_t request) {
	return std::erase_if(open_, [request](const OpenRequest &entry) { return entry.request == request; }) > 0;
}

void QueryRequests::renumber(std::span<const std::uint32_t> current) {
	for (OpenRequest &entry : open_) {
		for (std::uint32_t &layer : entry.filter.layers) {
			layer = layer < current.size() ? current[layer] : layer;
		}
	}
}

/// Returns true if all tiles of a request are known; otherwise requests the missing ones. This is
/// called every frame, because layers and tile sizes may change.
bool QueryRequests::gather(const InstanceWorld &world, OpenRequest &r_entry) {
	std::vector<InstanceQuery::Tile> tiles;
	const Status status =
			world.query_known([&](const InstanceQuery &query) { return tiles_of(query, r_entry, tiles); });
	r_entry.known_tiles.clear();
	bool complete = true;
	for (std::size_t i = 0; status.ok() && i < tiles.size(); ++i) {
		const WorldTile &tile = tiles[i];
		if (std::shared_ptr<const CompactTile> known = world.find(tile)) {
			r_entry.known_tiles.push_back(std::move(known));
		} else if (world.layers()[tile.layer].wanted) {
			world.miss(tile);
			complete = false;
		}
	}
	return complete; // If changed layers have made the request invalid, its answer is empty.
}

std::vector<QueryRequests::Answer> QueryRequests::frame(const InstanceWorld &world) {
	std::vector<Answer> answers;
	std::erase_if(open_, [&](OpenRequest &entry) {
		if (!gather(world, entry)) {
			return false;
		}
		Answer &answer = answers.emplace_back();
		answer.request = entry.request;
		const Status status = world.query_known([&](const InstanceQuery &query) {
			if (const Rect *rect = std::get_if<Rect>(&entry.area)) {
				return query.in_rect(*rect, entry.filter, answer.found);
			}
			const Sphere &sphere = std::get<Sphere>(entry.area);
			return query.in_sphere(sphere.center, sphere.radius, entry.filter, answer.found);
		});
		if (!status.ok()) {
			answer.found.clear();
		}
		return true;
	});
	return answers;
}

} // namespace thicket
