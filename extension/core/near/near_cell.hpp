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

/// Something that is held and has to go.
struct Leaving {
	std::uint32_t layer = 0;
	std::uint64_t id = 0;
	glm::dvec3 position{
			0.0}; ///< As held. An instance that has moved into a different cell meanwhile is held there, and stays.
};

/// What a look has found holds for. Both are 0 for nothing.
struct NearVersion {
	std::uint64_t world = 0; ///< InstanceWorld::version.
	std::uint64_t queue = 0; ///< Rises with what else makes it useless: different distances, released instances.

	friend bool operator==(const NearVersion &, const NearVersion &) = default;
};

/// The squared distance from a position to the nearest of some centers; infinite without any.
double squared_to(glm::dvec3 position, std::span<const glm::dvec3> centers);

/// The same on the map, from the nearest position in a rectangle.
double squared_to_cell(const Rect &cell, std::span<const glm::dvec3> centers);

/// True if as many centers are where they were, each to `slack` meters.
bool same_within(double slack, std::span<const glm::dvec3> now, std::span<const glm::dvec3> then);

/// What is near in one cell of a square grid, of one layer: small enough to be looked at in one go. Some centers, far from each other,
/// have cells in many regions, which are looked at one after the other.
class NearCell {
public:
	/// A look at least every so many frames: tiles that are missed have to be missed again.
	static constexpr int look_frames = 32;

	/// From the centers within whose reach the cell lies, before `add_center` says which they are now.
	void forget_centers() { centers_.clear(); }
	void add_center(glm::dvec3 center) { centers_.push_back(center); }
	std::span<const glm::dvec3> centers() const { return centers_; }

	/// Counts the frames since the last look.
	void begin_frame() { ++frames_; }

	/// True if it has to be looked at: a center has moved by more than `slack` meters since, or another one came, or the world changed.
	bool outdated(double slack, const NearVersion &now) const;

	/// Frames since the last look.
	int frames() const { return frames_; }

	/// True if nothing of that is so, and yet the last look is long ago.
	bool due() const { return frames_ >= look_frames; }

	/// Finds out anew what has to come and go in the square `of`, which is half-open. The cost in instances.
	std::size_t look(std::uint32_t layer, const Rect &of, const NearRange &range, const InstanceWorld &world,
			const NearVersion &now, std::vector<PlacedInstance> &r_standing);

	/// What was found still holds.
	bool fresh(const NearVersion &now) const { return version_ == now; }

	/// If the world has changed since the last look, but not in the square `of`, what was found holds for it as it is now.
	void follow(std::uint32_t layer, const Rect &of, const InstanceWorld &world, const NearVersion &now);

	/// No center reaches it, and nothing is held.
	bool idle() const { return centers_.empty() && holds_nothing(); }
	bool holds_nothing() const { return near_.size() == 0; }

	/// Fresh, with nothing to be taken out.
	bool settled(const NearVersion &now) const { return fresh(now) && !again_ && !any_change(); }

	/// How many looks of its queue came before its last one: who waits longest is next.
	std::uint64_t looked = 0;

	bool any_gone() const { return left_ < changes_.gone; }
	bool any_leaving() const { return left_ < changes_.leave.size(); }
	bool any_changed() const { return changed_ < changes_.changed.size(); }
	bool any_entering() const { return entered_ < changes_.enter.size(); }
	bool any_change() const { return change_count() > 0; }

	/// How much there is to take out.
	std::size_t change_count() const {
		return changes_.leave.size() - left_ + changes_.changed.size() - changed_ + changes_.enter.size() - entered_;
	}

	/// The squared distance of the next that enters, or leaves.
	double away_entering() const { return away_[entered_]; }
	double away_leaving() const { return changes_.leave[left_].distance_squared; }

	// As in NearQueue; only where there is one to take out.
	NearLeaving take_leaving();
	PlacedInstance take_changed();
	PlacedInstance take_entering();

	bool holds(std::uint64_t id) const { return near_.holds(id); }

	/// False where memory does not suffice.
	bool hold(const PlacedInstance &instance) { return near_.hold(instance); }
	std::vector<PlacedInstance> held() const { return near_.held(); }

	/// What else is to come and go still does.
	void release(std::uint64_t id) { again_ = near_.release(id) || again_; }

private:
	void forget_changes();

	NearSet near_;
	NearChanges changes_;
	std::vector<double> away_; ///< Squared distances of changes_.enter.
	std::size_t left_ = 0;     ///< How many of changes_.leave are out,
	std::size_t changed_ = 0;  ///< of changes_.changed,
	std::size_t entered_ = 0;  ///< and of changes_.enter.

	bool again_ = false;  ///< The cell has to be looked at, whatever has moved; `changes_` are of use until then.
	int frames_ = 0;      ///< Since the last look.
	NearVersion version_; ///< Of the last look, or what `follow` has made of it.
	std::vector<glm::dvec3> centers_;   ///< As they are now,
	std::vector<glm::dvec3> looked_at_; ///< and as they were at the last look.
};

} // namespace thicket
