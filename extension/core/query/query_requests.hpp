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

/// Queries whose tiles are generated elsewhere, over several frames. One thread at a time.
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

	/// Returns a number, from 1 on, that identifies the answer. Refuses what InstanceQuery refuses.
	Status add(const InstanceWorld &world, const std::variant<Rect, Sphere> &area, const QueryFilter &filter,
			std::int64_t &r_request);

	/// False if there is no such request, or if it is already answered.
	bool cancel(std::int64_t request);

	/// Call it once per frame: requests the missing tiles, and returns the answers that miss no tile, in the order of their requests.
	std::vector<Answer> frame(const InstanceWorld &world);

	/// The list of layers has changed: the layer that had index i has index `current[i]` now. An index beyond the list
	/// means that the layer was removed; requests for it get an empty answer.
	void renumber(std::span<const std::uint32_t> current);

	void clear() { open_.clear(); }
	std::size_t size() const { return open_.size(); }

private:
	struct Open {
		std::int64_t request = 0;
		std::variant<Rect, Sphere> area;
		QueryFilter filter;
		std::vector<std::shared_ptr<const CompactTile>> held; ///< Keeps early tiles alive until the last one arrives.
	};

	static Status tiles_of(const InstanceQuery &query, const Open &open, std::vector<InstanceQuery::Tile> &r_tiles);
	static bool gather(const InstanceWorld &world, Open &r_open);

	std::deque<Open> open_;
	std::int64_t last_ = 0;
};

} // namespace thicket
