#pragma once

#include "core/query/instance_query.hpp"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace thicket {

/// The distances at which instances enter and leave.
struct NearRange {
	double enter = 0.0; ///< Meters from the nearest center to the instance's origin, in space; 0 to disable.
	double leave = 0.0; ///< At least `enter`. In between, held instances stay held, so nothing flickers.
};

/// A held instance that must leave.
struct NearLeaving {
	std::uint64_t id = 0;
	glm::dvec3 position{0.0};      ///< The position at which it is held.
	double distance_squared = 0.0; ///< To the nearest center.

	friend bool operator==(const NearLeaving &, const NearLeaving &) = default;
};

/// The difference between the instances that are held and those that should be held. An instance is in at most one
/// list, and only once.
struct NearChanges {
	std::vector<PlacedInstance> enter;   ///< Not held, nearest first.
	std::vector<PlacedInstance> changed; ///< Held in a different position, basis, mesh or layer; nearest first.

	/// First the `gone` instances, nearest first, because a player must not collide with an instance that no longer
	/// exists. These are removed instances or, for a range of 0, all instances. The instances that are only too far
	/// away follow, farthest first.
	std::vector<NearLeaving> leave;
	std::size_t gone = 0;

	void clear();
};

/// The instances of a layer that are near enough to some centers to need a body or a scene. Determines which instances
/// should enter and leave. The owner reports which have entered and left, once it had time for them.
class NearSet {
public:
	/// Replaces `r_changes` by the difference between held and near instances. `standing` holds all instances within
	/// range.leave of a center, in any order, and possibly more. It may contain an instance several times. Instances at
	/// equal distances are ordered by id. Returns false if memory runs out; the caller must then change nothing.
	bool look(std::span<const glm::dvec3> centers, const NearRange &range, std::span<const PlacedInstance> standing,
			NearChanges &r_changes);

	bool holds(std::uint64_t id) const { return held_.contains(id); }

	/// False if memory runs out: the instance is not held then.
	bool hold(const PlacedInstance &instance);

	/// True if it was held.
	bool release(std::uint64_t id) { return held_.erase(id) > 0; }

	/// All held instances, in no particular order.
	std::vector<PlacedInstance> held() const;
	std::size_t size() const { return held_.size(); }
	void clear() { held_.clear(); }

	/// How far an instance may be from its old position, in meters, and how much an entry of its basis may differ, before it counts as
	/// changed. A tile that is regenerated with a different origin rounds its positions by less.
	static constexpr double same_position = 1e-3;
	static constexpr float same_basis = 1e-4f;

private:
	struct Held {
		glm::dvec3 position{0.0};
		glm::mat3 basis{1.0f};
		std::uint32_t layer = 0;
		std::uint32_t mesh = 0;
		std::uint64_t seen = 0;    ///< The last check that found it unchanged.
		std::uint64_t changed = 0; ///< The last check that found it near, but changed.
		std::size_t center = 0;    ///< A center that it was near.

		bool is_near(std::span<const glm::dvec3> centers, double reach_squared);
		bool stands_as(const PlacedInstance &instance) const;
	};

	void find_changes(std::span<const glm::dvec3> centers, const NearRange &range,
			std::span<const PlacedInstance> standing, NearChanges &r_changes);

	struct Distant {
		double distance_squared = 0.0;
		std::uint64_t id = 0;
		std::size_t index = 0; ///< The index in `standing`.
	};

	static void sort_nearest(std::vector<Distant> &r_distant);
	static void take(
			std::span<const Distant> from, std::span<const PlacedInstance> standing, std::vector<PlacedInstance> &r_to);

	std::unordered_map<std::uint64_t, Held> held_; ///< Results taken from it are always sorted.
	std::uint64_t looks_ = 0;
	std::vector<Distant> entering_;
	std::vector<Distant> changed_;
	std::vector<NearLeaving> leaving_;
};

} // namespace thicket
