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
	/// Maximum distance in meters, in space, from the nearest center to the instance; 0 to disable
	/// the layer.
	double enter = 0.0;
	double leave = 0.0; ///< At least `enter`. Instances in between stay held, which avoids flickering.
};

/// A held instance that must be released. See `NearSet`.
struct NearRelease {
	std::uint64_t id = 0;
	glm::dvec3 position{0.0};      ///< The position at which the instance is held.
	double distance_squared = 0.0; ///< Squared distance to the nearest center.

	friend bool operator==(const NearRelease &, const NearRelease &) = default;
};

/// The difference between the instances that are held and those that should be held. Each instance
/// appears at most once in all lists together.
struct NearChanges {
	std::vector<PlacedInstance> enter; ///< Instances that are not held yet, nearest first.
	/// Held instances whose position, basis, mesh or layer has changed; nearest first.
	std::vector<PlacedInstance> changed;

	/// The first `removed_count` entries are the removed instances, or all instances for a range of
	/// 0. They are sorted nearest first and precede all others, because a player must not collide
	/// with an instance that no longer exists. Instances that are merely too far away follow,
	/// farthest first.
	std::vector<NearRelease> leave;
	std::size_t removed_count = 0;

	void clear();
};

/// Tracks the instances of a layer that are near enough to a center to need a body or a scene.
/// Determines which instances should enter and leave. The owner calls `retain` and `release` after
/// it has processed them.
class NearSet {
public:
	/// Replaces `r_changes` with the difference between held and near instances. `present` must
	/// contain all instances within range.leave of a center. It may also contain farther ones and
	/// duplicates, in any order. Instances at equal distances are ordered by ID. If memory runs
	/// out, the function returns false and clears `r_changes`.
	bool find_changes(std::span<const glm::dvec3> centers, const NearRange &range,
			std::span<const PlacedInstance> present, NearChanges &r_changes);

	bool holds(std::uint64_t id) const { return held_.contains(id); }

	/// Marks an instance as held. Returns false, with the instance not held, if memory runs out.
	bool retain(const PlacedInstance &instance);

	/// Stops holding an instance. Returns true if the instance was held.
	bool release(std::uint64_t id) { return held_.erase(id) > 0; }

	/// Returns all held instances, in no particular order.
	std::vector<PlacedInstance> held() const;

	/// Calls `act(id, position)` for all held instances, in no particular order.
	template <class Act>
	void for_each_position(Act act) const {
		for (const auto &[id, held] : held_) {
			act(id, held.position);
		}
	}
	std::size_t size() const { return held_.size(); }
	void clear() { held_.clear(); }

	/// Tolerances for the position, in meters, and the basis entries of a held instance. Beyond
	/// these, the instance is treated as changed. A regenerated tile may have another origin; the
	/// resulting rounding changes positions by less than this.
	static constexpr double same_position = 1e-3;
	static constexpr float same_basis = 1e-4f;

private:
	struct Held {
		glm::dvec3 position{0.0};
		glm::mat3 basis{1.0f};
		std::uint32_t layer = 0;
		std::uint32_t mesh = 0;
		std::uint64_t seen = 0;    ///< Number of the last check that found the instance unchanged.
		std::uint64_t changed = 0; ///< Number of the last check that found the instance near, but changed.
		std::size_t center = 0;    ///< Index of a center to which the instance was near.

		bool is_near(std::span<const glm::dvec3> centers, double reach_squared);
		bool is_placed_as(const PlacedInstance &instance) const;
	};

	void find_changes_or_throw(std::span<const glm::dvec3> centers, const NearRange &range,
			std::span<const PlacedInstance> present, NearChanges &r_changes);

	struct Distant {
		double distance_squared = 0.0;
		std::uint64_t id = 0;
		std::size_t index = 0; ///< Index of the instance in `present`.
	};

	static void sort_nearest(std::vector<Distant> &r_distant);
	static void take(
			std::span<const Distant> from, std::span<const PlacedInstance> present, std::vector<PlacedInstance> &r_to);

	/// Unordered. The lists of NearChanges that are built from it are sorted.
	std::unordered_map<std::uint64_t, Held> held_;
	std::uint64_t check_count_ = 0;
	std::vector<Distant> entering_;
	std::vector<Distant> changed_;
	std::vector<NearRelease> leaving_;
};

} // namespace thicket
