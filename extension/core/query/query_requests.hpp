#pragma once

#include "core/query/instance_world.hpp"

#include <glm/vec3.hpp>

#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <variant>
#include <vector>

namespace thicket {

/// Asynchronous queries. Their missing tiles are generated elsewhere over several frames. Use this
/// class on one thread only.
class QueryRequests {
public:
	struct Sphere {
		glm::dvec3 center{0.0};
		double radius = 0.0;
	};

	struct Answer {
		std::int64_t request = 0;
		FoundInstances found;
	};

	/// Starts a request. Sets `r_request` to a number above 0 that identifies the request. Values
	/// that InstanceQuery rejects are errors.
	Status add(const InstanceWorld &world, const std::variant<Rect, Sphere> &area, const QueryFilter &filter,
			std::int64_t &r_request);

	/// Cancels a request. Returns false if it does not exist or has already been answered.
	bool cancel(std::int64_t request);

	/// Records missing tiles in the world and returns the answers that are complete, in the order
	/// of their requests. Call this function once per frame.
	std::vector<Answer> frame(const InstanceWorld &world);

	/// Updates the layers of open requests after the list of layers has changed: the layer at index
	/// i is now at `current[i]`. An index beyond the list means that the layer was removed;
	/// requests for it get an empty answer.
	void renumber(std::span<const std::uint32_t> current);

	void clear() { open_.clear(); }
	std::size_t size() const { return open_.size(); }

private:
	struct OpenRequest {
		std::int64_t request = 0;
		std::variant<Rect, Sphere> area;
		QueryFilter filter;
		/// Keeps known tiles alive until all tiles of the request are known.
		std::vector<std::shared_ptr<const CompactTile>> known_tiles;
	};

	static Status tiles_of(
			const InstanceQuery &query, const OpenRequest &entry, std::vector<InstanceQuery::Tile> &r_tiles);
	static bool gather(const InstanceWorld &world, OpenRequest &r_entry);

	std::deque<OpenRequest> open_;
	std::int64_t last_ = 0;
};

} // namespace thicket
