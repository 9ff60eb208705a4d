#pragma once

#include "core/query/instance_query.hpp"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace thicket {

/// How near is near.
struct NearRange {
	double enter = 0.0; ///< Metres from the nearest centre to the instance's origin; 0 for never.
	double leave = 0.0; ///< At least `enter`: in between, what is held stays held, so nothing comes and goes twice.
};

/// What has to be done about it.
struct NearChanges {
	std::vector<PlacedInstance> enter; ///< Nearest first.
	std::vector<std::uint64_t> leave;  ///< Farthest first.
};

/// Which instances of a layer are near enough to some centres to be worth a body or a scene. It says what should come and go; its owner
/// says what has come and gone, when there was time for it.
class NearSet {
public:
	/// Replaces `r_changes` by the difference between what is held and what is near. `standing` holds everything that stands
	/// within range.leave of a centre, in any order, and possibly more. What is held and stands no longer leaves first of all.
	void look(std::span<const glm::dvec3> centers, const NearRange &range, std::span<const PlacedInstance> standing,
			NearChanges &r_changes) const;

	bool holds(std::uint64_t id) const { return held_.contains(id); }
	void hold(const PlacedInstance &instance) { held_.insert_or_assign(instance.id, instance.position); }
	void release(std::uint64_t id) { held_.erase(id); }
	std::size_t size() const { return held_.size(); }
	void clear() { held_.clear(); }

private:
	std::unordered_map<std::uint64_t, glm::dvec3>
			held_; ///< Looked up only, or sorted before anything depends on the order.
};

} // namespace thicket
