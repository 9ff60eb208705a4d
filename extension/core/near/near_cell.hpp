#pragma once

#include "core/base/rect.hpp"
#include "core/near/near_set.hpp"
#include "core/query/instance_world.hpp"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// A held instance that must be released. An instance is held while it has a node or a body near a
/// center; see `NearQueue`.
struct InstanceToRelease {
	std::uint32_t layer = 0;
	std::uint64_t id = 0;
	/// The position at which the instance is held. If the instance has since moved into another
	/// cell, that cell holds it, and the caller must not free it.
	glm::dvec3 position{0.0};
};

/// The versions for which the result of a check is valid. Both are 0 if the cell has no valid
/// result.
struct NearVersion {
	std::uint64_t world = 0; ///< InstanceWorld::version of the world.
	/// Increases with all other changes that invalidate results: new distances, released instances.
	std::uint64_t queue = 0;

	friend bool operator==(const NearVersion &, const NearVersion &) = default;
};

/// Returns the squared distance from a position to the nearest center, or infinity if there are no
/// centers.
double squared_distance(glm::dvec3 position, std::span<const glm::dvec3> centers);

/// Returns the squared horizontal distance between a rectangle and the nearest center, or infinity
/// if there are no centers.
double squared_cell_distance(const Rect &cell, std::span<const glm::dvec3> centers);

/// Returns true if the number of centers is unchanged and each is within `slack` meters of its old
/// position.
bool same_within(double slack, std::span<const glm::dvec3> now, std::span<const glm::dvec3> then);

/// The near instances of one layer in one cell of a square grid; see `NearQueue` for the terms. A
/// cell is small enough to be checked in a single step. Centers that are far from each other have
/// separate groups of cells around them.
class NearCell {
public:
	/// A cell is due for a new check after this many frames, because requests for missing tiles
	/// must be repeated.
	static constexpr int max_frames_between_checks = 32;

	/// Clears the list of centers whose reach includes the cell. The caller then calls `add_center`
	/// for each current one.
	void forget_centers() { centers_.clear(); }
	void add_center(glm::dvec3 center) { centers_.push_back(center); }
	std::span<const glm::dvec3> centers() const { return centers_; }

	/// Counts the frames since the last check.
	void begin_frame() { ++frames_; }

	/// Returns true if the cell must be checked, because a center has moved by more than `slack`
	/// meters, centers were added or removed, or the world has changed.
	bool outdated(double slack, const NearVersion &now) const;

	/// Returns the number of frames since the last check.
	int frames() const { return frames_; }

	/// Returns true if the last check was `max_frames_between_checks` ago or more, even if the cell
	/// is not outdated.
	bool due() const { return frames_ >= max_frames_between_checks; }

	/// Finds the instances that must enter and leave in the half-open square `of`. Returns the cost
	/// of the check as a number of instances. `r_present` is scratch space. If memory runs out,
	/// the cell stays outdated.
	std::size_t check(std::uint32_t layer, const Rect &of, const NearRange &range, const InstanceWorld &world,
			const NearVersion &now, std::vector<PlacedInstance> &r_present);

	/// Returns true if the result of the last check is still valid.
	bool fresh(const NearVersion &now) const { return version_ == now; }

	/// If the world has changed since the last check, but not in the square `of`, marks the result
	/// as valid for the current version.
	void follow(std::uint32_t layer, const Rect &of, const InstanceWorld &world, const NearVersion &now);

	/// Returns true if the cell is within reach of no center and holds nothing.
	bool idle() const { return centers_.empty() && holds_nothing(); }
	bool holds_nothing() const { return near_.size() == 0; }

	/// Returns true if the result is valid and no changes are pending.
	bool settled(const NearVersion &now) const { return fresh(now) && !needs_check_ && !any_change(); }

	/// The queue's total number of checks at the time of this cell's last check. Among cells that
	/// have waited too long, the one with the smallest number is checked first.
	std::uint64_t last_check = 0;

	bool any_removed() const { return taken_leaving_ < changes_.removed_count; }
	bool any_leaving() const { return taken_leaving_ < changes_.leave.size(); }
	bool any_changed() const { return taken_changed_ < changes_.changed.size(); }
	bool any_entering() const { return taken_entering_ < changes_.enter.size(); }
	bool any_change() const { return change_count() > 0; }

	/// Returns the number of pending changes.
	std::size_t change_count() const {
		return changes_.leave.size() - taken_leaving_ + changes_.changed.size() - taken_changed_ +
				changes_.enter.size() - taken_entering_;
	}

	/// `entering_distance_squared` and `leaving_distance_squared` return the squared distance of
	/// the next instance to enter or to leave.
	double entering_distance_squared() const { return entering_distances_squared_[taken_entering_]; }
	double leaving_distance_squared() const { return changes_.leave[taken_leaving_].distance_squared; }

	// The `take` functions return the next instance and update the held ones; see
	// NearQueue::next_leaving(). Call them only if such an instance exists.
	NearRelease take_leaving();
	PlacedInstance take_changed();
	PlacedInstance take_entering();

	bool holds(std::uint64_t id) const { return near_.holds(id); }

	/// Marks an instance as held. Returns false if memory runs out.
	bool retain(const PlacedInstance &instance) { return near_.retain(instance); }
	std::vector<PlacedInstance> held() const { return near_.held(); }

	/// See NearSet::for_each_position().
	template <class Act>
	void for_each_position(Act act) const {
		near_.for_each_position(act);
	}

	/// Stops holding an instance. Other pending changes stay valid.
	void release(std::uint64_t id) { needs_check_ = near_.release(id) || needs_check_; }

private:
	void find_present(std::uint32_t layer, const Rect &rect, const NearRange &range, const InstanceWorld &world,
			std::vector<PlacedInstance> &r_present) const;
	void forget_changes();

	NearSet near_;
	NearChanges changes_;
	std::vector<double> entering_distances_squared_; ///< Squared distances of the instances in changes_.enter.
	std::size_t taken_leaving_ = 0;                  ///< Number of entries of changes_.leave that were taken.
	std::size_t taken_changed_ = 0;                  ///< Number of entries of changes_.changed that were taken.
	std::size_t taken_entering_ = 0;                 ///< Number of entries of changes_.enter that were taken.

	bool needs_check_ = false;                ///< Forces a new check. `changes_` stays valid until then.
	int frames_ = 0;                          ///< Number of frames since the last check.
	NearVersion version_;                     ///< Set by the last check, or updated by `follow`.
	std::vector<glm::dvec3> centers_;         ///< The current centers.
	std::vector<glm::dvec3> checked_centers_; ///< The centers at the last check.
};

} // namespace thicket
