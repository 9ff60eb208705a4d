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
};

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

	/// Counts the frames since the last look.
	void begin_frame() { ++frames_; }

	/// True if it has to be looked at: a center has moved by more than `slack` meters since, or another one came, or the world changed.
	bool outdated(double slack, std::uint64_t world_version) const;

	/// True if nothing of that is so, and yet the last look is long ago.
	bool due() const { return frames_ >= look_frames; }

	/// Finds out anew what has to come and go in the square `of`, which is half-open, in a world of this version. The cost in instances.
	std::size_t look(std::uint32_t layer, const Rect &of, const NearRange &range, const InstanceWorld &world,
			std::uint64_t world_version, std::vector<PlacedInstance> &r_standing);

	/// What was found still holds in a world of this version.
	bool fresh(std::uint64_t world_version) const { return version_ == world_version; }

	/// No center reaches it, and nothing is held.
	bool idle() const { return centers_.empty() && near_.size() == 0; }

	/// Fresh, with nothing to be taken out.
	bool settled(std::uint64_t world_version) const {
		return fresh(world_version) && !again_ && !any_leaving() && !any_entering();
	}

	/// How many looks of its queue came before its last one: who waits longest is next.
	std::uint64_t looked = 0;

	bool any_gone() const { return left_ < changes_.gone; }
	bool any_leaving() const { return left_ < changes_.leave.size(); }
	bool any_entering() const { return entered_ < changes_.enter.size(); }

	/// The squared distance of the next that enters.
	double away() const { return away_[entered_]; }

	// As in NearQueue; only where there is one to take out.
	std::uint64_t take_leaving();
	PlacedInstance take_entering();
	bool take_changed(PlacedInstance &r_instance);

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
	std::vector<double> away_;   ///< Squared distances of changes_.enter.
	std::size_t left_ = 0;       ///< How many of changes_.leave are out.
	std::size_t entered_ = 0;    ///< How many of changes_.enter are.
	bool maybe_changed_ = false; ///< Something that enters may be held.

	bool again_ = false;        ///< The cell has to be looked at, whatever has moved; `changes_` are of use until then.
	int frames_ = 0;            ///< Since the last look.
	std::uint64_t version_ = 0; ///< Of the world that was looked at; 0, which no world has, for none.
	std::vector<glm::dvec3> centers_;   ///< As they are now,
	std::vector<glm::dvec3> looked_at_; ///< and as they were at the last look.
};

} // namespace thicket
