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
	double enter = 0.0; ///< Meters from the nearest center to the instance's origin, in space; 0 for never.
	double leave = 0.0; ///< At least `enter`: in between, what is held stays held, so nothing comes and goes twice.
};

/// Something that is held and has to leave.
struct NearLeaving {
	std::uint64_t id = 0;
	glm::dvec3 position{0.0};      ///< As held.
	double distance_squared = 0.0; ///< To the nearest center.

	friend bool operator==(const NearLeaving &, const NearLeaving &) = default;
};

/// The difference between what is held and what should be. An instance is in one of the lists, and once.
struct NearChanges {
	std::vector<PlacedInstance> enter;   ///< Not held, nearest first.
	std::vector<PlacedInstance> changed; ///< Held in a different position, basis, mesh or layer; nearest first.

	/// First the `gone` ones, nearest first: instances that are removed, or all for a range of 0. A player must not run into what
	/// is no longer there. Then those that are only too far away, farthest first.
	std::vector<NearLeaving> leave;
	std::size_t gone = 0;

	void clear();
};

/// Which instances of a layer are near enough to some centers to be worth a body or a scene. It says what should come and go; its owner
/// says what has come and gone, when there was time for it.
class NearSet {
public:
	/// Replaces `r_changes` by the difference between what is held and what is near. `standing` holds everything that stands
	/// within range.leave of a center, in any order, and possibly more; an instance may be in it several times. What is equally far
	/// is in the order of the ids. False where memory does not suffice: nothing is to be done then.
	bool look(std::span<const glm::dvec3> centers, const NearRange &range, std::span<const PlacedInstance> standing,
			NearChanges &r_changes);

	bool holds(std::uint64_t id) const { return held_.contains(id); }

	/// False where memory does not suffice: the instance is not held then.
	bool hold(const PlacedInstance &instance);

	/// True if it was held.
	bool release(std::uint64_t id) { return held_.erase(id) > 0; }

	/// All that is held, in no order.
	std::vector<PlacedInstance> held() const;
	std::size_t size() const { return held_.size(); }
	void clear() { held_.clear(); }

	/// How far an instance may stand from where it stood, in meters, and how much an entry of its basis may differ, before it counts
	/// as another one: a tile that is made anew with another origin rounds its positions by less.
	static constexpr double same_position = 1e-3;
	static constexpr float same_basis = 1e-4f;

private:
	struct Held {
		glm::dvec3 position{0.0};
		glm::mat3 basis{1.0f};
		std::uint32_t layer = 0;
		std::uint32_t mesh = 0;
		std::uint64_t seen = 0;    ///< The last look that found it standing as it did.
		std::uint64_t changed = 0; ///< The last look that found it near, but standing otherwise.
		std::size_t center = 0;    ///< A center that it was near.

		bool is_near(std::span<const glm::dvec3> centers, double reach_squared);
		bool stands_as(const PlacedInstance &instance) const;
	};

	void find_changes(std::span<const glm::dvec3> centers, const NearRange &range,
			std::span<const PlacedInstance> standing, NearChanges &r_changes);

	struct Distant {
		double distance_squared = 0.0;
		std::uint64_t id = 0;
		std::size_t index = 0; ///< In `standing`.
	};

	static void sort_nearest(std::vector<Distant> &r_distant);
	static void take(
			std::span<const Distant> from, std::span<const PlacedInstance> standing, std::vector<PlacedInstance> &r_to);

	std::unordered_map<std::uint64_t, Held> held_; ///< Whatever comes out of it is sorted.
	std::uint64_t looks_ = 0;
	std::vector<Distant> entering_;
	std::vector<Distant> changed_;
	std::vector<NearLeaving> leaving_;
};

} // namespace thicket
