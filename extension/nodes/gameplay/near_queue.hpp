#pragma once

#include "core/near/near_set.hpp"
#include "nodes/gameplay/instance_world.hpp"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thicket {

/// What has to come and go around some centers, of all layers, one after the other. Whoever takes an instance out of it makes or frees
/// what stands for it; the queue counts it as held, or not, from then on. Main thread only.
class NearQueue {
public:
	/// Everything up to a layer's distance (meters, 0 for nothing) is near; what is held leaves beyond `leave_share` of it. In between lies
	/// what a center may move before anybody looks again, and the hysteresis.
	static constexpr double look_share = 0.025;
	static constexpr double enter_share = 1.0 + look_share;
	static constexpr double leave_share = 1.125;

	/// A look at least every so many frames: tiles that are missed have to be missed again.
	static constexpr int look_frames = 32;

	/// The distance of each layer. What is held of layers that are no more has to be dropped before.
	void set_distances(std::span<const double> distances);

	/// Finds out anew what has to come and go in layers for which a center has moved far enough, or the world has changed. The world is
	/// remembered until `forget_world`.
	void look_around(std::span<const glm::dvec3> centers, const InstanceWorld &world);

	/// Something that is held and has to go.
	struct Leaving {
		std::uint32_t layer = 0;
		std::uint64_t id = 0;
	};

	/// Takes out what stands no longer, or not as it did: to be done before anything enters. False for none.
	bool next_gone(Leaving &r_leaving);

	/// Takes out what is too far away now, the farthest of each layer first. False for none.
	bool next_leaving(Leaving &r_leaving);

	/// Takes out the nearest that is to come, which is held from then on. False for none.
	bool next_entering(PlacedInstance &r_instance);

	/// True if there is nothing to take out, and the world is as it was at the last look.
	bool settled() const;

	/// Counts an instance as not held, in all layers. Nothing comes out of the queue before the next look.
	void release(std::uint64_t id);

	/// Holds nothing of a layer.
	void release_layer(std::uint32_t layer);
	void forget_world() { world_ = nullptr; }

private:
	struct Layer {
		double distance = 0.0;
		NearSet near;
		NearChanges changes;
		std::vector<double> away; ///< Squared distances of changes.enter.
		std::size_t left = 0;     ///< How many of changes.leave are out.
		std::size_t entered = 0;

		bool stale = true; ///< To be looked at, whatever has moved.
		int frames = 0;    ///< Since the last look.
		std::uint64_t version = 0;
		std::vector<glm::dvec3> centers; ///< As of the last look.

		bool outdated(std::span<const glm::dvec3> now, std::uint64_t world_version);
		bool wanted() const { return distance > 0.0 || near.size() > 0; }
		bool any_gone() const { return left < changes.gone; }
		bool any_leaving() const { return left < changes.leave.size(); }
		bool any_entering() const { return entered < changes.enter.size(); }
		void forget_changes();
	};

	void look(std::uint32_t layer, std::span<const glm::dvec3> centers, const InstanceWorld &world);
	void find_standing(std::uint32_t layer, std::span<const glm::dvec3> centers, const InstanceWorld &world);
	bool next(bool (Layer::*any)() const, Leaving &r_leaving);

	const InstanceWorld *world_ = nullptr;
	std::vector<Layer> layers_;
	std::vector<PlacedInstance> standing_;
	std::vector<bool> covered_;
};

} // namespace thicket
