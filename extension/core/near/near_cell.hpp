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

/// A held instance that must leave.
struct Leaving {
	std::uint32_t layer = 0;
	std::uint64_t id = 0;
	/// The position at which the instance is held. If the instance has since moved into a different cell, it is held
	/// there and stays.
	glm::dvec3 position{0.0};
};

/// The versions for which the result of a check is valid. Both are 0 if the cell has no result.
struct NearVersion {
	std::uint64_t world = 0; ///< InstanceWorld::version.
	std::uint64_t queue = 0; ///< Rises with other changes that invalidate it: different distances, released instances.

	friend bool operator==(const NearVersion &, const NearVersion &) = default;
};

/// The squared distance from a position to the nearest of some centers; infinite without any.
double squared_to(glm::dvec3 position, std::span<const glm::dvec3> centers);

/// The squared distance on the map from the nearest position of a rectangle to the nearest of some centers; infinite without any.
double squared_to_cell(const Rect &cell, std::span<const glm::dvec3> centers);

/// True if there are as many centers as before, each within `slack` meters of its old position.
bool same_within(double slack, std::span<const glm::dvec3> now, std::span<const glm::dvec3> then);

/// The near instances of one layer in one cell of a square grid. A cell is small enough to be checked in one go. Centers that are far from
/// each other have cells in many regions, and these are checked one after the other.
class NearCell {
public:
	/// A cell is checked at least once in this many frames, because requests for missing tiles must be repeated.
	static constexpr int look_frames = 32;

	/// Clears the list of centers that have the cell in reach. `add_center` then adds the current ones.
	void forget_centers() { centers_.clear(); }
	void add_center(glm::dvec3 center) { centers_.push_back(center); }
	std::span<const glm::dvec3> centers() const { return centers_; }

	/// Counts the frames since the last check.
	void begin_frame() { ++frames_; }

	/// True if the cell must be checked: if a center has moved by more than `slack` meters since the last check,
	/// centers were added or removed, or the world has changed.
	bool outdated(double slack, const NearVersion &now) const;

	/// Frames since the last check.
	int frames() const { return frames_; }

	/// True if the last check was long ago, whether or not the cell is outdated.
	bool due() const { return frames_ >= look_frames; }

	/// Finds the instances that must enter and leave in the half-open square `of`. Returns the cost in instances.
	std::size_t look(std::uint32_t layer, const Rect &of, const NearRange &range, const InstanceWorld &world,
			const NearVersion &now, std::vector<PlacedInstance> &r_standing);

	/// Whether the result of the last check is still valid.
	bool fresh(const NearVersion &now) const { return version_ == now; }

	/// If the world has changed since the last check, but not in the square `of`, marks the result as valid for the current world.
	void follow(std::uint32_t layer, const Rect &of, const InstanceWorld &world, const NearVersion &now);

	/// True if no center has the cell in reach, and nothing is held.
	bool idle() const { return centers_.empty() && holds_nothing(); }
	bool holds_nothing() const { return near_.size() == 0; }

	/// True if the result is valid and nothing is left to be taken out.
	bool settled(const NearVersion &now) const { return fresh(now) && !again_ && !any_change(); }

	/// The number of checks that the queue had made at this cell's last check. The cell that has waited longest is
	/// next.
	std::uint64_t looked = 0;

	bool any_gone() const { return left_ < changes_.gone; }
	bool any_leaving() const { return left_ < changes_.leave.size(); }
	bool any_changed() const { return changed_ < changes_.changed.size(); }
	bool any_entering() const { return entered_ < changes_.enter.size(); }
	bool any_change() const { return change_count() > 0; }

	/// The number of instances to be taken out.
	std::size_t change_count() const {
		return changes_.leave.size() - left_ + changes_.changed.size() - changed_ + changes_.enter.size() - entered_;
	}

	/// The squared distance of the next instance that enters. `away_leaving` returns that of the next one that leaves.
	double away_entering() const { return away_[entered_]; }
	double away_leaving() const { return changes_.leave[left_].distance_squared; }

	// Each of these takes out an instance, as NearQueue::next_leaving and so on do. Call them only if such an instance
	// exists.
	NearLeaving take_leaving();
	PlacedInstance take_changed();
	PlacedInstance take_entering();

	bool holds(std::uint64_t id) const { return near_.holds(id); }

	/// False if memory runs out.
	bool hold(const PlacedInstance &instance) { return near_.hold(instance); }
	std::vector<PlacedInstance> held() const { return near_.held(); }

	/// Other pending changes remain.
	void release(std::uint64_t id) { again_ = near_.release(id) || again_; }

private:
	void forget_changes();

	NearSet near_;
	NearChanges changes_;
	std::vector<double> away_; ///< Squared distances of changes_.enter.
	std::size_t left_ = 0;     ///< The number of changes_.leave that were taken out,
	std::size_t changed_ = 0;  ///< of changes_.changed,
	std::size_t entered_ = 0;  ///< and of changes_.enter.

	bool again_ = false;  ///< The cell must be checked, whatever has moved; `changes_` stay valid until then.
	int frames_ = 0;      ///< Since the last check.
	NearVersion version_; ///< Set by the last check, or updated by `follow`.
	std::vector<glm::dvec3> centers_;   ///< The current centers,
	std::vector<glm::dvec3> looked_at_; ///< and those at the last check.
};

} // namespace thicket
