#pragma once

#include "nodes/gameplay/instance_world.hpp"

#include <godot_cpp/variant/vector3.hpp>

#include <glm/vec3.hpp>

#include <cstdint>
#include <span>

namespace thicket {

/// Keeps something standing for every instance that is near: a body, a scene. Main thread only. Works in small steps under the budget of
/// the frame, which it shares with the uploads.
class NearRing {
public:
	virtual ~NearRing() = default;

	/// Once a frame: where those are for whom it matters (world meters), and what the world is now. Cheap while nobody has moved and
	/// world.version() is the same.
	virtual void look_around(std::span<const glm::dvec3> centers, const InstanceWorld &world) = 0;

	/// Lets one instance come or go. False if there is nothing to do.
	virtual bool step() = 0;

	/// True if `step` would find nothing to do.
	virtual bool settled() const = 0;

	/// The instance stands no longer, or not as it did: what was made for it goes at once, whatever the budget.
	virtual void drop(std::uint64_t id) = 0;

	/// Where the engine's origin is in the world, meters: what stands is moved along at once.
	virtual void set_world_offset(glm::dvec3 offset) = 0;

	/// Frees everything now.
	virtual void clear() = 0;

protected:
	NearRing() = default;
	NearRing(const NearRing &) = default;
	NearRing &operator=(const NearRing &) = default;
};

} // namespace thicket
